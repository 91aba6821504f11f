#include "common/command_line.h"

#include <gtest/gtest.h>

#include "common/error.h"

namespace terray {
namespace {

using Arguments = std::vector<std::string>;

/// A program with one option of each kind.
struct Sample {
    Sample() {
        line.positional("INPUT", input, "what to read");
        line.positionals("MORE", more, "further inputs");
        line.flag("--force", force, "overwrite");
        line.option("--out", out, "DIR", "where to write").required();
        line.option("--scale", scale, "S", "factor").given(scaleGiven);
        line.option("--jobs", jobs, "N", "threads");
        line.option("--nodata", nodata, "V", "value of holes");
        line.list("--imagery", imagery, "FILE", "photos");
        line.bytes("--memory", memory, "memory to use");
        line.size("--size", width, height, "size of the picture");
    }
    /// What parse() says, "" when it says nothing.
    std::string complaint(const Arguments& arguments) {
        try {
            EXPECT_TRUE(line.parse(arguments));
            return "";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::usage);
            return error.what();
        }
    }

    CommandLine line{"tool build", "Builds."};
    std::string input, out;
    Arguments more, imagery;
    bool force = false, scaleGiven = false;
    double scale = 1;
    int64_t jobs = 0;
    std::optional<double> nodata;
    uint64_t memory = 0;
    int width = 0, height = 0;
};

TEST(CommandLine, TakesValuesInBothForms) {
    Sample s;
    EXPECT_EQ(s.complaint({"--out", "a", "--scale=0.5", "--jobs", "-3", "--nodata=-9999", "--memory", "512M",
                           "--size=640x480", "--force", "in"}),
              "");
    EXPECT_EQ(s.out, "a");
    EXPECT_EQ(s.scale, 0.5);
    EXPECT_TRUE(s.scaleGiven);
    EXPECT_EQ(s.jobs, -3);
    EXPECT_EQ(s.nodata, -9999);
    EXPECT_EQ(s.memory, uint64_t{512} << 20);
    EXPECT_EQ(s.width, 640);
    EXPECT_EQ(s.height, 480);
    EXPECT_TRUE(s.force);
    EXPECT_EQ(s.input, "in");
}

TEST(CommandLine, LeavesDefaultsAlone) {
    Sample s;
    EXPECT_EQ(s.complaint({"--out=x"}), "");
    EXPECT_EQ(s.scale, 1);
    EXPECT_FALSE(s.scaleGiven);
    EXPECT_FALSE(s.nodata);
    EXPECT_FALSE(s.force);
}

TEST(CommandLine, LetsOptionsStandAnywhere) {
    Sample s;
    EXPECT_EQ(s.complaint({"first", "--force", "second", "third", "--out", "o"}), "");
    EXPECT_EQ(s.input, "first");
    EXPECT_EQ(s.more, (Arguments{"second", "third"}));
}

TEST(CommandLine, TakesListsUpToTheNextOption) {
    Sample s;
    EXPECT_EQ(s.complaint({"in", "--imagery", "a", "b", "--out", "o", "more", "--imagery=c"}), "");
    EXPECT_EQ(s.imagery, (Arguments{"a", "b", "c"}));
    EXPECT_EQ(s.more, (Arguments{"more"}));
}

TEST(CommandLine, EndsOptionsAtTwoDashes) {
    Sample s;
    EXPECT_EQ(s.complaint({"--out", "o", "--imagery", "a", "--", "--force", "-x", "--help"}), "");
    EXPECT_FALSE(s.force);
    EXPECT_EQ(s.input, "--force");
    EXPECT_EQ(s.more, (Arguments{"-x", "--help"}));
    EXPECT_EQ(s.imagery, (Arguments{"a"}));
}

TEST(CommandLine, TakesNegativeNumbersAndASingleDashAsValues) {
    Sample s;
    EXPECT_EQ(s.complaint({"--out", "-105.4,37,4000", "--nodata", "-.5", "-"}), "");
    EXPECT_EQ(s.out, "-105.4,37,4000");
    EXPECT_EQ(s.nodata, -0.5);
    EXPECT_EQ(s.input, "-");
}

TEST(CommandLine, NamesTheNearestOption) {
    EXPECT_EQ(Sample().complaint({"--ot", "x"}), "unknown option --ot, did you mean --out?");
    EXPECT_EQ(Sample().complaint({"--sclae=2"}), "unknown option --sclae, did you mean --scale?");
    EXPECT_EQ(Sample().complaint({"--entirely-different"}),
              "unknown option --entirely-different (--help lists the options)");
    EXPECT_NE(Sample().complaint({"-o", "x"}), "");
}

TEST(CommandLine, RefusesWhatIsMissingRepeatedOrTooMuch) {
    EXPECT_EQ(Sample().complaint({"in"}), "--out DIR is missing (where to write)");
    EXPECT_EQ(Sample().complaint({"--out", "a", "--out", "b"}), "--out is given twice");
    EXPECT_EQ(Sample().complaint({"--force", "--force"}), "--force is given twice");
    EXPECT_EQ(Sample().complaint({"--out"}), "--out needs a value: --out DIR");
    EXPECT_EQ(Sample().complaint({"--out", "--force"}), "--out needs a value: --out DIR");
    EXPECT_EQ(Sample().complaint({"--imagery", "--out", "o"}), "--imagery needs a value: --imagery FILE");
    EXPECT_EQ(Sample().complaint({"--force=yes"}), "--force takes no value");

    CommandLine bare("tool", "Does nothing.");
    EXPECT_THROW((void)bare.parse({"stray"}), Error);
    EXPECT_TRUE(bare.parse({}));
}

TEST(CommandLine, RefusesBadlyFormedValues) {
    for (const char* argument : {"--scale=",       "--scale=two",      "--scale=1x",
                                 "--scale=nan",    "--scale=inf",      "--scale=1e999",
                                 "--jobs=1.5",     "--jobs=",          "--jobs=99999999999999999999",
                                 "--nodata=none",  "--memory=",        "--memory=M",
                                 "--memory=-1",    "--memory=1X",      "--memory=9999999999T",
                                 "--size=640",     "--size=640x",      "--size=x480",
                                 "--size=0x480",   "--size=640x65537", "--size=640x480x2",
                                 "--size=-640x480"})
        EXPECT_NE(Sample().complaint({argument, "--out=o"}), "") << argument;
    EXPECT_EQ(Sample().complaint({"--jobs=many"}), "--jobs: \"many\" is not a whole number");
}

TEST(CommandLine, ReadsByteSuffixes) {
    const std::pair<const char*, uint64_t> cases[] = {
        {"0", 0}, {"17", 17}, {"2K", 2048}, {"1.5M", 1572864}, {"3G", uint64_t{3} << 30}, {"1T", uint64_t{1} << 40}};
    for (const auto& [text, expected] : cases) {
        Sample s;
        EXPECT_EQ(s.complaint({"--out=o", "--memory", text}), "");
        EXPECT_EQ(s.memory, expected) << text;
    }
}

TEST(CommandLine, HelpNamesEveryOptionAndOutranksMistakes) {
    Sample s;
    const std::string help = s.line.help();
    for (const char* part : {"Usage: tool build", "INPUT", "MORE...", "--force", "--out DIR", "(required)",
                             "--memory BYTES", "--size WxH", "--imagery FILE...", "--help", "Builds."})
        EXPECT_NE(help.find(part), std::string::npos) << part;

    testing::internal::CaptureStdout();
    EXPECT_FALSE(s.line.parse({"--unknown", "--help"}));
    EXPECT_EQ(testing::internal::GetCapturedStdout(), help);
    EXPECT_TRUE(s.input.empty());
}

}  // namespace
}  // namespace terray
