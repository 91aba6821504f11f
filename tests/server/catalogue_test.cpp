// Which datasets are served, and what becomes of them at a reload.
#include "server/catalogue.h"

#include <cstring>
#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"
#include "tests/server/small_dataset.h"

namespace terray::server {
namespace {

/// The message of the Error that parsing these words throws, with its exit code in front.
std::string complaint(const std::vector<std::string>& words) {
    try {
        (void)parseSpecs(words);
    } catch (const Error& error) {
        return std::to_string(static_cast<int>(error.code())) + " " + error.what();
    }
    return "";
}

TEST(ParseSpecs, ReadsNamesAndDirectories) {
    EXPECT_EQ((std::vector<DatasetSpec>{{"alps", "/data/alps"}, {"a.b-c_9", "x=y"}}),
              parseSpecs({"alps=/data/alps", "a.b-c_9=x=y"}));
}

TEST(ParseSpecs, ReadsListsOfThem) {
    const test::TemporaryDirectory directory;
    std::ofstream(directory / "list") << "# ours\n\none=/1\r\ntwo=/2  \n";
    const std::string list = "@" + (directory / "list").string();
    EXPECT_EQ((std::vector<DatasetSpec>{{"one", "/1"}, {"two", "/2"}, {"three", "/3"}}),
              parseSpecs({list, "three=/3"}));
    EXPECT_EQ("2 two datasets are named \"one\"; give one of them another name", complaint({list, "one=/4"}));
    EXPECT_TRUE(complaint({"@" + (directory / "none").string()}).starts_with("3 cannot read the list of datasets"));
}

TEST(ParseSpecs, RefusesNamesThatWouldBeNoAddress) {
    for (const char* word : {"alps", "alps=", "=dir", ".=dir", "..=dir", ".hidden=dir", "a/b=dir", "a b=dir",
                             "health=dir", "metrics=dir", "-a=dir", "\xc3\xa4=dir"})
        EXPECT_TRUE(complaint({word}).starts_with("2 ")) << word;
    EXPECT_TRUE(complaint({std::string(65, 'a') + "=dir"}).starts_with("2 "));
}

TEST(OpenCatalogue, SaysWhichDatasetCannotBeServedAndWhy) {
    const test::TemporaryDirectory directory;
    std::filesystem::create_directory(directory / "empty");
    try {
        (void)openCatalogue({{"void", directory / "empty"}});
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(ExitCode::dataset, error.code());
        EXPECT_TRUE(std::string(error.what()).starts_with("cannot serve \"void\" from ")) << error.what();
    }
}

TEST(OpenCatalogue, RefusesADatasetWhoseImageryIsMissingOrAnothers) {
    const test::TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    std::filesystem::remove(directory / "a" / "imagery.pmtiles");
    EXPECT_FALSE(openServedDataset("a", directory / "a").ok());
    std::filesystem::copy_file(directory / "a" / "heights.pmtiles", directory / "a" / "imagery.pmtiles");
    const auto opened = openServedDataset("a", directory / "a");
    ASSERT_FALSE(opened.ok());
    EXPECT_NE(std::string::npos, opened.failure().message.find("ends at level 2, its metadata says 3"));
}

TEST(ServedDataset, HasAVersionThatChangesWithItsArchives) {
    const test::TemporaryDirectory directory;
    writeSmallDataset(directory / "a");
    const auto first = openServedDataset("a", directory / "a").value();
    EXPECT_EQ(first->version, openServedDataset("b", directory / "a").value()->version);
    writeSmallDataset(directory / "a", true, 2);  // other bytes in tiles of the same sizes
    const auto second = openServedDataset("a", directory / "a").value();
    EXPECT_NE(first->version, second->version);
    const auto range = first->heights->reader().locate({0, 0, 0}).value().value();
    const auto bytes = first->heights->reader().source().read(range.offset, range.length).value();
    const std::string tile = smallTile("heights", {0, 0, 0}, 1);
    EXPECT_EQ(0, std::memcmp(bytes.data(), tile.data(), tile.size())) << "the first goes on giving its own bytes";
}

TEST(ReloadCatalogue, TakesWhatChangedAndKeepsWhatDidNotOrCannotBeOpened) {
    const test::TemporaryDirectory directory;
    for (const char* name : {"same", "changed", "damaged", "removed"}) writeSmallDataset(directory / name);
    const auto specs = [&](const std::vector<std::string>& names) {
        std::vector<DatasetSpec> list;
        for (const std::string& name : names) list.push_back({name, directory / name});
        return list;
    };
    const auto before = openCatalogue(specs({"same", "changed", "damaged", "removed"}));
    writeSmallDataset(directory / "changed", true, 2);
    writeSmallDataset(directory / "added");
    std::filesystem::resize_file(directory / "damaged" / "heights.pmtiles", 100);
    std::vector<std::string> complaints;
    const auto after = reloadCatalogue(specs({"same", "changed", "damaged", "added", "missing"}), *before,
                                       [&](const std::string& text) { complaints.push_back(text); });
    EXPECT_EQ(before->find("same"), after->find("same"));
    EXPECT_NE(before->find("changed")->version, after->find("changed")->version);
    EXPECT_EQ(before->find("damaged"), after->find("damaged"));
    EXPECT_NE(nullptr, after->find("added"));
    EXPECT_EQ(nullptr, after->find("removed"));
    EXPECT_EQ(nullptr, after->find("missing"));
    ASSERT_EQ(2, complaints.size());
    EXPECT_NE(std::string::npos, complaints[0].find("what was there before is served on"));
    EXPECT_NE(std::string::npos, complaints[1].find("it is left out"));
}

}  // namespace
}  // namespace terray::server
