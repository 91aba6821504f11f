#include "preprocess/block_team.h"

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "common/error.h"
#include "common/parallel.h"

namespace terray {
namespace {

/// The first word of a request to the leader, who answers each but the last once.
enum class Request : uint32_t {
    orders,   ///< answer: TeamOrders
    open,     ///< a stage; answer: uint64 blocks left
    take,     ///< answer: uint64 number of a block, or empty when none is left
    keep,     ///< uint64 number, record; answer: empty
    reserve,  ///< uint64 bytes; answer: uint64 offset
    close,    ///< the stage, all of whose blocks are given out; answer, once it is over: empty
    meet,     ///< answer, once all have asked: empty
    part,     ///< int64 nanoseconds of each BuildStep; answer, once all have asked: empty
    failed    ///< uint8 exit code, text
};

/// How long to leave the processor alone when nothing has arrived. Blocks take some 100 ms each.
constexpr auto kBriefly = std::chrono::microseconds(200);
/// While others do work of minutes.
constexpr auto kLonger = std::chrono::milliseconds(5);
/// Units of the spill that a process takes at a time.
constexpr uint64_t kShareUnits = 8;

uint64_t wholeUnits(uint64_t bytes) {
    return (bytes + SpillShare::kUnit - 1) / SpillShare::kUnit * SpillShare::kUnit;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wstringop-overflow"  // GCC 12: false alarm at the first growth of an array
/// A message that begins with a word.
ByteWriter messageOf(uint32_t word) {
    ByteWriter out;
    out.write(word);
    return out;
}
#pragma GCC diagnostic pop

/// Answers begin with a word that says nothing, since no message is empty.
ByteWriter answerOf() {
    return messageOf(0);
}

ByteWriter requestOf(Request kind) {
    return messageOf(static_cast<uint32_t>(kind));
}

void writeText(ByteWriter& out, std::string_view text) {
    out.write(static_cast<uint32_t>(text.size()));
    out.writeText(text);
}

ByteView readText(ByteReader& in) {
    return in.take(in.read<uint32_t>());
}

std::string toString(ByteView text) {
    return {reinterpret_cast<const char*>(text.data()), text.size()};
}

[[noreturn]] void failUnread() {
    throw Error(ExitCode::internal,
                "the processes of this build do not understand each other; start all of them from "
                "the same terray-preprocess");
}

/// What is left to give out of a stage.
class Handout {
  public:
    explicit Handout(const std::vector<size_t>& blocks) : blocks_(blocks) {}

    std::optional<size_t> next() {
        const std::scoped_lock lock(mutex_);
        return next_ < blocks_.size() ? std::optional(blocks_[next_++]) : std::nullopt;
    }
    void close() {
        const std::scoped_lock lock(mutex_);
        next_ = blocks_.size();
    }

  private:
    const std::vector<size_t>& blocks_;
    std::mutex mutex_;
    size_t next_ = 0;
};

/// What the leader replies to a request; no value: nothing yet.
using Answer = std::function<std::optional<ByteWriter>(Request kind, ByteReader& in)>;

/// The answer that expects requests of one kind alone, which wait.
Answer nothingBut(Request expected) {
    return [expected](Request kind, ByteReader&) -> std::optional<ByteWriter> {
        if (kind != expected) failUnread();
        return {};
    };
}

/// The leader's answers during a stage.
std::optional<ByteWriter> answerInStage(Request kind, ByteReader& in, const TeamStage& stage, Handout& handout) {
    ByteWriter out = answerOf();
    switch (kind) {
        case Request::open:
            out.write(static_cast<uint64_t>(stage.blocks.size()));
            return out;
        case Request::take:
            if (const std::optional<size_t> block = handout.next()) out.write(static_cast<uint64_t>(*block));
            return out;
        case Request::keep: {
            const auto block = in.read<uint64_t>();
            const auto record = decodeBlockRecord(in.take(in.remaining()));
            if (!record.ok()) failUnread();
            stage.keep(block, *record, false);
            return out;
        }
        case Request::reserve:
            out.write(stage.spillEnd.fetch_add(in.read<uint64_t>()));
            return out;
        case Request::close:
            return {};
        default:
            failUnread();
    }
}

/// Answers the others while the leader itself builds, or waits.
class Service {
  public:
    explicit Service(Ranks& ranks) : ranks_(ranks) {}

    /// Answers until each of the others has asked for `last`, which is left to answerAll(). Throws what one of them
    /// failed of, and Error(interrupted) once `isOver`.
    void runUntil(Request last, const std::function<bool()>& isOver, const Answer& answer) {
        for (int asked = 0; asked < ranks_.count() - 1;) {
            if (isOver()) throw Error(ExitCode::interrupted, "interrupted");
            const std::optional<Ranks::Message> message = ranks_.receive();
            if (!message) {
                std::this_thread::sleep_for(kBriefly);
                continue;
            }
            ByteReader in(message->bytes);
            const auto kind = static_cast<Request>(in.read<uint32_t>());
            if (kind == Request::failed) failOf(in);
            if (kind == last) ++asked;
            if (const std::optional<ByteWriter> reply = answer(kind, in)) ranks_.send(message->from, reply->bytes());
        }
    }
    void answerAll(const ByteWriter& reply) {
        for (int rank = 1; rank < ranks_.count(); ++rank) ranks_.send(rank, reply.bytes());
    }

  private:
    [[noreturn]] static void failOf(ByteReader& in) {
        const auto code = static_cast<ExitCode>(in.read<uint8_t>());
        throw Error(code, toString(readText(in)));
    }

    Ranks& ranks_;
};

}  // namespace

uint64_t SpillShare::take(uint64_t bytes, const std::function<uint64_t(uint64_t)>& more) {
    if (bytes > left_) {
        const uint64_t share = std::max(wholeUnits(bytes), kShareUnits * kUnit);
        place_ = more(share);
        left_ = share;
    }
    left_ -= bytes;
    return std::exchange(place_, place_ + bytes);
}

void TeamLeader::begin(const TeamOrders& orders, const std::atomic<bool>& stop) {
    if (ranks_ == nullptr) return;
    Service service(*ranks_);
    service.runUntil(
        Request::orders, [&] { return stop.load(); }, nothingBut(Request::orders));
    ByteWriter out = answerOf();
    out.write(static_cast<uint8_t>(orders.isWhole));
    writeText(out, toString(orders.heading));
    writeText(out, orders.workDirectory.native());
    writeText(out, orders.journal.native());
    service.answerAll(out);
}

void TeamLeader::runStage(const TeamStage& stage) {
    spillEnd_ = &stage.spillEnd;
    share_.forget();
    if (ranks_ != nullptr) stage.spillEnd = wholeUnits(stage.spillEnd);
    if (stage.begin && !stage.blocks.empty()) stage.begin();
    Handout handout(stage.blocks);
    std::exception_ptr elsewhere;
    {
        std::atomic<bool> failedHere = false;
        std::jthread service;
        if (ranks_ != nullptr)
            service = std::jthread([&] {
                try {
                    Service(*ranks_).runUntil(
                        Request::close, [&] { return failedHere || stage.stop; },
                        [&](Request kind, ByteReader& in) { return answerInStage(kind, in, stage, handout); });
                } catch (...) {
                    elsewhere = std::current_exception();
                    handout.close();
                }
            });
        try {
            forEachParallel([&] { return handout.next(); }, stage.jobs, stage.stop,
                            [&](int worker, size_t block) { stage.keep(block, stage.build(block, worker), true); });
        } catch (...) {
            failedHere = true;
            throw;
        }
    }
    if (elsewhere) std::rethrow_exception(elsewhere);
    if (stage.end) stage.end();
    if (ranks_ != nullptr) Service(*ranks_).answerAll(answerOf());
}

void TeamLeader::meet(const std::atomic<bool>& stop) {
    if (ranks_ == nullptr) return;
    Service service(*ranks_);
    service.runUntil(
        Request::meet, [&] { return stop.load(); }, nothingBut(Request::meet));
    service.answerAll(answerOf());
}

void TeamLeader::part(BuildTimes& times, const std::atomic<bool>& stop) {
    if (ranks_ == nullptr) return;
    Service service(*ranks_);
    service.runUntil(
        Request::part, [&] { return stop.load(); },
        [&](Request kind, ByteReader& in) -> std::optional<ByteWriter> {
            if (kind != Request::part) failUnread();
            for (size_t step = 0; step < kBuildStepNames.size(); ++step)
                times.add(static_cast<BuildStep>(step), std::chrono::nanoseconds(in.read<int64_t>()));
            return {};
        });
    service.answerAll(answerOf());
}

uint64_t TeamLeader::reserve(uint64_t bytes) {
    if (ranks_ == nullptr) return spillEnd_->fetch_add(bytes);
    const std::scoped_lock lock(mutex_);
    return share_.take(bytes, [&](uint64_t share) { return spillEnd_->fetch_add(share); });
}

TeamOrders TeamMember::begin(const std::atomic<bool>& stop) {
    const Bytes answer = askAlone(requestOf(Request::orders).bytes(), stop);
    ByteReader in(answer);
    in.read<uint32_t>();
    TeamOrders orders;
    orders.isWhole = in.read<uint8_t>() != 0;
    const ByteView heading = readText(in);
    orders.heading.assign(heading.begin(), heading.end());
    orders.workDirectory = toString(readText(in));
    orders.journal = toString(readText(in));
    if (!in.ok()) failUnread();
    return orders;
}

void TeamMember::runStage(const TeamStage& stage) {
    stop_ = &stage.stop;
    share_.forget();
    const Bytes opened = askAlone(requestOf(Request::open).bytes(), stage.stop);
    ByteReader in(opened);
    in.read<uint32_t>();
    const auto left = in.read<uint64_t>();
    if (stage.begin && left > 0) stage.begin();
    const auto next = [&]() -> std::optional<size_t> {
        const Bytes given = askAlone(requestOf(Request::take).bytes(), stage.stop);
        ByteReader block(given);
        block.read<uint32_t>();
        if (block.remaining() == 0) return {};
        return block.read<uint64_t>();
    };
    forEachParallel(next, stage.jobs, stage.stop, [&](int worker, size_t block) {
        const BlockRecord record = stage.build(block, worker);
        stage.sync(record);
        ByteWriter keep = requestOf(Request::keep);
        keep.write(static_cast<uint64_t>(block));
        keep.writeBytes(encodeBlockRecord(record));
        (void)askAlone(keep.bytes(), stage.stop);
    });
    (void)askAlone(requestOf(Request::close).bytes(), stage.stop);
}

void TeamMember::meet(const std::atomic<bool>& stop) {
    (void)askAlone(requestOf(Request::meet).bytes(), stop);
}

uint64_t TeamMember::reserve(uint64_t bytes) {
    const std::scoped_lock lock(mutex_);
    return share_.take(bytes, [&](uint64_t share) {
        ByteWriter request = requestOf(Request::reserve);
        request.write(share);
        const Bytes answer = ask(request.bytes(), *stop_);
        ByteReader in(answer);
        in.read<uint32_t>();
        return in.read<uint64_t>();
    });
}

void TeamMember::part(const BuildTimes& times, const std::atomic<bool>& stop) {
    ByteWriter request = requestOf(Request::part);
    for (size_t step = 0; step < kBuildStepNames.size(); ++step)
        request.write(static_cast<int64_t>(times.seconds(static_cast<BuildStep>(step)) * 1e9));
    (void)askAlone(request.bytes(), stop);
}

void TeamMember::giveUp(Ranks& ranks, const std::exception& reason, std::chrono::seconds patience) {
    const auto* const error = dynamic_cast<const Error*>(&reason);
    ByteWriter out = requestOf(Request::failed);
    out.write(static_cast<uint8_t>(error != nullptr ? error->code() : ExitCode::internal));
    writeText(out, ranks.name() + ": " + reason.what());
    ranks.send(0, out.bytes());
    std::this_thread::sleep_for(patience);
}

Bytes TeamMember::askAlone(ByteView request, const std::atomic<bool>& stop) {
    const std::scoped_lock lock(mutex_);
    return ask(request, stop);
}

Bytes TeamMember::ask(ByteView request, const std::atomic<bool>& stop) {
    ranks_.send(0, request);
    const auto start = std::chrono::steady_clock::now();
    while (true) {
        if (std::optional<Ranks::Message> answer = ranks_.receive()) return std::move(answer->bytes);
        throwIfStopped(stop);
        std::this_thread::sleep_for(std::chrono::steady_clock::now() - start < kLonger ? kBriefly : kLonger);
    }
}

}  // namespace terray
