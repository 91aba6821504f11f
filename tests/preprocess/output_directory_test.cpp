#include "preprocess/output_directory.h"

#include <fstream>

#include <gtest/gtest.h>

#include "common/dataset_metadata.h"
#include "common/error.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

void writeText(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path) << text;
}

std::string readText(const std::filesystem::path& path) {
    const Bytes bytes = readFile(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A directory that looks like a dataset, told apart by `mark`.
void makeDataset(const std::filesystem::path& path, const std::string& mark) {
    std::filesystem::create_directory(path);
    writeText(path / kHeightsFile, "PMTiles" + mark);
}

std::string refusal(const std::filesystem::path& out, bool replace) {
    try {
        const OutputDirectory output(out, {.replace = replace});
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::output) << error.what();
        return error.what();
    }
    return "";
}

using Names = std::vector<std::string>;

TEST(OutputDirectory, AppearsWholeOrNotAtAll) {
    const TemporaryDirectory parent;
    {
        OutputDirectory output(parent / "out/", {.replace = false});  // a trailing slash is no other name
        writeText(output.directory() / kHeightsFile, "PMTiles");
        writeText(output.workDirectory() / "temporary", "x");
        EXPECT_EQ(parent.names(), Names{"out.partial"});
        output.commit();
        EXPECT_EQ(parent.names(), Names{"out"});
    }
    EXPECT_EQ(parent.names(), Names{"out"});
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(parent / "out"), {}), 1);
    {
        const OutputDirectory output(parent / "other", {.replace = false});
        writeText(output.directory() / kHeightsFile, "PMTiles");
    }
    EXPECT_EQ(parent.names(), Names{"out"});
}

TEST(OutputDirectory, ReplacesADatasetOnlyWhenAskedTo) {
    const TemporaryDirectory parent;
    makeDataset(parent / "out", "old");
    EXPECT_NE(refusal(parent / "out", false).find("--force"), std::string::npos);
    {
        OutputDirectory output(parent / "out", {.replace = true});
        writeText(output.directory() / kHeightsFile, "PMTilesnew");
        EXPECT_EQ(readText(parent / "out" / kHeightsFile), "PMTilesold");
        output.commit();
    }
    EXPECT_EQ(readText(parent / "out" / kHeightsFile), "PMTilesnew");
    EXPECT_EQ(parent.names(), Names{"out"});
}

TEST(OutputDirectory, KeepsTheOldDatasetWhenTheNewOneFails) {
    const TemporaryDirectory parent;
    makeDataset(parent / "out", "old");
    { const OutputDirectory output(parent / "out", {.replace = true}); }
    EXPECT_EQ(readText(parent / "out" / kHeightsFile), "PMTilesold");
    EXPECT_EQ(parent.names(), Names{"out"});
}

TEST(OutputDirectory, NeverDeletesWhatIsNoDataset) {
    const TemporaryDirectory parent;
    std::filesystem::create_directory(parent / "photos");
    writeText(parent / "photos" / "holiday.jpg", "x");
    EXPECT_NE(refusal(parent / "photos", true).find("holiday.jpg"), std::string::npos);
    makeDataset(parent / "mixed", "");
    writeText(parent / "mixed" / "notes.txt", "x");
    EXPECT_NE(refusal(parent / "mixed", true).find("notes.txt"), std::string::npos);
    std::filesystem::create_directory(parent / "other");
    writeText(parent / "other" / kHeightsFile, "something else");
    EXPECT_NE(refusal(parent / "other", true), "");
    writeText(parent / "file", "x");
    EXPECT_NE(refusal(parent / "file", true), "");
    std::filesystem::create_directory_symlink(parent / "mixed", parent / "link");
    EXPECT_NE(refusal(parent / "link", true), "");
    EXPECT_EQ(parent.names(), (Names{"file", "link", "mixed", "other", "photos"}));
}

TEST(OutputDirectory, AnEmptyDirectoryMayBeReplaced) {
    const TemporaryDirectory parent;
    std::filesystem::create_directory(parent / "out");
    EXPECT_NE(refusal(parent / "out", false), "");
    OutputDirectory output(parent / "out", {.replace = true});
    writeText(output.directory() / kHeightsFile, "PMTiles");
    output.commit();
    EXPECT_EQ(parent.names(), Names{"out"});
}

TEST(OutputDirectory, RefusesAParentThatIsNoDirectory) {
    const TemporaryDirectory parent;
    writeText(parent / "file", "x");
    EXPECT_NE(refusal(parent / "file" / "out", false).find("is not a directory"), std::string::npos);
    EXPECT_NE(refusal(parent / "missing" / "out", false).find("is not a directory"), std::string::npos);
}

TEST(OutputDirectory, TwoRunsDoNotShareOne) {
    const TemporaryDirectory parent;
    const OutputDirectory first(parent / "out", {.replace = false});
    EXPECT_NE(refusal(parent / "out", false).find("another terray-preprocess"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(first.workDirectory()));
}

TEST(OutputDirectory, ClearsAwayWhatAKilledRunLeft) {
    const TemporaryDirectory parent;
    std::filesystem::create_directories(parent / "out.partial" / "work");
    writeText(parent / "out.partial" / "lock", "");
    writeText(parent / "out.partial" / "work" / "height-tiles", "x");
    {
        OutputDirectory output(parent / "out", {.replace = false});
        EXPECT_TRUE(std::filesystem::is_empty(output.workDirectory()));
        writeText(output.directory() / kHeightsFile, "PMTiles");
        output.commit();
    }
    EXPECT_EQ(parent.names(), Names{"out"});
    // But a directory of that name that no run made is somebody's.
    std::filesystem::create_directory(parent / "b.partial");
    writeText(parent / "b.partial" / "notes.txt", "x");
    EXPECT_NE(refusal(parent / "b", false).find("in the way"), std::string::npos);
}

}  // namespace
}  // namespace terray
