// The inputs that fuzzing started from and found, with every compiler and sanitizer.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/server/answer_bytes.h"
#include "tests/server/small_dataset.h"

namespace terray::server {
namespace {

TEST(FuzzCorpus, IsAnsweredWithoutFault) {
    std::set<int> statuses;
    for (const auto& entry : std::filesystem::directory_iterator(TERRAY_FUZZ_CORPUS))
        for (const int status : answerBytes(readText(entry.path()))) statuses.insert(status);
    const std::set<int> expected = {200, 204, 206, 304, 400, 404, 405, 412, 413, 414, 416, 431, 501, 505};
    EXPECT_TRUE(std::includes(statuses.begin(), statuses.end(), expected.begin(), expected.end()))
        << "the corpus reaches each of these";
}

TEST(FuzzCorpus, CutShortAnywhereIsAnsweredWithoutFault) {
    for (const auto& entry : std::filesystem::directory_iterator(TERRAY_FUZZ_CORPUS)) {
        const std::string bytes = readText(entry.path());
        for (size_t size = 0; size < std::min<size_t>(bytes.size(), 400); ++size) answerBytes({bytes.data(), size});
    }
}

}  // namespace
}  // namespace terray::server
