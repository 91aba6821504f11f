#include "preprocess/plain_image.h"

#include "preprocess/raster_files.h"

namespace terray {

bool isPlainImage(const std::string& file) {
    return !hasGeoreference(file) && isReadableImage(file);
}

}  // namespace terray
