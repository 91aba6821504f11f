#pragma once
// A client that sends exactly the bytes it is told to, and takes answers apart strictly.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace terray::server {

struct RawAnswer {
    int status = 0;
    std::map<std::string, std::string> fields;  ///< names in lower case
    std::string body;

    [[nodiscard]] std::string field(const std::string& name) const {
        const auto found = fields.find(name);
        return found == fields.end() ? "" : found->second;
    }
};

class RawClient {
  public:
    /// Connects to 127.0.0.1, or to another address of this machine.
    explicit RawClient(uint16_t port, const std::string& host = "127.0.0.1");
    ~RawClient();
    RawClient(RawClient&& other) noexcept;
    RawClient& operator=(RawClient&&) = delete;

    void send(std::string_view bytes);
    /// Sends a request with a Host field. @param fields  further ones, "Name: value\r\n" each
    void request(const std::string& method, const std::string& target, const std::string& fields = "");
    /// The next answer; none when the connection ended, or nothing came for 10 s.
    /// @param method  of the request it answers: an answer to HEAD has no body
    [[nodiscard]] std::optional<RawAnswer> answer(const std::string& method = "GET");
    /// request(), then answer(), which must be there.
    [[nodiscard]] RawAnswer ask(const std::string& method, const std::string& target, const std::string& fields = "");
    /// Whether the server has ended the connection, waiting for that up to 10 s; what it sends until then is dropped.
    [[nodiscard]] bool isEnded();
    /// Reads at most this much and keeps nothing. @return bytes read, 0 at the end
    size_t drop(size_t most);
    /// Ends the connection at once, by a reset.
    void abort();
    [[nodiscard]] int descriptor() const { return socket_; }

  private:
    [[nodiscard]] bool receive();

    int socket_ = -1;
    std::string received_;
};

}  // namespace terray::server
