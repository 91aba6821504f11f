#include "client/stream/disk_cache.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/stream/fake_dataset.h"

namespace terray::test {
namespace {

namespace fs = std::filesystem;

/// The range number n, 1000 to 4000 bytes that follow from n.
ByteRange rangeOf(uint64_t n) {
    return {n * 10000, 1000 + n % 7 * 500};
}
Bytes bytesOf(uint64_t n) {
    Random random(n);
    Bytes bytes(rangeOf(n).length);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random.next());
    return bytes;
}

std::vector<fs::path> filesOf(const fs::path& directory) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(directory))
        if (entry.is_regular_file() && entry.path().filename() != "lock") files.push_back(entry.path());
    return files;
}
uint64_t totalBytes(const fs::path& directory) {
    uint64_t total = 0;
    for (const fs::path& file : filesOf(directory)) total += fs::file_size(file);
    return total;
}

TEST(DiskCache, GivesBackWhatItWasGivenAlsoToLaterRuns) {
    const TemporaryDirectory folder;
    DiskCache first({.directory = folder / "cache"});
    EXPECT_FALSE(first.read("a", rangeOf(1)));
    for (uint64_t n = 0; n < 20; ++n) first.write("a", rangeOf(n), bytesOf(n));
    DiskCache second({.directory = folder / "cache"});
    for (uint64_t n = 0; n < 20; ++n) EXPECT_EQ(second.read("a", rangeOf(n)), bytesOf(n)) << n;
    EXPECT_FALSE(second.read("b", rangeOf(1))) << "another archive, or another version";
    EXPECT_FALSE(second.read("a", {10000, 999}));
    EXPECT_EQ(second.statistics().hits, 20u);
    first.write("a", rangeOf(3), Bytes(rangeOf(3).length));
    EXPECT_EQ(second.read("a", rangeOf(3)), Bytes(rangeOf(3).length)) << "replaced";
}

TEST(DiskCache, HoldsNothingThatIsDamaged) {
    const TemporaryDirectory folder;
    DiskCache cache({.directory = folder.path()});
    cache.write("a", rangeOf(1), bytesOf(1));
    ASSERT_EQ(filesOf(folder.path()).size(), 1u);
    const fs::path file = filesOf(folder.path())[0];
    const Bytes whole = readFile(file);
    const auto put = [&](const Bytes& bytes) {
        std::ofstream(file, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    };
    for (size_t length = 0; length < whole.size(); length += 7) {
        put(Bytes(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(length)));
        EXPECT_FALSE(cache.read("a", rangeOf(1))) << length;
    }
    for (size_t place = 0; place < whole.size(); place += 7) {
        Bytes damaged = whole;
        damaged[place] ^= std::byte{1};
        put(damaged);
        EXPECT_FALSE(cache.read("a", rangeOf(1))) << place;
    }
    Bytes longer = whole;
    longer.push_back({});
    put(longer);
    EXPECT_FALSE(cache.read("a", rangeOf(1)));
    put(whole);
    EXPECT_EQ(cache.read("a", rangeOf(1)), bytesOf(1));
}

TEST(DiskCache, LetsTheOldestGoAndLeavesForeignFilesAlone) {
    const TemporaryDirectory folder;
    std::ofstream(folder / "letter.txt") << std::string(100000, 'x');
    fs::create_directories(folder.path() / "0123456789abcdef");
    std::ofstream(folder.path() / "0123456789abcdef" / "letter.txt") << std::string(100000, 'x');
    DiskCache cache({.directory = folder.path(), .maxBytes = 100000});
    for (uint64_t n = 0; n < 30; ++n) cache.write("a", rangeOf(n), bytesOf(n));
    // All but 3 were used an hour ago.
    const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
    for (const fs::path& file : filesOf(folder.path())) fs::last_write_time(file, old);
    EXPECT_TRUE(cache.read("a", rangeOf(3)));
    for (uint64_t n = 100; n < 130; ++n) cache.write("a", rangeOf(n), bytesOf(n));
    EXPECT_LE(totalBytes(folder.path()) - 200000, 100000u);
    EXPECT_TRUE(cache.read("a", rangeOf(3))) << "it was used last";
    EXPECT_TRUE(cache.read("a", rangeOf(129)));
    EXPECT_FALSE(cache.read("a", rangeOf(0)));
    EXPECT_EQ(fs::file_size(folder / "letter.txt"), 100000u);
    EXPECT_EQ(fs::file_size(folder.path() / "0123456789abcdef" / "letter.txt"), 100000u);
}

TEST(DiskCache, GoesOnWhenItsDirectoryCannotBeWrittenAnyMore) {
    const TemporaryDirectory folder;
    DiskCache cache({.directory = folder / "cache"});
    cache.write("a", rangeOf(1), bytesOf(1));
    fs::remove_all(folder / "cache");
    std::ofstream(folder / "cache") << "a file in its place";
    EXPECT_FALSE(cache.read("a", rangeOf(1)));
    cache.write("a", rangeOf(1), bytesOf(1));
    EXPECT_EQ(cache.statistics().failures, 1u);
    try {
        const DiskCache impossible({.directory = folder.path() / "cache" / "below"});
        FAIL() << "a file is no directory";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output);
    }
}

/// What a process of its own does with a cache: writes and reads for ever; ends badly once a read gives other bytes.
[[noreturn]] void useForEver(const fs::path& directory, uint64_t seed) {
    DiskCache cache({.directory = directory, .maxBytes = 200000});
    Random random(seed);
    for (;;) {
        const uint64_t n = random.next() % 200;
        if (const auto held = cache.read("a", rangeOf(n)); held && *held != bytesOf(n)) ::_exit(1);
        if (random.chance(0.5)) cache.write("a", rangeOf(n), bytesOf(n));
    }
}

TEST(DiskCache, SurvivesSeveralProcessesThatAreKilled) {
    const TemporaryDirectory folder;
    for (uint64_t round = 0; round < 6; ++round) {
        std::vector<pid_t> processes;
        for (uint64_t n = 0; n < 3; ++n) {
            const pid_t process = ::fork();
            ASSERT_GE(process, 0);
            if (process == 0) useForEver(folder.path(), round * 10 + n);
            processes.push_back(process);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        for (const pid_t process : processes) {
            ::kill(process, SIGKILL);
            int status = 0;
            ::waitpid(process, &status, 0);
            EXPECT_TRUE(WIFSIGNALED(status)) << "a read gave other bytes than were written";
        }
        EXPECT_LE(totalBytes(folder.path()), 200000u + 3 * 200000 / 16 + 3 * 4008);
    }
    // Nothing stays locked, nothing wrong is held, and what the killed ones left half written goes in time.
    const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
    for (const fs::path& file : filesOf(folder.path())) fs::last_write_time(file, old);
    DiskCache cache({.directory = folder.path(), .maxBytes = 200000});
    size_t held = 0;
    for (uint64_t n = 0; n < 200; ++n) {
        const auto bytes = cache.read("a", rangeOf(n));
        held += bytes ? 1 : 0;
        EXPECT_EQ(bytes.value_or(bytesOf(n)), bytesOf(n));
    }
    EXPECT_GT(held, 0u);
    for (const fs::path& file : filesOf(folder.path())) EXPECT_NE(file.extension(), ".tmp") << file;
}

}  // namespace
}  // namespace terray::test
