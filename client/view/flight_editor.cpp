#include "client/view/flight_editor.h"

#include <algorithm>
#include <utility>

#include "common/check.h"

namespace terray {

void FlightEditor::select(size_t key) {
    TERRAY_CHECK_OP(key, <, flight_.keys.size());
    selected_ = key;
    seconds_ = flight_.keys[key].seconds;
    playing_ = false;
    ++revision_;
}

void FlightEditor::selectPrevious() {
    const auto first = flight_.keys.begin();
    const auto from = std::lower_bound(first, flight_.keys.end(), seconds_,
                                       [](const FlightKey& key, double time) { return key.seconds < time; });
    const auto index = static_cast<size_t>(from - first);
    if (index > 0) select(index - 1);
}

void FlightEditor::selectNext() {
    const auto first = flight_.keys.begin();
    const auto from = std::upper_bound(first, flight_.keys.end(), seconds_,
                                       [](double time, const FlightKey& key) { return time < key.seconds; });
    if (from != flight_.keys.end()) select(static_cast<size_t>(from - first));
}

void FlightEditor::scrub(double seconds) {
    seconds_ = std::clamp(seconds, 0.0, flight_.seconds());
    playing_ = false;
}

std::optional<Camera> FlightEditor::camera() const {
    if (flight_.keys.empty()) return {};
    return flight_.at(seconds_);
}

void FlightEditor::play() {
    if (seconds_ >= flight_.seconds()) seconds_ = 0;
    playing_ = flight_.seconds() > 0;
}

void FlightEditor::advance(double seconds) {
    if (!playing_) return;
    seconds_ = std::min(seconds_ + seconds, flight_.seconds());
    playing_ = seconds_ < flight_.seconds();
}

void FlightEditor::commit(Flight edited, std::optional<size_t> selected) {
    before_.push_back({std::exchange(flight_, std::move(edited)), selected_, origin_});
    undone_.clear();
    size_t keys = 0;
    for (const Step& step : before_) keys += step.flight.keys.size();
    // The oldest ways back go first.
    auto kept = before_.begin();
    for (; keys > kMostKeptKeys && kept + 1 != before_.end(); ++kept) keys -= kept->flight.keys.size();
    before_.erase(before_.begin(), kept);
    changed_ = true;
    selected_ = selected;
    scrub(selected ? flight_.keys[*selected].seconds : seconds_);
    ++revision_;
}

void FlightEditor::restore(std::vector<Step>& from, std::vector<Step>& to) {
    if (from.empty()) return;
    Step step = std::move(from.back());
    from.pop_back();
    to.push_back({std::exchange(flight_, std::move(step.flight)), selected_, std::exchange(origin_, step.origin)});
    selected_ = step.selected;
    changed_ = true;
    scrub(seconds_);
    ++revision_;
}

void FlightEditor::undo() {
    restore(before_, undone_);
}

void FlightEditor::redo() {
    restore(undone_, before_);
}

Result<void> FlightEditor::addAt(double seconds, const Camera& camera) {
    Flight edited = flight_;
    const auto index = addKey(edited, seconds, camera);
    if (!index) return index.failure();
    commit(std::move(edited), *index);
    return {};
}

Result<void> FlightEditor::append(const Camera& camera) {
    return addAt(flight_.keys.empty() ? 0 : flight_.seconds() + kStepSeconds, camera);
}

Result<void> FlightEditor::insert(const Camera& camera) {
    if (!selected_ || *selected_ + 1 == flight_.keys.size()) return append(camera);
    return addAt((flight_.keys[*selected_].seconds + flight_.keys[*selected_ + 1].seconds) / 2, camera);
}

Result<void> FlightEditor::addHere(const Camera& camera) {
    return addAt(seconds_, camera);
}

Result<size_t> FlightEditor::key() const {
    if (selected_) return *selected_;
    return Failure{flight_.keys.empty() ? "the flight has no key yet: add one first" : "select a key first"};
}

Result<void> FlightEditor::move(const Camera& camera) {
    const auto index = key();
    if (!index) return index.failure();
    Flight edited = flight_;
    moveKey(edited, *index, camera);
    commit(std::move(edited), *index);
    return {};
}

Result<void> FlightEditor::remove() {
    const auto index = key();
    if (!index) return index.failure();
    Flight edited = flight_;
    if (auto done = deleteKey(edited, *index); !done) return done;
    const size_t last = edited.keys.size() - 1;
    commit(std::move(edited), std::min(*index, last));
    return {};
}

Result<void> FlightEditor::retime(double seconds, bool andLater) {
    const auto index = key();
    if (!index) return index.failure();
    Flight edited = flight_;
    auto done = andLater ? retimeFrom(edited, *index, seconds) : retimeKey(edited, *index, seconds);
    if (!done) return done;
    commit(std::move(edited), *index);
    return {};
}

Result<void> FlightEditor::setDuration(double seconds) {
    Flight edited = flight_;
    if (auto done = terray::setDuration(edited, seconds); !done) return done;
    commit(std::move(edited), selected_);
    return {};
}

Result<void> FlightEditor::thin(Metres place, Radians angle) {
    if (!(place > Metres(0) && angle > Radians(0)))
        return Failure{"a path cannot be thinned to within " + Json(place.value()).dump(0) +
                       " m, expected more than 0"};
    Flight few = thinned(flight_, place, angle);
    if (few.keys.size() == flight_.keys.size()) return Failure{"no key can be left out within that distance"};
    commit(std::move(few), std::nullopt);
    return {};
}

void FlightEditor::replace(Flight flight) {
    commit(std::move(flight), std::nullopt);
    origin_ = ++origins_;
}

}  // namespace terray
