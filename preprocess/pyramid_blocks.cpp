#include "preprocess/pyramid_blocks.h"

#include <algorithm>

#include "common/error.h"
#include "common/parallel.h"

namespace terray {
namespace {

const char* nameOf(Pyramid pyramid) {
    return pyramid == Pyramid::heights ? "heights" : "imagery";
}

std::string stageName(Pyramid pyramid, const BlockStage& stage) {
    const uint32_t finest = stage.first ? stage.bottom : stage.bottom - 1;
    const std::string levels =
        finest == stage.top() ? std::to_string(finest) : std::to_string(finest) + " to " + std::to_string(stage.top());
    return std::string(nameOf(pyramid)) + " " + levels;
}

BlockRecord requireRecord(ByteView content) {
    auto record = decodeBlockRecord(content);
    if (!record.ok())
        throw Error(ExitCode::output,
                    "cannot go on with the build: " + record.failure().message + "; start it anew, without --resume");
    return *std::move(record);
}

}  // namespace

PyramidBlocks::PyramidBlocks(Pyramid pyramid, const PyramidExtent& extent, BuildContext& context)
    : pyramid_(pyramid),
      extent_(extent),
      context_(context),
      spill_(context.workDirectory / (std::string(nameOf(pyramid)) + "-tiles")) {
    if (!context.team.leads()) return;
    uint64_t end = 0;
    forEachRecord([&](uint64_t place, const BlockRecord& record) {
        found_[record.bottom].push_back(place);
        for (const StoredTile& tile : record.tiles) end = std::max(end, tile.offset + tile.length);
    });
    spillEnd_ = end;
}

void PyramidBlocks::runStage(const BlockStage& stage, const StageWork& work) {
    const std::vector<TileId> blocks = blocksOf(extent_, stage);
    std::vector<WorkFile*> data = {&spill_};
    if (work.level != nullptr) data.push_back(work.level);
    TeamStage task{.jobs = context_.jobs, .stop = context_.stop, .spillEnd = spillEnd_, .begin = work.begin};
    task.build = [&](size_t block, int worker) {
        BlockRecord record{.pyramid = pyramid_, .bottom = stage.bottom, .top = blocks.at(block)};
        work.build(record, worker);
        record.sortTiles();
        return record;
    };
    if (context_.team.leads())
        lead(stage, work, blocks, data, task);
    else
        follow(stage, work, data, task);
}

void PyramidBlocks::lead(const BlockStage& stage, const StageWork& work, const std::vector<TileId>& blocks,
                         std::span<WorkFile* const> data, TeamStage& task) {
    Stage& running = stages_.emplace_back(Stage{stage, std::vector<uint64_t>(blocks.size(), 0)});
    const uint64_t done = takeUp(blocks, running, work);
    for (size_t block = 0; block < blocks.size(); ++block)
        if (running.places[block] == 0) task.blocks.push_back(block);
    const auto tellStage = [&] { context_.observer.stageBegins(stageName(pyramid_, stage), blocks.size(), done); };
    task.begin = [&] {
        if (work.begin) work.begin();
        tellStage();
    };
    if (task.blocks.empty()) tellStage();

    task.keep = [&](size_t block, const BlockRecord& record, bool isOwn) {
        {
            const StepTimer timer(context_.times, BuildStep::write);
            const bool isToSync = isOwn && !record.tiles.empty();
            running.places.at(block) =
                context_.journal.commit(encodeBlockRecord(record), data.first(isToSync ? data.size() : 0));
        }
        const std::scoped_lock lock(context_.mutex);
        work.take(record);
        count(record);
        context_.observer.blockDone(context_.tiles, context_.bytes);
    };
    // The next stage takes away what this one has read, so that all of this one must be safe.
    task.end = [&] { context_.journal.sync(); };
    context_.team.runStage(task);
    if (context_.team.processes() > 1)
        for (WorkFile* const file : data) file->reopen();
}

void PyramidBlocks::follow(const BlockStage& stage, const StageWork& work, std::span<WorkFile* const> data,
                           TeamStage& task) {
    task.sync = [&](const BlockRecord& record) {
        if (record.tiles.empty()) return;
        const StepTimer timer(context_.times, BuildStep::write);
        for (WorkFile* const file : data) file->sync();
    };
    context_.team.runStage(task);
    for (WorkFile* const file : data) file->reopen();
    context_.journal.refresh();
    forEachRecord([&](uint64_t, const BlockRecord& record) {
        if (record.bottom != stage.bottom) return;
        const std::scoped_lock lock(context_.mutex);
        work.take(record);
        count(record);
    });
}

void PyramidBlocks::forEachRecord(const std::function<void(uint64_t place, const BlockRecord& record)>& visit) const {
    context_.journal.forEach([&](uint64_t place, ByteView content) {
        if (place == 0) return;
        const BlockRecord record = requireRecord(content);
        if (record.pyramid == pyramid_) visit(place, record);
    });
}

std::filesystem::path PyramidBlocks::workspaceDirectory() const {
    return context_.workDirectory / (std::string(nameOf(pyramid_)) + "-sources");
}

SourceWorkspace PyramidBlocks::workspace() const {
    std::filesystem::create_directories(workspaceDirectory());
    return {.directory = workspaceDirectory(),
            .stop = context_.stop,
            .partBegins = [this](const std::string& name,
                                 uint64_t steps) { context_.observer.stageBegins(name, steps, 0); },
            .stepDone = [this] { context_.observer.blockDone(context_.tiles, context_.bytes); }};
}

void PyramidBlocks::release() {
    context_.team.meet(context_.stop);
    if (context_.team.leads()) std::filesystem::remove_all(workspaceDirectory());
}

void PyramidBlocks::discard(WorkFile& level) {
    if (context_.team.leads()) level.discard();
}

uint64_t PyramidBlocks::takeUp(const std::vector<TileId>& blocks, Stage& stage, const StageWork& work) {
    const std::vector<uint64_t> places = std::exchange(found_[stage.stage.bottom], {});
    for (const uint64_t place : places) {
        const BlockRecord record = recordAt(place);
        const auto block = std::ranges::lower_bound(blocks, hilbertId(record.top), {}, hilbertId);
        TERRAY_CHECK(block != blocks.end() && *block == record.top);
        stage.places[static_cast<size_t>(block - blocks.begin())] = place;
        const std::scoped_lock lock(context_.mutex);
        work.take(record);
        count(record);
    }
    return places.size();
}

void PyramidBlocks::count(const BlockRecord& record) {
    const uint64_t bytes = record.payloadBytes();
    if (context_.tiles == 0 && !record.tiles.empty()) context_.firstTileDone();
    tiles_ += record.tiles.size();
    bytes_ += bytes;
    context_.tiles += record.tiles.size();
    context_.bytes += bytes;
}

void PyramidBlocks::store(BlockRecord& record, const TileId& id, ByteView payload) {
    const StepTimer timer(context_.times, BuildStep::write);
    const uint64_t offset = context_.team.reserve(payload.size());
    spill_.write(offset, payload);
    record.tiles.push_back({id, offset, static_cast<uint32_t>(payload.size())});
}

BlockRecord PyramidBlocks::recordAt(uint64_t place) const {
    return requireRecord(context_.journal.read(place));
}

void PyramidBlocks::forEachTile(const std::function<void(const StoredTile&)>& visit) const {
    // Coarse levels first; within a level blocks, and within a block tiles, lie along the curve already.
    for (auto stage = stages_.rbegin(); stage != stages_.rend(); ++stage) {
        const uint32_t finest = stage->stage.first ? stage->stage.bottom : stage->stage.bottom - 1;
        for (uint32_t level = stage->stage.top(); level <= finest; ++level)
            for (const uint64_t place : stage->places) {
                if (place == 0) continue;
                for (const StoredTile& tile : recordAt(place).tiles)
                    if (tile.id.level == level) visit(tile);
            }
    }
}

PmtilesContents PyramidBlocks::contents() {
    return {.list =
                [this](const std::function<void(const TileId&, uint32_t)>& tell) {
                    forEachTile([&](const StoredTile& tile) { tell(tile.id, tile.length); });
                },
            .payloads =
                [this](const std::function<void(ByteView)>& write) {
                    Bytes payload;
                    forEachTile([&](const StoredTile& tile) {
                        throwIfStopped(context_.stop);
                        payload.resize(tile.length);
                        spill_.read(tile.offset, payload);
                        write(payload);
                    });
                }};
}

}  // namespace terray
