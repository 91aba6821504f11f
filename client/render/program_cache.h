#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "client/render/feature_set.h"
#include "client/render/shader_library.h"

namespace terray {

/// One program in as many variants as feature sets were asked for, each compiled on first use and kept. GL thread only.
class ProgramCache {
  public:
    /// @param shaders  outlives the cache
    ProgramCache(const ShaderLibrary& shaders, std::vector<std::string> stages)
        : shaders_(shaders), stages_(std::move(stages)) {}

    /// Throws Error(graphics) when it does not compile.
    const GlProgram& get(const FeatureSet& features) {
        GlProgram& program = programs_[features];
        if (!program) program = shaders_.require(stages_, features.defines());
        return program;
    }

  private:
    const ShaderLibrary& shaders_;
    std::vector<std::string> stages_;
    std::map<FeatureSet, GlProgram> programs_;
};

}  // namespace terray
