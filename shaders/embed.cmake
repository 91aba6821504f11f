# Writes the source behind client/render/embedded_shaders.h: the name and text of every shader file.
# Run by the build as: cmake -DSHADERS=<folder> -DFILES=<names relative to it> -DOUTPUT=<file> -P embed.cmake

set(entries "")
foreach(name IN LISTS FILES)
    file(READ ${SHADERS}/${name} text)
    string(FIND "${text}" ")glsl\"" end_mark)
    if(NOT end_mark EQUAL -1)
        message(FATAL_ERROR "cannot embed shaders/${name}: it contains )glsl\", which ends the literal that holds it")
    endif()
    string(APPEND entries "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
endforeach()

file(WRITE ${OUTPUT}
    "#include \"client/render/embedded_shaders.h\"\n\n"
    "namespace terray {\n\n"
    "std::span<const EmbeddedShader> embeddedShaders() {\n"
    "    static constexpr EmbeddedShader kShaders[] = {\n"
    "${entries}"
    "    };\n"
    "    return kShaders;\n"
    "}\n\n"
    "}  // namespace terray\n")
