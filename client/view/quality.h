#pragma once

namespace terray {

/// Holds a frame rate while the camera moves: first fewer pixels, then coarser tiles; all of it back when it rests.
///
/// A quality of 1 is full, 0 the least. Each moving frame it goes by the frame's time against the goal's, quickly down
/// and slowly up, and keeps still within a tenth; pixels change in steps, so that targets are not made anew each frame.
class Quality {
  public:
    static constexpr double kLeastScale = 0.5;    ///< of width and height
    static constexpr double kMostTolerance = 4;   ///< factor on the tolerances
    static constexpr double kRestSeconds = 0.25;  ///< until a camera that stands still is drawn in full

    /// @param targetFps  0: always full
    void setTarget(double targetFps) { targetFps_ = targetFps; }
    /// Tells of a frame that was drawn. @param seconds  since the one before  @param moving  whether the camera moved
    void tell(double frameMs, double seconds, bool moving);

    [[nodiscard]] double quality() const;
    /// Of the picture's width and height, 0.5 to 1 in eighths.
    [[nodiscard]] double scale() const;
    /// On tolerances, 1 to 4.
    [[nodiscard]] double toleranceFactor() const;
    /// Whether the picture will be sharper than the last one though nothing moves.
    [[nodiscard]] bool sharpening() const { return targetFps_ > 0 && !resting_ && quality_ < 1; }

  private:
    double targetFps_ = 0;
    double quality_ = 1;
    double restedSeconds_ = 0;
    bool resting_ = true;
};

}  // namespace terray
