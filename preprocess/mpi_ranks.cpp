// The door to MPI. Plain point-to-point messages alone, so that any MPI of this century does.

#include <array>
#include <exception>

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>

#include "common/check.h"
#include "preprocess/ranks.h"

namespace terray {
namespace {

constexpr int kTag = 0;

class MpiRanks final : public Ranks {
  public:
    MpiRanks() {
        int granted = MPI_THREAD_SINGLE;
        // The threads of a process take turns. A failed call ends all processes: the default of MPI.
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &granted);
        if (granted < MPI_THREAD_SERIALIZED)
            throw Error(ExitCode::unsupported,
                        "this MPI does not let threads take turns (MPI_THREAD_SERIALIZED); "
                        "Open MPI and MPICH do");
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &count_);
        MPI_Comm here = MPI_COMM_NULL;
        MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &here);
        MPI_Comm_size(here, &onThisMachine_);
        MPI_Comm_free(&here);
    }
    ~MpiRanks() override {
        // While one fails the others may never come to part: endAllRanks() sees to them.
        if (std::uncaught_exceptions() == 0) MPI_Finalize();
    }
    MpiRanks(const MpiRanks&) = delete;
    MpiRanks& operator=(const MpiRanks&) = delete;

    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int count() const override { return count_; }
    [[nodiscard]] int onThisMachine() const override { return onThisMachine_; }
    [[nodiscard]] std::string name() const override {
        std::array<char, MPI_MAX_PROCESSOR_NAME> machine{};
        int length = 0;
        MPI_Get_processor_name(machine.data(), &length);
        return "process " + std::to_string(rank_) + " on " + std::string(machine.data(), static_cast<size_t>(length));
    }

    void send(int to, ByteView message) override {
        TERRAY_CHECK_OP(message.size(), >, 0u);
        MPI_Send(message.data(), static_cast<int>(message.size()), MPI_BYTE, to, kTag, MPI_COMM_WORLD);
    }

    [[nodiscard]] std::optional<Message> receive() override {
        int isThere = 0;
        MPI_Status status;
        MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &isThere, &status);
        if (isThere == 0) return {};
        int bytes = 0;
        MPI_Get_count(&status, MPI_BYTE, &bytes);
        Message message{status.MPI_SOURCE, Bytes(static_cast<size_t>(bytes))};
        MPI_Recv(message.bytes.data(), bytes, MPI_BYTE, status.MPI_SOURCE, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        return message;
    }

  private:
    int rank_ = 0;
    int count_ = 1;
    int onThisMachine_ = 1;
};

}  // namespace

std::unique_ptr<Ranks> joinRanks() {
    return std::make_unique<MpiRanks>();
}

void endAllRanks(ExitCode code) {
    int began = 0;
    int ended = 0;
    MPI_Initialized(&began);
    MPI_Finalized(&ended);
    if (began != 0 && ended == 0) MPI_Abort(MPI_COMM_WORLD, static_cast<int>(code));
}

}  // namespace terray
