#pragma once

#include <string>
#include <vector>

#include "client/stream/dataset_source.h"
#include "common/command_line.h"
#include "common/json.h"
#include "common/overlay_mesh.h"
#include "common/terrain_edit.h"

namespace terray {

/// What is put into the picture, as it is written on a command line: tracks, pins and cubes.
class OverlayCommandLine {
  public:
    /// Declares the options. This object must outlive line.parse().
    void declare(CommandLine& line);

    /// Everything that was given, as triangles; nothing is read where nothing was given. Places are longitude and
    /// latitude, or the dataset's x and y where it has no coordinate system or this build no PROJ (not so for tracks,
    /// which know but the former). Heights are taken as heights of the dataset, whatever the track's recorder counted
    /// from; where one is missing it is that of the edited ground.
    ///
    /// Throws Error(usage) naming the option that is wrong, Error(input) for a track that cannot be read,
    /// Error(georeference) for a place that the dataset's coordinate system does not have, or that has neither height
    /// nor ground.
    [[nodiscard]] std::vector<OverlayMesh> meshes(const TileSource& source, const EditList& edits) const;

    /// Every option by name without its dashes, as it is in force, for manifests.
    [[nodiscard]] Json toJson() const;

  private:
    std::vector<std::string> tracks_;
    double trackRadius_ = 5;
    std::vector<std::string> markers_;
    std::vector<std::string> cubes_;
};

}  // namespace terray
