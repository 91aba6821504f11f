#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <glm/vec3.hpp>

#include "client/render/gl_objects.h"
#include "client/render/shader_library.h"
#include "common/units.h"

namespace terray {

/// What a sky depends on.
struct SkyView {
    Metres eyeHeight;      ///< above the sea
    Radians sunElevation;  ///< above the horizontal plane
};

/// Whether the sky of `now` looks other than that of `before`: the sun has moved by more than 0.03 degrees up or down,
/// or the horizon has. 0.03 degrees is half a pixel of a picture of 720 lines and 45 degrees; brightness then changes
/// by less than 1 %, at twilight too.
[[nodiscard]] bool looksOther(const SkyView& before, const SkyView& now);

/// The sky as a small table on the GPU, so that a pixel of sky costs one look-up: Rayleigh, aerosol and ozone over a
/// spherical earth, first scattering integrated, further orders approximated (shaders/sky/model.glsl). Light on the
/// ground comes from the same model: at 40 degrees of sun it is that of shaders/daylight.glsl, lower it is dimmer and
/// redder.
///
/// Made by compute shaders: tables of the air once (for one visual range), the table of a moment when update() finds
/// that it looks other. Cost on llvmpipe, 2 cores: see tests/bench/REPORT.md. GL thread only. Throws Error(graphics)
/// when a shader does not compile.
class SkyTable {
  public:
    static constexpr int kWidth = 192;   ///< azimuths from the sun, 0 .. pi
    static constexpr int kHeight = 108;  ///< elevations: below, above the horizon
    /// Aerial perspective: azimuths, elevations, distances.
    static constexpr int kAirWidth = 48;
    static constexpr int kAirHeight = 64;
    static constexpr int kAirSlices = 16;

    struct Options {
        Metres visualRange{80000};  ///< of the air at sea level: sets its aerosol; pure air has 323 km
        bool airlight = false;      ///< a second table, for aerial perspective
        bool operator==(const Options&) const = default;
    };
    SkyTable(const ShaderLibrary& shaders, const Options& options);

    /// Makes the table anew when what it shows looks other. @return whether it did
    bool update(const SkyView& view);

    /// Binds tables and parameters where shaders/sky.glsl reads them. Needs an update() before.
    void bind() const;

    [[nodiscard]] const Options& options() const { return options_; }
    [[nodiscard]] uint64_t bytes() const;
    /// RGBA16F, kWidth x kHeight.
    [[nodiscard]] const GlTexture& texture() const { return table_; }
    /// RGBA16F, kAirWidth x kAirHeight x kAirSlices; without a name when there is no airlight.
    [[nodiscard]] const GlTexture& airTexture() const { return air_; }
    /// interop::SkyParameters.
    [[nodiscard]] const GlBuffer& parameters() const { return parameters_; }

  private:
    void makeAir(const ShaderLibrary& shaders);
    void measureLight(const GlBuffer& into) const;
    void giveInput(double sunSine, double eyeHeight) const;
    void useModel(const GlProgram& program) const;

    Options options_;
    GlProgram lightProgram_, exposeProgram_, tableProgram_, airProgram_;
    GlTexture transmittances_, echoes_, table_, air_;
    GlBuffer input_, referenceLights_, lights_, parameters_;
    GlSampler sampler_;
    std::optional<SkyView> made_;
};

}  // namespace terray
