# Where heights and photos come from, the encoder of photos, and the other processes of a build. Each of GDAL,
# OpenImageIO, stb and MPI has its own library here; built without it, that library answers with Error(unsupported).

# What needs no foreign library: choice of grids and levels, the procedural terrain, the answers of the missing.
add_library(terray_raster_base STATIC
    missing_libraries.cpp raster_layout.cpp synthetic.cpp synthetic_terrain.cpp work_file.cpp)
target_link_libraries(terray_raster_base PUBLIC terray_common)

if(TERRAY_WITH_GDAL)
    add_library(terray_raster_gdal STATIC gdal_heights.cpp gdal_photos.cpp gdal_raster.cpp gdal_reader.cpp gdal_vertical.cpp raster_groups.cpp
        tiled_copies.cpp)
    target_link_libraries(terray_raster_gdal PUBLIC terray_raster_base PRIVATE terray::gdal)
else()
    add_library(terray_raster_gdal INTERFACE)
    target_link_libraries(terray_raster_gdal INTERFACE terray_raster_base)
endif()

# isPlainImage() asks both raster libraries.
add_library(terray_raster_oiio STATIC plain_image.cpp)
target_link_libraries(terray_raster_oiio PUBLIC terray_raster_base terray_raster_gdal)
if(TERRAY_WITH_OIIO)
    target_sources(terray_raster_oiio PRIVATE image_source.cpp)
    target_link_libraries(terray_raster_oiio PRIVATE terray::openimageio)
endif()

if(TERRAY_WITH_STB)
    add_library(terray_bc1 STATIC bc1.cpp)
    target_link_libraries(terray_bc1 PUBLIC terray_raster_base PRIVATE terray::stb)
else()
    add_library(terray_bc1 INTERFACE)
    target_link_libraries(terray_bc1 INTERFACE terray_raster_base)
endif()

if(TERRAY_WITH_MPI)
    add_library(terray_mpi STATIC mpi_ranks.cpp)
    target_link_libraries(terray_mpi PUBLIC terray_raster_base PRIVATE terray::mpi)
else()
    add_library(terray_mpi INTERFACE)
    target_link_libraries(terray_mpi INTERFACE terray_raster_base)
endif()
