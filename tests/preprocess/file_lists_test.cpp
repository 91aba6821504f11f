#include "preprocess/file_lists.h"

#include <fstream>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

using Names = std::vector<std::string>;

class FileLists : public testing::Test {
  protected:
    /// Writes a list. @return how a user names it
    std::string list(const std::string& name, const std::string& text) const {
        std::ofstream(directory_ / name, std::ios::binary) << text;
        return "@" + (directory_ / name).string();
    }
    static std::string refusal(const Names& names) {
        try {
            (void)withoutLists(names);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::input);
            return error.what();
        }
        return "";
    }
    TemporaryDirectory directory_;
};

TEST_F(FileLists, StandWhereTheirNamesStood) {
    const std::string names = list("a", "one.tif\r\n\n# said\nwith blanks.tif  \nthree.tif");
    EXPECT_EQ(withoutLists({"first.tif", names, "last.tif"}),
              (Names{"first.tif", "one.tif", "with blanks.tif", "three.tif", "last.tif"}));
    EXPECT_EQ(withoutLists({"a.tif"}), Names{"a.tif"});
    EXPECT_EQ(withoutLists({}), Names{});
}

TEST_F(FileLists, ThatCannotBeUsedAreRefused) {
    EXPECT_NE(refusal({"@" + (directory_ / "absent").string()}).find("absent\": there is no such file"),
              std::string::npos);
    EXPECT_NE(refusal({list("empty", "\n# nothing\n")}).find("is empty"), std::string::npos);
    EXPECT_NE(refusal({list("nested", "@other\n")}).find("names another list, \"@other\""), std::string::npos);
}

}  // namespace
}  // namespace terray
