#include "preprocess/build_context.h"

#include "common/parallel.h"

namespace terray {

void runStage(BuildContext& context, const std::string& what, const PyramidExtent& extent, const BlockStage& stage,
              const std::function<void(const TileId& top, int worker)>& build) {
    const std::vector<TileId> blocks = blocksOf(extent, stage);
    const uint32_t finest = stage.first ? stage.bottom : stage.bottom - 1;
    const std::string levels =
        finest == stage.top() ? std::to_string(finest) : std::to_string(finest) + " to " + std::to_string(stage.top());
    context.observer.stageBegins(what + " " + levels, blocks.size());
    forEachParallel(blocks.size(), context.jobs, context.stop, [&](int worker, size_t item) {
        build(blocks[item], worker);
        const std::scoped_lock lock(context.observerMutex);
        context.observer.blockDone(context.tiles, context.bytes);
    });
}

void storeTile(BuildContext& context, TileSpill& spill, const TileId& id, ByteView payload) {
    {
        const StepTimer timer(context.times, BuildStep::write);
        spill.add(id, payload);
    }
    const std::scoped_lock lock(context.observerMutex);
    ++context.tiles;
    context.bytes += payload.size();
}

}  // namespace terray
