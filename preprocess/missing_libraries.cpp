// What the doors to foreign libraries answer in a build without them.

#include <string>

#include "common/error.h"
#include "preprocess/bc1.h"
#include "preprocess/plain_image.h"
#include "preprocess/ranks.h"
#include "preprocess/raster_files.h"

namespace terray {

namespace {

[[noreturn, maybe_unused]] void refuse(const std::string& task, const std::string& library, const std::string& option) {
    throw Error(ExitCode::unsupported,
                "cannot " + task + ": this build lacks " + library + " (configure with -D" + option + "=ON)");
}

}  // namespace

#if !TERRAY_WITH_GDAL
std::unique_ptr<HeightSource> openGdalHeights(const HeightSourceOptions& options) {
    refuse("read \"" + options.files.front() + "\"", "GDAL", "TERRAY_WITH_GDAL");
}
std::unique_ptr<ColourSource> openGdalPhotos(const PhotoSourceOptions& options, const Tiling&, GridSize,
                                             const std::string&) {
    refuse("read \"" + options.files.front() + "\"", "GDAL", "TERRAY_WITH_GDAL");
}
bool isStoredInWideRows(const std::string&, uint64_t) {
    return false;
}
std::unique_ptr<VerticalShift> openVerticalShift(const std::string&, const std::string&, const std::string&) {
    refuse("shift heights", "GDAL", "TERRAY_WITH_GDAL");
}
std::string verticalName(const std::string&) {
    refuse("shift heights", "GDAL", "TERRAY_WITH_GDAL");
}
void interpolateHoles(Grid<float>&, int) {
    refuse("interpolate holes", "GDAL", "TERRAY_WITH_GDAL");
}
bool hasGeoreference(const std::string&) {
    return false;
}
#endif

#if !TERRAY_WITH_OIIO
std::unique_ptr<HeightSource> openImageHeights(const HeightSourceOptions& options) {
    refuse("read \"" + options.files.front() + "\"", "OpenImageIO", "TERRAY_WITH_OIIO");
}
bool isReadableImage(const std::string&) {
    return false;
}
#endif

#if !TERRAY_WITH_STB
Bytes encodeBc1(GridView<const Rgba>) {
    refuse("compress imagery", "stb_dxt", "TERRAY_WITH_STB");
}
#endif

#if !TERRAY_WITH_MPI
std::unique_ptr<Ranks> joinRanks() {
    refuse("work as one of several processes", "MPI", "TERRAY_WITH_MPI");
}
void endAllRanks(ExitCode) {}
#endif

}  // namespace terray
