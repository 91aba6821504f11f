#include "client/render/sky_table.h"

#include <algorithm>
#include <cmath>

#include "common/check.h"
#include "shaders/interop.h"

namespace terray {
namespace {

constexpr int kTransmittanceWidth = 256;  // zenith angles
constexpr int kTransmittanceHeight = 64;  // heights
constexpr int kEchoWidth = 64;            // zenith angles of the sun
constexpr int kEchoHeight = 32;           // heights
constexpr GLsizeiptr kLightBytes = 2 * TERRAY_SKY_LIGHTS * 4 * sizeof(float);
constexpr double kReferenceElevationDegrees = 40;

constexpr double kEarthRadius = 6371000;
/// Eyes in the ground or under water see what somebody at the shore sees.
constexpr double kLowestEye = 1.5;

double eyeHeight(const SkyView& view) {
    return std::max(view.eyeHeight.value(), kLowestEye);
}

/// How far the sea's horizon lies below the horizontal.
Radians horizonDip(const SkyView& view) {
    return Radians(std::acos(kEarthRadius / (kEarthRadius + eyeHeight(view))));
}

GlTexture makeFloatTable(int width, int height) {
    GlTexture texture = makeTexture(GL_TEXTURE_2D);
    glTextureStorage2D(texture.name(), 1, GL_RGBA32F, width, height);
    return texture;
}

GlBuffer makeStorage(GLsizeiptr bytes) {
    GlBuffer buffer = makeBuffer();
    glNamedBufferStorage(buffer.name(), bytes, nullptr, 0);
    return buffer;
}

GLuint groupsFor(int cells) {
    constexpr int kGroupSide = 8;
    return static_cast<GLuint>((cells + kGroupSide - 1) / kGroupSide);
}

/// What one pass wrote can be read by the next.
void finishPass() {
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_UNIFORM_BARRIER_BIT);
}

}  // namespace

bool looksOther(const SkyView& before, const SkyView& now) {
    constexpr Radians kNoticeable = radiansFromDegrees(0.03);
    const auto differ = [&](Radians a, Radians b) { return std::abs((a - b).value()) > kNoticeable.value(); };
    return differ(before.sunElevation, now.sunElevation) || differ(horizonDip(before), horizonDip(now));
}

SkyTable::SkyTable(const ShaderLibrary& shaders, const Options& options)
    : options_(options),
      lightProgram_(shaders.require({"sky/light.comp"}, {})),
      exposeProgram_(shaders.require({"sky/expose.comp"}, {})),
      tableProgram_(shaders.require({"sky/table.comp"}, {})),
      transmittances_(makeFloatTable(kTransmittanceWidth, kTransmittanceHeight)),
      echoes_(makeFloatTable(kEchoWidth, kEchoHeight)),
      table_(makeTexture(GL_TEXTURE_2D)),
      input_(makeBuffer()),
      referenceLights_(makeStorage(kLightBytes)),
      lights_(makeStorage(kLightBytes)),
      parameters_(makeStorage(sizeof(interop::SkyParameters))),
      sampler_(makeSampler()) {
    TERRAY_CHECK_OP(options.visualRange.value(), >, 0);
    glTextureStorage2D(table_.name(), 1, GL_RGBA16F, kWidth, kHeight);
    if (options.airlight) {
        airProgram_ = shaders.require({"sky/air.comp"}, {});
        air_ = makeTexture(GL_TEXTURE_3D);
        glTextureStorage3D(air_.name(), 1, GL_RGBA16F, kAirWidth, kAirHeight, kAirSlices);
    }
    glSamplerParameteri(sampler_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glSamplerParameteri(sampler_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glSamplerParameteri(sampler_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(sampler_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(sampler_.name(), GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    glNamedBufferStorage(input_.name(), sizeof(interop::SkyInput), nullptr, GL_DYNAMIC_STORAGE_BIT);
    giveInput(std::sin(radiansFromDegrees(kReferenceElevationDegrees).value()), kLowestEye);
    makeAir(shaders);
    measureLight(referenceLights_);
}

/// The tables that hold for every sun and eye.
void SkyTable::makeAir(const ShaderLibrary& shaders) {
    const auto run = [&](const char* shader, const GlTexture& table, GLuint groupsX, GLuint groupsY) {
        const GlProgram program = shaders.require({shader}, {});
        glUseProgram(program.name());
        glBindTextureUnit(TERRAY_SKY_UNIT_TRANSMITTANCE, transmittances_.name());
        glBindSampler(TERRAY_SKY_UNIT_TRANSMITTANCE, sampler_.name());
        glBindImageTexture(0, table.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
        glDispatchCompute(groupsX, groupsY, 1);
        finishPass();
        glBindSampler(TERRAY_SKY_UNIT_TRANSMITTANCE, 0);
    };
    run("sky/transmittance.comp", transmittances_, groupsFor(kTransmittanceWidth), groupsFor(kTransmittanceHeight));
    run("sky/echo.comp", echoes_, kEchoWidth, kEchoHeight);
}

void SkyTable::giveInput(double sunSine, double height) const {
    const interop::SkyInput input{.air = glm::vec4(options_.visualRange.value(), 0, 0, 0),
                                  .view = glm::vec4(sunSine, height, 0, 0)};
    glNamedBufferSubData(input_.name(), 0, sizeof(input), &input);
    glBindBufferBase(GL_UNIFORM_BUFFER, TERRAY_BUFFER_SKY_INPUT, input_.name());
}

void SkyTable::useModel(const GlProgram& program) const {
    glUseProgram(program.name());
    for (const auto& [unit, texture] :
         {std::pair(TERRAY_SKY_UNIT_TRANSMITTANCE, &transmittances_), std::pair(TERRAY_SKY_UNIT_ECHO, &echoes_)}) {
        glBindTextureUnit(static_cast<GLuint>(unit), texture->name());
        glBindSampler(static_cast<GLuint>(unit), sampler_.name());
    }
}

bool SkyTable::update(const SkyView& view) {
    if (made_ && !looksOther(*made_, view)) return false;
    made_ = view;

    giveInput(std::sin(view.sunElevation.value()), eyeHeight(view));
    measureLight(lights_);
    useModel(exposeProgram_);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, referenceLights_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_SKY, parameters_.name());
    glDispatchCompute(1, 1, 1);
    finishPass();
    useModel(tableProgram_);
    glBindImageTexture(0, table_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    glDispatchCompute(groupsFor(kWidth), groupsFor(kHeight), 1);
    if (options_.airlight) {
        useModel(airProgram_);
        glBindImageTexture(0, air_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
        glDispatchCompute(groupsFor(kAirWidth), groupsFor(kAirHeight), 1);
    }
    finishPass();

    glBindSampler(TERRAY_SKY_UNIT_TRANSMITTANCE, 0);
    glBindSampler(TERRAY_SKY_UNIT_ECHO, 0);
    return true;
}

/// Into a buffer that stays bound.
void SkyTable::measureLight(const GlBuffer& into) const {
    useModel(lightProgram_);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, into.name());
    glDispatchCompute(TERRAY_SKY_LIGHTS, 1, 1);
    finishPass();
    glBindSampler(TERRAY_SKY_UNIT_TRANSMITTANCE, 0);
    glBindSampler(TERRAY_SKY_UNIT_ECHO, 0);
}

void SkyTable::bind() const {
    TERRAY_CHECK(made_.has_value());
    glBindTextureUnit(TERRAY_UNIT_SKY, table_.name());
    glBindSampler(TERRAY_UNIT_SKY, sampler_.name());
    if (options_.airlight) {
        glBindTextureUnit(TERRAY_UNIT_AIR, air_.name());
        glBindSampler(TERRAY_UNIT_AIR, sampler_.name());
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TERRAY_BUFFER_SKY, parameters_.name());
}

uint64_t SkyTable::bytes() const {
    const auto floats = [](int width, int height) { return static_cast<uint64_t>(width) * height * 16; };
    return floats(kTransmittanceWidth, kTransmittanceHeight) + floats(kEchoWidth, kEchoHeight) +
           uint64_t{kWidth} * kHeight * 8 +
           (options_.airlight ? uint64_t{kAirWidth} * kAirHeight * kAirSlices * 8 : 0) + 2 * kLightBytes +
           sizeof(interop::SkyParameters);
}

}  // namespace terray
