// The inputs that fuzzing started from and found, and seeded changes of them, with every compiler and sanitizer.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/common/random.h"
#include "tests/common/temporary_directory.h"
#include "tests/fuzz/allocation_limit.h"
#include "tests/fuzz/targets.h"

namespace terray::fuzz {
namespace {

struct Target {
    const char* corpus;  ///< folder in corpus/
    bool (*read)(ByteView bytes);
    int changes;  ///< of each input
};
std::ostream& operator<<(std::ostream& out, const Target& target) {
    return out << target.corpus;
}

std::vector<Bytes> corpusOf(const Target& target) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(TERRAY_CORPUS) / target.corpus))
        paths.push_back(entry.path());
    std::ranges::sort(paths);
    std::vector<Bytes> inputs;
    for (const auto& path : paths) inputs.push_back(test::readFile(path));
    return inputs;
}

/// One to four bytes changed, some taken out or put in, or the end cut off.
Bytes changed(Bytes bytes, test::Random& random) {
    for (uint64_t count = 1 + random.below(4); count > 0 && !bytes.empty(); --count) {
        const auto place = bytes.begin() + static_cast<ptrdiff_t>(random.below(bytes.size()));
        const auto room = static_cast<uint64_t>(bytes.end() - place);
        switch (random.below(5)) {
            case 0:
                *place = static_cast<std::byte>(random.bits());
                break;
            case 1:
                *place ^= std::byte{1} << random.below(8);
                break;
            case 2:
                bytes.insert(place, 1 + random.below(8), static_cast<std::byte>(random.bits()));
                break;
            case 3:
                bytes.erase(place, place + static_cast<ptrdiff_t>(1 + random.below(std::min<uint64_t>(room, 8))));
                break;
            default:
                bytes.erase(place, bytes.end());
        }
    }
    return bytes;
}

class FuzzCorpus : public testing::TestWithParam<Target> {};

TEST_P(FuzzCorpus, IsReadWithoutFaultAndWithinItsLimits) {
    const auto inputs = corpusOf(GetParam());
    EXPECT_GE(std::ranges::count_if(inputs, [](const Bytes& bytes) { return GetParam().read(bytes); }), 2)
        << "some of it reaches the end of the reader";
}

TEST_P(FuzzCorpus, ChangedAtRandomIsReadWithoutFaultAndWithinItsLimits) {
    test::Random random(1);
    for (const Bytes& input : corpusOf(GetParam()))
        for (int i = 0; i < GetParam().changes; ++i) GetParam().read(changed(input, random));
}

INSTANTIATE_TEST_SUITE_P(Of, FuzzCorpus,
                         testing::Values(Target{"archive", readArchive, 500}, Target{"metadata", readMetadata, 2000},
                                         Target{"height_tile", readHeightTile, 30},
                                         Target{"imagery_tile", readImageryTile, 60}),
                         [](const auto& of) { return std::string(of.param.corpus); });

// The thread's planes once grew by doubling: room for three tiles where one has holes and the first had none.
TEST(HeightTileLimit, HoldsForATileWithHolesAfterOneWithout) {
    const std::filesystem::path corpus = std::filesystem::path(TERRAY_CORPUS) / "height_tile";
    std::thread([&] {
        EXPECT_TRUE(readHeightTile(test::readFile(corpus / "slope")));
        EXPECT_TRUE(readHeightTile(test::readFile(corpus / "holes")));
    }).join();
}

TEST(AllocationLimitDeathTest, StopsTheProgramWhereOneByteTooManyIsAskedFor) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    const auto allocate = [](size_t bytes) {
        return within(100000, [&] { return std::make_unique<std::byte[]>(bytes); });
    };
    EXPECT_NE(allocate(90000), nullptr);
    EXPECT_DEATH(static_cast<void>(allocate(100001)), "allocation beyond the limit");
}

TEST(AllocationLimit, CountsWhatIsHeldAtOneTime) {
    within(100000, [] {
        for (int i = 0; i < 100; ++i) EXPECT_EQ(Bytes(60000).size(), 60000U);
        return 0;
    });
}

}  // namespace
}  // namespace terray::fuzz
