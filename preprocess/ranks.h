#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/bytes.h"
#include "common/error.h"

namespace terray {

/// The processes that build one dataset together, as each of them sees the others: a post office.
///
/// Messages from one process to another arrive whole and in the order in which they were sent. One thread at a time.
class Ranks {
  public:
    virtual ~Ranks() = default;
    /// This process: 0, which leads, to count() - 1.
    [[nodiscard]] virtual int rank() const = 0;
    [[nodiscard]] virtual int count() const = 0;
    /// Those of them that run on this machine, this one among them.
    [[nodiscard]] virtual int onThisMachine() const = 0;
    /// "process 3 on node07", for people.
    [[nodiscard]] virtual std::string name() const = 0;
    /// Returns when `message` may go; it is not empty.
    virtual void send(int to, ByteView message) = 0;
    struct Message {
        int from = 0;
        Bytes bytes;
    };
    /// The next message to this process; no value: none has arrived.
    [[nodiscard]] virtual std::optional<Message> receive() = 0;
};

/// Whether a launcher (mpirun, srun) started this process as one of several.
[[nodiscard]] bool isOneOfSeveral();

/// Meets the others; called once, by the main thread. Whoever destroys what it returns waits for all others to do so,
/// unless an exception is under way. Throws Error(unsupported) in a build without MPI.
[[nodiscard]] std::unique_ptr<Ranks> joinRanks();

/// Ends this process and all others that it met, if it met any and has not parted from them: for a program that fails.
void endAllRanks(ExitCode code);

}  // namespace terray
