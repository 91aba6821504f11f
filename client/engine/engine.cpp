#include "client/engine/engine.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <limits>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "client/engine/draw_costs_file.h"
#include "client/engine/engine_setup.h"
#include "client/engine/program.h"
#include "client/engine/resident_tiles.h"
#include "client/engine/sun_clock.h"
#include "client/engine/upload_pace.h"
#include "client/stream/camera_motion.h"

namespace terray {
namespace {

/// Tiles that the tree may know before it forgets what is far from resident ones: about 25 MB.
constexpr size_t kMaxKnownTiles = size_t{1} << 18;
constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

using KeySet = std::unordered_set<TileKey, TileKeyHash>;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Where the camera is expected, tiles are read ahead: what it sees when these are over.
constexpr std::array<double, 2> kSecondsAhead{0.4, 1.0};
constexpr size_t kMostTilesAhead = 32;

/// A tile that was uploaded is evicted and needed again within one wait only while what is found out of the ground
/// makes detail be given up.
constexpr int kMostUploadsInAWait = 3;

/// Size of what is drawn of a picture.
glm::ivec2 heldOf(glm::ivec2 picture, const std::optional<GridRect>& part) {
    return part ? glm::ivec2(part->width, part->height) : picture;
}

}  // namespace

struct Engine::State {
    State(const TileSource& tiles, const ShaderLibrary& shaders, const EngineOptions& given, glm::ivec2 size,
          const std::optional<GridRect>& drawn)
        : source(tiles),
          options(settled(given, source)),
          earth(earthOf(source.metadata(), options, size.x, size.y)),
          sunClock(clockOf(source.metadata(), options)),
          resident(source, shaders, slotOptions(source, options, earth), options.features.imagery),
          renderer(shaders, source.metadata().tiling),
          targets(heldOf(size, drawn).x, heldOf(size, drawn).y, options.features, options.colour),
          picture(size),
          part(drawn),
          uploadPace(options.uploadBytesPerFrame, options.uploadShare),
          mostPending(mostPendingTiles(options.pager.hostBudgetBytes)),
          pager(source, withoutPending(options.pager)) {
        const DatasetMetadata& metadata = source.metadata();
        options.selection.maxHeightTiles = tilesBesideRoot(resident.gpu().heightSlots(), metadata.heightTiles);
        options.selection.maxImageryTiles = tilesBesideRoot(resident.gpu().imagerySlots(), metadata.imageryTiles);
    }

    /// Selects for the current view from what is resident, and protects what is drawn from eviction.
    void selectAndPin();
    /// Takes what the pager has: tiles to be uploaded, and failures to be told.
    void takeArrivals(size_t maxTiles);
    /// The wanted tiles that can still be had: not failed, and of a layer that has slots left for them.
    [[nodiscard]] std::vector<TileRequest> attainable() const;
    /// Those of them that have not arrived.
    [[nodiscard]] std::vector<TileRequest> notPending(const std::vector<TileRequest>& requests) const;
    /// What the camera as it moves will want soon.
    [[nodiscard]] std::vector<TileRequest> tilesAhead();
    [[nodiscard]] View viewFrom(const Camera& camera) const;
    void resize(glm::ivec2 size, const std::optional<GridRect>& drawn);
    std::vector<TileKey> upload(const std::vector<TileRequest>& order, uint64_t budgetBytes);
    void learnUploadTime();
    /// One frame's share of paging: what has arrived is uploaded within the budget, what is lacking is asked for.
    void stream();
    /// Pages until the selection lacks nothing that can be had.
    void waitForTiles();
    void waitForArrivals(const std::vector<TileRequest>& requests);
    /// Takes over edits that were set since the last frame. @return whether there were any
    bool takeEdits();
    void note(const Uploads& uploads);
    void render();
    void fillReport();

    const TileSource& source;
    EngineOptions options;
    EarthModel earth;
    std::optional<SunClock> sunClock;
    ResidentTiles resident;
    TerrainRenderer renderer;
    FrameTargets targets;
    glm::ivec2 picture;            ///< width and height of what targets hold, or hold a part of
    std::optional<GridRect> part;  ///< of it
    GpuTimer timer;
    KeySet failed;
    CameraMotion motion;
    View view;
    Selection selection;
    FrameReport report;
    std::optional<EditList> newEdits;
    UploadPace uploadPace;
    size_t mostPending;   ///< tiles that may wait for upload
    bool frozen = false;  ///< the selection is that of an earlier frame
    Pager pager;          // last: its threads end first
};

void Engine::State::selectAndPin() {
    const glm::dvec3 sun = glm::normalize(options.render.sunDirection);
    options.selection.shadowsFrom.reset();
    if (options.render.shadows && sun.z > 0) options.selection.shadowsFrom = sun;
    selection = select(resident.tree(), view, options.selection);
    resident.pin(selection);
}

void Engine::State::takeArrivals(size_t maxTiles) {
    for (LoadedTile& tile : pager.takeLoaded(maxTiles)) resident.accept(std::move(tile));
    for (FailedTile& tile : pager.takeFailed()) {
        if (tile.loss == Loss::forGood) failed.insert({tile.layer, tile.id});
        auto& told = tile.loss == Loss::unreachable ? report.unreachable : report.failures;
        told.push_back(std::move(tile.message));
    }
}

std::vector<TileRequest> Engine::State::attainable() const {
    const bool heightsFull = resident.full(TileLayer::heights);
    const bool imageryFull = options.features.imagery && resident.full(TileLayer::imagery);
    std::vector<TileRequest> requests;
    for (const TileRequest& request : selection.wanted) {
        const bool full = request.layer == TileLayer::heights ? heightsFull : imageryFull;
        if (!full && !failed.contains(keyOf(request))) requests.push_back(request);
    }
    return requests;
}

std::vector<TileRequest> Engine::State::notPending(const std::vector<TileRequest>& requests) const {
    std::vector<TileRequest> missing;
    std::copy_if(requests.begin(), requests.end(), std::back_inserter(missing),
                 [&](const TileRequest& request) { return !resident.isPending(keyOf(request)); });
    return missing;
}

std::vector<TileKey> Engine::State::upload(const std::vector<TileRequest>& order, uint64_t budgetBytes) {
    std::vector<TileKey> uploaded;
    note(resident.upload(order, budgetBytes, &uploaded, &timer));
    return uploaded;
}

void Engine::State::learnUploadTime() {
    const auto ofPass = [this](GpuPass pass) { return report.gpuMs[static_cast<size_t>(pass)]; };
    const double uploadMs = ofPass(GpuPass::upload) + ofPass(GpuPass::edit);
    uploadPace.learn(uploadMs, report.uploadedBytes, std::max(report.frameMs - uploadMs, 0.0));
}

void Engine::State::note(const Uploads& uploads) {
    report.uploadedTiles += uploads.tiles;
    report.editedTiles += uploads.editedTiles;
    report.uploadedBytes += uploads.bytes;
}

bool Engine::State::takeEdits() {
    if (!newEdits) return false;
    note(resident.setEdits(*std::exchange(newEdits, std::nullopt), &timer));
    return true;
}

View Engine::State::viewFrom(const Camera& camera) const {
    View seen = viewOf(camera, picture.x, picture.y);
    seen.part = part;
    seen.earth = earth.at(camera.position);
    return exaggerated(seen, options.exaggeration);
}

std::vector<TileRequest> Engine::State::tilesAhead() {
    std::vector<TileRequest> tiles;
    for (const LoadedTile& tile : pager.takeAhead()) resident.learn(tile);
    for (const double seconds : kSecondsAhead) {
        const std::optional<Camera> camera = motion.ahead(seconds);
        if (!camera) break;
        const Selection there = select(resident.tree(), viewFrom(*camera), options.selection);
        tiles.insert(tiles.end(), there.wanted.begin(), there.wanted.end());
    }
    std::erase_if(tiles, [this](const TileRequest& tile) {
        return failed.contains(keyOf(tile)) || resident.isPending(keyOf(tile));
    });
    tiles.resize(std::min(tiles.size(), kMostTilesAhead));
    return tiles;
}

void Engine::State::stream() {
    takeArrivals(mostPending - std::min(mostPending, resident.pendingTiles()));
    resident.beginFrame();
    selectAndPin();
    const std::vector<TileRequest> order = attainable();
    resident.keepOnly(order);
    if (!upload(order, uploadPace.bytes()).empty()) selectAndPin();
    std::vector<TileRequest> missing = notPending(attainable());
    missing.resize(std::min(missing.size(), mostPending - std::min(mostPending, resident.pendingTiles())));
    pager.want(missing, options.prefetch ? tilesAhead() : std::vector<TileRequest>());
}

void Engine::State::waitForTiles() {
    std::unordered_map<TileKey, int, TileKeyHash> uploads;  // bounded, so that the loop ends
    for (;;) {
        throwIfInterrupted();
        resident.beginFrame();
        selectAndPin();
        std::vector<TileRequest> batch = attainable();
        std::erase_if(batch, [&](const auto& request) { return uploads[keyOf(request)] >= kMostUploadsInAWait; });
        batch.resize(std::min(batch.size(), mostPending));
        resident.keepOnly(batch);
        if (batch.empty()) break;

        const size_t failedBefore = report.failures.size();
        waitForArrivals(notPending(batch));
        const std::vector<TileKey> uploaded = upload(batch, kUnlimited);
        for (const TileKey& key : uploaded) ++uploads[key];
        const bool lostSome = report.failures.size() > failedBefore;
        if (!report.unreachable.empty() || (uploaded.empty() && !lostSome)) break;
    }
    selectAndPin();  // uploads of the last round may have evicted what was drawn
    pager.want({});
}

void Engine::State::waitForArrivals(const std::vector<TileRequest>& requests) {
    pager.want(requests);
    const Clock::time_point start = Clock::now();
    pager.waitUntilSettled();
    report.waitMs += millisecondsSince(start);
    takeArrivals(std::numeric_limits<size_t>::max());
}

void Engine::State::render() {
    renderer.render(view, selection.nodes, selection.casters, resident.gpu(), options.render, targets, &timer);
}

void Engine::State::fillReport() {
    report.nodes = selection.nodes.size();
    report.casters = selection.casters.size();
    report.bilinearNodes = renderer.bilinearNodes();
    report.rasterisedNodes = renderer.rasterisedNodes();
    if (const MethodTiles* tiles = resident.gpu().methodTiles()) {
        report.triangles = tiles->takeTriangles();
        report.bytesPerTriangle = tiles->bytesPerTriangle();
    }
    for (const DrawNode& node : selection.nodes)
        if (!node.heightsExact || !node.imageryExact) ++report.standIns;
    report.wanted = selection.wanted.size();
    report.coarsening = selection.coarsening;
    report.residentHeights = resident.gpu().residentHeights();
    report.residentImagery = resident.gpu().residentImagery();
    report.gpuTiles = resident.gpu().allocatedBytes();
    report.gpuTargets = targets.bytes();
    report.gpuBuffers = renderer.bufferBytes() + resident.gpu().editBufferBytes();
    report.pager = pager.statistics();
    report.hostBytes = report.pager.hostBytes + report.pager.comingBytes +
                       (report.pager.untaken + resident.pendingTiles()) * pendingTileBytes();
}

void requireAllTiles(const FrameReport& report, const std::string& consequence) {
    const auto refuse = [&](ExitCode code, const std::vector<std::string>& tiles, const char* advice) {
        if (tiles.empty()) return;
        const std::string others = tiles.size() > 1 ? ", and " + std::to_string(tiles.size() - 1) + " more" : "";
        throw Error(code, consequence + ": " + tiles.front() + others + advice);
    };
    refuse(ExitCode::dataset, report.failures, " (terray-preprocess verify lists all damaged tiles)");
    refuse(ExitCode::network, report.unreachable, " (is the server running? then try again)");
}

Engine::Engine(const TileSource& source, const ShaderLibrary& shaders, const EngineOptions& options, int width,
               int height, const std::optional<GridRect>& part)
    : state_(std::make_unique<State>(source, shaders, options, glm::ivec2(width, height), part)) {
    RenderOptions& render = state_->options.render;
    if (render.method.method == Method::hybrid && !render.drawCosts)
        render.drawCosts = settledDrawCosts(options.drawCostsFile, shaders);
    setExaggeration(options.exaggeration);
    state_->renderer.setOverlay(options.overlay);
    state_->options.overlay.clear();  // it is on the GPU
    if (!options.edits.empty()) setEdits(std::exchange(state_->options.edits, {}));
}

Engine::~Engine() = default;

FrameReport Engine::drawFrame(const Camera& camera, bool waitForTiles) {
    State& state = *state_;
    if (state.sunClock) state.options.render.sunDirection = state.sunClock->direction(camera.position);
    if (state.options.prefetch && !waitForTiles)
        state.motion.observe(camera, std::chrono::duration<double>(Clock::now().time_since_epoch()).count());
    return drawView(state.viewFrom(camera), waitForTiles);
}

FrameReport Engine::drawView(const View& view, bool waitForTiles) {
    const Clock::time_point start = Clock::now();
    State& state = *state_;
    TERRAY_CHECK_OP(view.drawn().width, ==, state.targets.width());
    TERRAY_CHECK_OP(view.drawn().height, ==, state.targets.height());
    state.report = {};
    state.view = view;
    state.timer.enter(GpuPass::upload);
    state.resident.forgetBeyond(kMaxKnownTiles);
    const bool edited = !state.frozen && state.takeEdits();
    if (state.frozen) {
        sortFrontToBack(state.selection.nodes, state.resident.tree().tiling(), state.view.eye);
    } else if (waitForTiles) {
        state.waitForTiles();
    } else {
        state.stream();
        if (edited) state.stream();  // what has left the GPU comes back from main memory at once
    }
    state.render();
    state.report.cpuMs = millisecondsSince(start) - state.report.waitMs;
    state.report.gpuMs = state.timer.finishFrame();
    state.report.frameMs = millisecondsSince(start) - state.report.waitMs;
    state.fillReport();
    state.learnUploadTime();
    return std::exchange(state.report, {});
}

void Engine::State::resize(glm::ivec2 size, const std::optional<GridRect>& drawn) {
    const glm::ivec2 held = heldOf(size, drawn);
    if (held != glm::ivec2(targets.width(), targets.height()))
        targets = FrameTargets(held.x, held.y, options.features, options.colour);
    if (picture != size) earth = earthOf(source.metadata(), options, size.x, size.y);
    picture = size;
    part = drawn;
}

void Engine::resize(int width, int height) {
    state_->resize({width, height}, std::nullopt);
}

void Engine::resizeToPart(int width, int height, const GridRect& part) {
    TERRAY_CHECK(part.x >= 0 && part.y >= 0 && part.width > 0 && part.height > 0);
    TERRAY_CHECK_OP(part.x + part.width, <=, width);
    TERRAY_CHECK_OP(part.y + part.height, <=, height);
    state_->resize({width, height}, part);
}

const EngineOptions& Engine::options() const {
    return state_->options;
}

void Engine::setOptions(const EngineOptions& given) {
    State& state = *state_;
    EngineOptions wanted = state.options;
    wanted.selection = given.selection;
    wanted.selection.useImagery &= state.resident.tree().hasImagery();
    wanted.selection.maxHeightTiles = state.options.selection.maxHeightTiles;  // what the budgets hold stays
    wanted.selection.maxImageryTiles = state.options.selection.maxImageryTiles;
    wanted.render = given.render;
    wanted.render.method = state.options.render.method;
    wanted.earth = given.earth;
    wanted.sunTime = given.sunTime;
    wanted.features.statistics = given.features.statistics;
    wanted = settled(wanted, state.source);

    const int width = state.targets.width(), height = state.targets.height();
    if (wanted.sunTime != state.options.sunTime) state.sunClock = clockOf(state.source.metadata(), wanted);
    if (wanted.earth != state.options.earth)
        state.earth = earthOf(state.source.metadata(), wanted, state.picture.x, state.picture.y);
    if (wanted.features != state.options.features)
        state.targets = FrameTargets(width, height, wanted.features, wanted.colour);
    state.options = std::move(wanted);
    setExaggeration(given.exaggeration);
}

void Engine::setExaggeration(double factor) {
    TERRAY_CHECK_OP(factor, >=, kLeastExaggeration);
    TERRAY_CHECK_OP(factor, <=, kGreatestExaggeration);
    state_->options.exaggeration = factor;
}

void Engine::freezeSelection(bool frozen) {
    state_->frozen = frozen && !state_->selection.nodes.empty();
}

void Engine::setEdits(EditList edits) {
    TERRAY_CHECK(valid(edits));
    state_->newEdits = std::move(edits);
}

void Engine::addEdit(TerrainEdit edit) {
    EditList edits = state_->newEdits ? *state_->newEdits : state_->resident.edits();
    edits.push_back(std::move(edit));
    setEdits(std::move(edits));
}

void Engine::setOverlay(std::span<const OverlayMesh> meshes) {
    state_->renderer.setOverlay(meshes);
}

const FrameTargets& Engine::targets() const {
    return state_->targets;
}

const std::vector<DrawNode>& Engine::nodes() const {
    return state_->selection.nodes;
}

const View& Engine::view() const {
    return state_->view;
}

View Engine::viewFrom(const Camera& camera) const {
    return state_->viewFrom(camera);
}

const EarthModel& Engine::earth() const {
    return state_->earth;
}

const GpuTiles& Engine::tiles() const {
    return state_->resident.gpu();
}

const ShadingOptions& Engine::shading() const {
    return state_->options.render.shading;
}

const std::optional<DrawCosts>& Engine::drawCosts() const {
    return state_->options.render.drawCosts;
}

const std::optional<TerrainRenderer::Calibration>& Engine::calibration() const {
    return state_->renderer.calibration();
}

glm::dvec3 Engine::worldFromHit(const DrawNode& node, const glm::vec4& hit) const {
    const ResidentHeights* heights = tiles().heights(node.heightTile);
    TERRAY_CHECK(heights != nullptr);
    const Tiling& tiling = state_->resident.tree().tiling();
    const double spacing = tiling.spacing(node.heightTile.level);
    const GroundRect bounds = tiling.bounds(node.heightTile);
    const HeightEncoding& encoding = heights->encoding;
    return {bounds.west + hit.x * spacing, bounds.north - hit.y * spacing,
            (static_cast<double>(encoding.offset) + hit.z) * encoding.metresPerCode()};
}

std::optional<glm::dvec3> Engine::placeAt(int column, int row) const {
    const FrameTargets& targets = state_->targets;
    if (column < 0 || row < 0 || column >= targets.width() || row >= targets.height()) return {};
    const uint32_t number = targets.readNode(column, row);
    if (number == 0 || number > nodes().size()) return {};
    return worldFromHit(nodes()[number - 1], targets.readHit(column, row));
}

}  // namespace terray
