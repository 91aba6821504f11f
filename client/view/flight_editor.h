#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "client/stream/flight_editing.h"

namespace terray {

/// A flight while a person edits it key by key: with a selected key, a moment that is looked at, and the way back to
/// what it was. What cannot be is refused with a sentence, and nothing has changed. No window, no GL; one thread.
///
/// A flight that is edited may have no key yet; then its only edit is to add one.
class FlightEditor {
  public:
    /// Between the last key and one that is added behind it.
    static constexpr double kStepSeconds = 5;
    /// Flights that can be gone back to hold at most so many keys together (64 MB); the last one always stays.
    static constexpr size_t kMostKeptKeys = size_t{1} << 20;

    /// @param changed  whether the flight is not as any file has it
    explicit FlightEditor(Flight flight, bool changed = false) : flight_(std::move(flight)), changed_(changed) {}

    [[nodiscard]] const Flight& flight() const { return flight_; }
    /// Index of a key; none where there is no key, or where none was chosen.
    [[nodiscard]] std::optional<size_t> selected() const { return selected_; }
    /// Counts whatever changes the flight or the selection: for who draws them.
    [[nodiscard]] uint64_t revision() const { return revision_; }
    /// Whether there is something that saved() was not told of.
    [[nodiscard]] bool changed() const { return changed_; }
    void saved() { changed_ = false; }
    /// Which flight this one has come from: another after replace(), the one before after undo(). So a file that was
    /// loaded is known not to be this flight's.
    [[nodiscard]] uint64_t origin() const { return origin_; }

    /// Chooses a key and looks at its moment. @param key  an index of the flight's
    void select(size_t key);
    /// The key before or behind the chosen one, or nearest before or behind the moment.
    void selectPrevious();
    void selectNext();

    /// The moment that is looked at, 0 .. flight().seconds().
    [[nodiscard]] double seconds() const { return seconds_; }
    void scrub(double seconds);
    /// Where the flight is at that moment; none without keys.
    [[nodiscard]] std::optional<Camera> camera() const;
    [[nodiscard]] bool playing() const { return playing_; }
    /// From the moment on, or from the start when that is the end. A flight of no length does not play.
    void play();
    void pause() { playing_ = false; }
    /// Time goes by while it plays; at the end it pauses.
    void advance(double seconds);

    // Edits. Each can be undone, and the key that it is about is selected after it.

    /// Behind the last key, kStepSeconds later; the first key is at second 0.
    Result<void> append(const Camera& camera);
    /// Half way between the selected key and the next; behind the last one, or with none selected, as append().
    Result<void> insert(const Camera& camera);
    /// At the moment that is looked at.
    Result<void> addHere(const Camera& camera);
    /// The selected key, if there is one, is put elsewhere, is deleted, or gets another time.
    Result<void> move(const Camera& camera);
    Result<void> remove();
    /// @param andLater  all later keys move by as much
    Result<void> retime(double seconds, bool andLater);
    Result<void> setDuration(double seconds);
    /// Leaves out keys without which the path stays so near. @param place, angle  both > 0
    Result<void> thin(Metres place, Radians angle);
    /// Another flight in place of this one.
    void replace(Flight flight);

    [[nodiscard]] bool canUndo() const { return !before_.empty(); }
    [[nodiscard]] bool canRedo() const { return !undone_.empty(); }
    void undo();
    void redo();

  private:
    struct Step {
        Flight flight;
        std::optional<size_t> selected;
        uint64_t origin = 0;
    };
    /// Takes an edited flight over. @param selected  of it
    void commit(Flight edited, std::optional<size_t> selected);
    void restore(std::vector<Step>& from, std::vector<Step>& to);
    Result<void> addAt(double seconds, const Camera& camera);
    /// The selected key for an edit of it, or the sentence that there is none.
    [[nodiscard]] Result<size_t> key() const;

    Flight flight_;
    std::optional<size_t> selected_;
    double seconds_ = 0;
    bool playing_ = false;
    bool changed_;
    uint64_t revision_ = 0;
    uint64_t origin_ = 0;
    uint64_t origins_ = 0;  ///< that there have been
    std::vector<Step> before_;
    std::vector<Step> undone_;
};

}  // namespace terray
