// What a person does to a flight with the keyframe editor.

#include <utility>
#include <vector>

#include "client/exchange/flight_files.h"
#include "client/view/flight_marks.h"
#include "client/view/viewer_state.h"
#include "common/error.h"

namespace terray {

void Viewer::State::openOrCloseEditor() {
    if (editor) {
        if (!editor->flight().keys.empty()) lastFlight = editor->flight();
        lastFlightChanged = editor->changed();
        editor.reset();
        stale = true;
        return;
    }
    replayed.reset();
    editor.emplace(lastFlight, lastFlightChanged);
    editedFile.reset();
    editorPanel.file = pictureName("flight-", ".json").string();
    editorPanel.projection = projectionOrNull();
    if (!lastFlight.keys.empty()) editor->select(0);
}

void Viewer::State::edit(Command command) {
    if (!editor) return;
    Result<void> done;
    switch (command) {
        case Command::insertKey:
            done = editor->insert(navigator.camera());
            break;
        case Command::moveKey:
            done = editor->move(navigator.camera());
            break;
        case Command::deleteKey:
            done = editor->remove();
            break;
        case Command::previousKey:
            editor->selectPrevious();
            lookAtMoment();
            break;
        case Command::nextKey:
            editor->selectNext();
            lookAtMoment();
            break;
        case Command::undo:
            editor->undo();
            break;
        case Command::redo:
            editor->redo();
            break;
        case Command::save:
            saveEdited();
            break;
        default:
            break;
    }
    if (!done) say(done.failure().message);
}

void Viewer::State::saveEdited() {
    const std::filesystem::path path = editorPanel.file;
    if (editor->flight().keys.empty()) return say("the flight has no key yet: add one first");
    if (path.empty()) return say("the flight was not saved: its file has no name");
    // What was recorded stays, unless it is what the person works on.
    const bool isOwn = path == editedFile && editedOrigin == editor->origin();
    std::error_code unknown;
    if (!isOwn && std::filesystem::exists(path, unknown))
        return say("the flight was not saved: " + path.string() + " exists; give another name, or load it first");
    Flight flight = editor->flight();
    flight.dataset = options.datasetName;
    if (flight.name.empty()) flight.name = path.stem().string();
    exportFlight(flight, path, projectionOrNull());
    keepEditedFile(path);
    editor->saved();
    lastFlight = std::move(flight);
    say("flight of " + std::to_string(lastFlight.keys.size()) + " keys: " + path.string());
}

void Viewer::State::keepEditedFile(const std::filesystem::path& path) {
    editedFile = path;
    editedOrigin = editor->origin();
    editorPanel.file = path.string();
}

void Viewer::State::loadToEdit() {
    const std::filesystem::path path = editorPanel.file;
    GroundHeights heights(source, options.engine.edits);
    editor->replace(importFlight(path, {}, projectionOrNull(), heights));
    editor->saved();
    editor->select(0);
    // Another program's file stays what it is.
    const bool ours = path.extension() == ".json";
    editedFile.reset();
    if (ours)
        keepEditedFile(path);
    else
        editorPanel.file = pictureName("flight-", ".json").string();
    lookAtMoment();
}

void Viewer::State::lookAtMoment() {
    if (const auto camera = editor->camera()) navigator.place(*camera);
}

std::optional<uint64_t> Viewer::State::wantedMarks() const {
    if (!editor) return {};
    // An eye on the path itself would have its line before it.
    const auto flown = editor->camera();
    if (flown && flown->position == navigator.camera().position) return {};
    return editor->revision();
}

void Viewer::State::drawMarks() {
    const auto wanted = wantedMarks();
    if (wanted == marked) return;
    std::vector<OverlayMesh> meshes = options.engine.overlay;
    if (wanted)
        for (OverlayMesh& mesh : flightMarks(editor->flight(), editor->selected())) meshes.push_back(std::move(mesh));
    engine.setOverlay(meshes);
    marked = wanted;
}

void Viewer::State::declareEditor() {
    bool open = true;
    const EditorWishes wishes = drawEditor(*editor, editorPanel, navigator.camera(), open);
    if (wishes.look) lookAtMoment();
    if (!wishes.failure.empty()) say(wishes.failure);
    try {
        if (wishes.save) saveEdited();
        if (wishes.load) loadToEdit();
    } catch (const Error& error) {
        say(error.what());
    }
    if (!open) openOrCloseEditor();
}

}  // namespace terray
