#include "server/server.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/listener.h"
#include "server/worker.h"

namespace terray::server {

struct Server::State {
    ServerOptions options;
    Shared shared;
    AccessLog log;
    std::optional<TileStore> tiles;
    std::vector<std::unique_ptr<Worker>> workers;
    std::vector<std::unique_ptr<Listener>> listeners;  ///< on the first worker's thread

    explicit State(ServerOptions given)
        : options(std::move(given)), log(options.log, options.logDescriptor, shared.metrics.logLinesDropped) {
        shared.log = &log;
        if (options.cacheBytes > 0) shared.tiles = &tiles.emplace(TileStoreOptions{options.cacheBytes}, shared.metrics);
    }

    /// The worker with the fewest connections.
    Worker& leastLoaded() {
        const auto fewer = [](const auto& a, const auto& b) { return a->connections() < b->connections(); };
        return **std::min_element(workers.begin(), workers.end(), fewer);
    }
};

Server::Server(ServerOptions options, std::shared_ptr<const Catalogue> catalogue)
    : state_(std::make_unique<State>(std::move(options))) {
    const ServerOptions& given = state_->options;
    const auto threads = static_cast<size_t>(std::max(given.threads, 1));
    const WorkerLimits limits = {.connections = std::max<size_t>(given.maxConnections / threads, 1),
                                 .idleTimeout = given.idleTimeout,
                                 .headTimeout = std::min(given.headTimeout, given.idleTimeout),
                                 .head = given.head};
    const std::vector<Endpoint> endpoints = resolve(parseListenAddress(given.listen));
    for (size_t i = 0; i < threads; ++i)
        state_->workers.push_back(std::make_unique<Worker>(limits, state_->shared, catalogue));
    for (const Endpoint& endpoint : endpoints)
        state_->listeners.push_back(std::make_unique<Listener>(state_->workers.front()->context(), endpoint));
}

Server::~Server() {
    stop(std::chrono::milliseconds(0));
    join();
}

std::vector<std::string> Server::addresses() const {
    std::vector<std::string> texts;
    for (const auto& listener : state_->listeners) texts.push_back(toText(listener->endpoint()));
    return texts;
}

void Server::start() {
    const auto take = [state = state_.get()](int socket, std::string peer) {
        state->leastLoaded().adopt(socket, std::move(peer));
    };
    for (const auto& listener : state_->listeners) listener->start(take);
    for (const auto& worker : state_->workers) worker->start();
}

void Server::reload(std::shared_ptr<const Catalogue> catalogue) {
    for (const auto& worker : state_->workers) worker->replaceCatalogue(catalogue);
    state_->shared.metrics.reloads.fetch_add(1, std::memory_order_relaxed);
}

void Server::stop(std::chrono::milliseconds grace) {
    for (const auto& listener : state_->listeners) listener->close();
    for (const auto& worker : state_->workers) worker->stop(grace);
}

bool Server::hasEnded() const {
    return std::all_of(state_->workers.begin(), state_->workers.end(),
                       [](const auto& worker) { return worker->hasEnded(); });
}

void Server::join() {
    for (const auto& worker : state_->workers) worker->join();
}

}  // namespace terray::server
