#pragma once
// A server in this process that serves the small dataset as "small", at a free port of 127.0.0.1.

#include <csignal>
#include <string>

#include "server/server.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/raw_client.h"
#include "tests/server/small_dataset.h"

namespace terray::server {

class RunningServer {
  public:
    explicit RunningServer(ServerOptions options = {}) : RunningServer(std::move(options), [](const auto&) {}) {}
    /// @param prepare  called with the dataset's directory before it is opened
    template <class Prepare>
    RunningServer(ServerOptions options, Prepare prepare) : directory_(temporary_ / "small") {
        std::signal(SIGPIPE, SIG_IGN);
        writeSmallDataset(directory_);
        prepare(directory_);
        if (options.listen == ServerOptions().listen) options.listen = "127.0.0.1:0";
        catalogue_ = openCatalogue({{"small", directory_}});
        server_ = std::make_unique<Server>(std::move(options), catalogue_);
        server_->start();
    }

    [[nodiscard]] Server& server() { return *server_; }
    [[nodiscard]] const std::filesystem::path& directory() const { return directory_; }
    [[nodiscard]] const Catalogue& catalogue() const { return *catalogue_; }
    [[nodiscard]] std::string version() const { return catalogue_->datasets().front()->version; }
    [[nodiscard]] uint16_t port() const {
        const std::string address = server_->addresses().front();
        return static_cast<uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
    }
    [[nodiscard]] RawClient client() const { return RawClient(port()); }
    [[nodiscard]] RawAnswer get(const std::string& target, const std::string& fields = "") const {
        return client().ask("GET", target, fields);
    }
    /// The value of a line of /metrics, such as "terray_server_connections".
    [[nodiscard]] double metric(const std::string& name) const {
        const std::string text = "\n" + get("/metrics").body;
        const size_t line = text.find("\n" + name + " ");
        TERRAY_CHECK(line != std::string::npos);
        return std::stod(text.substr(line + name.size() + 2));
    }

  private:
    test::TemporaryDirectory temporary_;
    std::filesystem::path directory_;
    std::shared_ptr<const Catalogue> catalogue_;
    std::unique_ptr<Server> server_;
};

}  // namespace terray::server
