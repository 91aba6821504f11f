#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <ogr_spatialref.h>

#include "common/error.h"
#include "preprocess/gdal_door.h"
#include "preprocess/raster_files.h"

namespace terray {
namespace {

constexpr const char* kEllipsoid = "ellipsoid";

OGRSpatialReference verticalCrs(const std::string& text) {
    const gdal::Messages messages;
    OGRSpatialReference crs;
    const bool isKnown = crs.SetFromUserInput(text.c_str()) == OGRERR_NONE;
    if (isKnown && crs.IsVertical() && !crs.IsCompound()) return crs;
    throw Error(ExitCode::georeference, "cannot measure heights in \"" + text +
                                            "\": expected a vertical system such as EPSG:5773, or \"ellipsoid\"" +
                                            (isKnown ? "" : " (" + messages.text() + ")"));
}

/// The plane with heights in a vertical system.
OGRSpatialReference withHeights(const OGRSpatialReference& plane, const std::string& vertical) {
    OGRSpatialReference whole;
    if (vertical == kEllipsoid) {
        whole = plane;
        whole.PromoteTo3D(nullptr);
    } else {
        const OGRSpatialReference heights = verticalCrs(vertical);
        whole.SetCompoundCS("plane and heights", &plane, &heights);
    }
    whole.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    return whole;
}

class GdalVerticalShift final : public VerticalShift {
  public:
    GdalVerticalShift(const std::string& crsWkt, const std::string& from, const std::string& to) : to_(to) {
        const gdal::Messages messages;
        OGRSpatialReference plane;
        if (plane.SetFromUserInput(crsWkt.c_str()) != OGRERR_NONE) refuse(messages);
        const OGRSpatialReference source = withHeights(plane, from);
        const OGRSpatialReference target = withHeights(plane, to);
        OGRCoordinateTransformationOptions options;
        options.SetBallparkAllowed(false);  // which would leave the shift out where its grid is missing
        transformation_.reset(OGRCreateCoordinateTransformation(&source, &target, options));
        if (!transformation_) refuse(messages);
    }

    std::vector<double> at(const std::vector<PixelPlace>& places) override {
        const gdal::Messages messages;
        std::vector<double> x;
        std::vector<double> y;
        for (const PixelPlace& place : places) {
            x.push_back(place.x);
            y.push_back(place.y);
        }
        std::vector<double> z(places.size(), 0);
        if (!transformation_->Transform(static_cast<int>(places.size()), x.data(), y.data(), z.data()))
            refuse(messages);
        for (const double shift : z)
            if (!std::isfinite(shift)) refuse(messages);
        return z;
    }

  private:
    [[noreturn]] void refuse(const gdal::Messages& messages) const {
        throw Error(ExitCode::georeference,
                    "cannot shift heights to \"" + to_ +
                        "\": PROJ knows no way that covers this ground, or lacks its grid (projsync fetches grids; " +
                        messages.text() + ")");
    }

    std::string to_;
    std::unique_ptr<OGRCoordinateTransformation> transformation_;
};

}  // namespace

std::unique_ptr<VerticalShift> openVerticalShift(const std::string& crsWkt, const std::string& fromWkt,
                                                 const std::string& to) {
    gdal::initialise();
    return std::make_unique<GdalVerticalShift>(crsWkt, fromWkt, to);
}

std::string verticalName(const std::string& crs) {
    gdal::initialise();
    return crs == kEllipsoid ? "ellipsoid" : verticalCrs(crs).GetName();
}

}  // namespace terray
