// GPX and IGC files: good ones, and every kind of bad one with a sentence that says what is wrong.

#include "client/overlay/track.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "common/error.h"
#include "tests/common/temporary_directory.h"

namespace terray {
namespace {

const std::string kIgc =
    "AXXX001 a recorder\r\n"
    "HFDTE010124\r\n"
    "B1012304612345N00712345EA0123401256\r\n"
    "LXXX a comment\r\n"
    "B1012314612400S00712400WV-001200000extension\r\n"
    "B1012329000000N18000000EA9999999999\r\n"
    "GABCDEF\r\n";

TEST(Igc, YieldsPlacesAndHeightsOfItsFixes) {
    const auto track = parseIgc(kIgc);
    ASSERT_TRUE(track.ok()) << track.failure().message;
    ASSERT_EQ(track->lines.size(), 1u);
    const auto& points = track->lines[0];
    ASSERT_EQ(points.size(), 3u);
    EXPECT_DOUBLE_EQ(points[0].place.latitude, 46 + 12.345 / 60);
    EXPECT_DOUBLE_EQ(points[0].place.longitude, 7 + 12.345 / 60);
    EXPECT_EQ(points[0].height, 1256) << "of the satellites, the fix is valid";
    EXPECT_DOUBLE_EQ(points[1].place.latitude, -(46 + 12.4 / 60));
    EXPECT_DOUBLE_EQ(points[1].place.longitude, -(7 + 12.4 / 60));
    EXPECT_EQ(points[1].height, -12) << "of the barometer, the fix has no height";
    EXPECT_EQ(points[2].place.latitude, 90);
    EXPECT_EQ(points[2].place.longitude, 180);
}

TEST(Igc, MayEndItsLinesInAnyWay) {
    for (const std::string end : {"\n", "\r", "\r\n"}) {
        const auto track = parseIgc("AXXX" + end + "B1012304612345N00712345EA0123401256" + end +
                                    "B1012314612345N00712345EA0123401256");
        ASSERT_TRUE(track.ok());
        EXPECT_EQ(track->lines[0].size(), 2u);
    }
}

TEST(Igc, CutShortAnywhereFailsOrIsTheFixesBeforeTheCut) {
    size_t failures = 0;
    for (size_t length = 0; length < kIgc.size(); ++length) {
        const std::string cut = kIgc.substr(0, length);
        const auto track = parseIgc(cut);
        size_t wholeFixes = 0;
        bool brokenFix = false;
        for (size_t start = 0; start < cut.size();) {
            const size_t end = std::min(cut.find('\r', start), cut.size());
            if (cut[start] == 'B') (end - start >= 35 ? wholeFixes += 1 : brokenFix = true);
            start = end + 2;
        }
        EXPECT_EQ(track.ok(), wholeFixes > 0 && !brokenFix) << length;
        EXPECT_EQ(track.ok() ? track->lines[0].size() : wholeFixes, wholeFixes) << length;
        failures += track.ok() ? 0 : 1;
    }
    EXPECT_GT(failures, 34u);
}

TEST(Igc, NamesTheLineAndTheFieldThatIsAbsurd) {
    const auto failure = [](const std::string& fix) {
        const auto track = parseIgc("AXXX\n" + fix + "\n");
        return track.ok() ? std::string("none") : track.failure().message;
    };
    EXPECT_EQ(failure("B1012304612345N00712345EA0123401256"), "none");
    EXPECT_EQ(failure("B1012309100000N00712345EA0123401256"), "line 2 has latitude \"9100000N\", expected as 4612345N");
    EXPECT_EQ(failure("B1012304660000N00712345EA0123401256"), "line 2 has latitude \"4660000N\", expected as 4612345N");
    EXPECT_EQ(failure("B1012304612345X00712345EA0123401256"), "line 2 has latitude \"4612345X\", expected as 4612345N");
    EXPECT_EQ(failure("B1012304612345N18000001EA0123401256"),
              "line 2 has longitude \"18000001E\", expected as 00712345E");
    EXPECT_EQ(failure("B1012304612345N007 2345EA0123401256"),
              "line 2 has longitude \"007 2345E\", expected as 00712345E");
    EXPECT_EQ(failure("B1012304612345N00712345EX0123401256"), "line 2 has validity \"X\", expected A or V");
    EXPECT_EQ(failure("B1012304612345N00712345EA01234012x6"),
              "line 2 has height \"012x6\", expected as 01234 or -0012");
    EXPECT_EQ(failure("B1012304612345N00712345EA012340125"),
              "line 2 has 34 characters, expected at least 35; the file is cut short or damaged");
    EXPECT_EQ(failure("HFDTE010124"), "it holds no fix (B record)");
    EXPECT_EQ(parseIgc("").failure().message, "it holds no fix (B record)");
}

class TrackFile : public testing::Test {
  protected:
    std::filesystem::path write(const std::string& text) {
        std::ofstream(directory_ / "track", std::ios::binary) << text;
        return directory_ / "track";
    }
    std::string refusal(const std::string& text) {
        const std::filesystem::path path = write(text);
        try {
            (void)readTrack(path);
            return "none";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::input);
            std::string message = error.what();
            const std::string start = "cannot read track " + path.string() + ": ";
            EXPECT_TRUE(message.starts_with(start)) << message;
            return message.substr(std::min(start.size(), message.size()));
        }
    }
    test::TemporaryDirectory directory_;
};

TEST_F(TrackFile, IsReadByItsContentWhateverItsName) {
    EXPECT_EQ(readTrack(write(kIgc)).lines[0].size(), 3u);
    EXPECT_EQ(readTrack(write("\xEF\xBB\xBF" + kIgc)).lines[0].size(), 3u) << "with a byte-order mark";
}

TEST_F(TrackFile, ThatIsNoTrackIsRefused) {
    EXPECT_EQ(refusal(""), "it begins neither like GPX (XML) nor like IGC (A record)");
    EXPECT_EQ(refusal(" \n"), "it begins neither like GPX (XML) nor like IGC (A record)");
    EXPECT_EQ(refusal("{}"), "it begins neither like GPX (XML) nor like IGC (A record)");
    EXPECT_EQ(refusal("A record only"), "it holds no fix (B record)");
    EXPECT_THROW((void)readTrack(directory_ / "missing"), Error);
    EXPECT_THROW((void)readTrack(directory_.path()), Error) << "a directory";
}

TEST_F(TrackFile, BeyondTheLargestSizeIsRefusedUnread) {
    const auto path = write(kIgc);
    std::filesystem::resize_file(path, kMostTrackBytes + 1);  // sparse: takes no disk
    try {
        (void)readTrack(path);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("it has 268435457 bytes, expected at most 268435456"),
                  std::string::npos)
            << error.what();
    }
}

#if TERRAY_WITH_TRACKS

const std::string kGpx = R"(<?xml version="1.0" encoding="UTF-8"?>
<gpx version="1.1" creator="test" xmlns="http://www.topografix.com/GPX/1/1">
  <metadata><name>a way</name></metadata>
  <wpt lat="1" lon="2"><ele>3</ele></wpt>
  <trk><name>first</name>
    <trkseg>
      <trkpt lat="46.25" lon="7.5"><ele>1200.5</ele><time>2024-01-01T00:00:00Z</time></trkpt>
      <trkpt lat="-46.5" lon="-7.75"><ele> +13e2 </ele></trkpt>
    </trkseg>
    <trkseg></trkseg>
    <trkseg><trkpt lon="180" lat="90"/></trkseg>
  </trk>
  <rte><rtept lat="1.5" lon="2.5"><ele>4</ele></rtept></rte>
</gpx>
)";

TEST(Gpx, YieldsALineForEachSegmentAndRoute) {
    const auto track = parseGpx(kGpx);
    ASSERT_TRUE(track.ok()) << track.failure().message;
    ASSERT_EQ(track->lines.size(), 3u) << "an empty segment is no line, a waypoint neither";
    ASSERT_EQ(track->lines[0].size(), 2u);
    EXPECT_EQ(track->lines[0][0].place.latitude, 46.25);
    EXPECT_EQ(track->lines[0][0].place.longitude, 7.5);
    EXPECT_EQ(track->lines[0][0].height, 1200.5);
    EXPECT_EQ(track->lines[0][1].place.latitude, -46.5);
    EXPECT_EQ(track->lines[0][1].place.longitude, -7.75);
    EXPECT_EQ(track->lines[0][1].height, 1300);
    ASSERT_EQ(track->lines[1].size(), 1u);
    EXPECT_EQ(track->lines[1][0].place.longitude, 180);
    EXPECT_FALSE(track->lines[1][0].height.has_value());
    EXPECT_EQ(track->lines[2][0].height, 4);
}

TEST(Gpx, MayGiveItsNamespaceAPrefix) {
    const auto track = parseGpx(R"(<g:gpx xmlns:g="http://www.topografix.com/GPX/1/1"><g:trk><g:trkseg>
        <g:trkpt lat="1" lon="2"><g:ele>3</g:ele></g:trkpt></g:trkseg></g:trk></g:gpx>)");
    ASSERT_TRUE(track.ok());
    EXPECT_EQ(track->lines[0][0].height, 3);
}

TEST(Gpx, CutShortAnywhereFails) {
    const size_t whole = kGpx.find("</gpx>") + 6;
    for (size_t length = 0; length < whole; ++length) EXPECT_FALSE(parseGpx(kGpx.substr(0, length)).ok()) << length;
    EXPECT_TRUE(parseGpx(kGpx.substr(0, whole)).ok());
}

TEST(Gpx, SaysWhatIsAbsurd) {
    const auto failure = [](const std::string& point) {
        const auto track = parseGpx("<gpx><trk><trkseg>" + point + "</trkseg></trk></gpx>");
        return track.ok() ? std::string("none") : track.failure().message;
    };
    EXPECT_EQ(failure(R"(<trkpt lat="90" lon="-180"/>)"), "none");
    EXPECT_EQ(failure(R"(<trkpt lat="90.1" lon="0"/>)"),
              "at byte 19 a point's lat is \"90.1\", expected -90 to 90 degrees");
    EXPECT_EQ(failure(R"(<trkpt lat="0" lon="181"/>)"),
              "at byte 19 a point's lon is \"181\", expected -180 to 180 degrees");
    EXPECT_EQ(failure(R"(<trkpt lat="0"/>)"), "at byte 19 a point's lon is \"\", expected -180 to 180 degrees");
    EXPECT_EQ(failure(R"(<trkpt lat="nan" lon="0"/>)"),
              "at byte 19 a point's lat is \"nan\", expected -90 to 90 degrees");
    EXPECT_EQ(failure(R"(<trkpt lat="1,5" lon="0"/>)"),
              "at byte 19 a point's lat is \"1,5\", expected -90 to 90 degrees");
    EXPECT_EQ(failure(R"(<trkpt lat="0" lon="0"><ele>high</ele></trkpt>)"),
              "at byte 19 a point's ele is \"high\", expected metres");
    EXPECT_EQ(failure(R"(<trkpt lat="0" lon="0"><ele>1e9</ele></trkpt>)"),
              "at byte 19 a point's ele is \"1e9\", expected metres");
    EXPECT_EQ(failure(""), "it holds no point of a track or route (trkpt, rtept)");
    EXPECT_EQ(parseGpx("<kml></kml>").failure().message, "its root element is <kml>, expected <gpx>");
    EXPECT_NE(parseGpx("").failure().message.find("it is no XML"), std::string::npos);
    EXPECT_NE(parseGpx("<gpx><trk></gpx>").failure().message.find("it is no XML"), std::string::npos);
}

TEST(Gpx, NestedBeyondReasonIsRefusedOrReadButDoesNoHarm) {
    std::string deep = "<gpx>";
    for (int i = 0; i < 200'000; ++i) deep += "<a>";
    EXPECT_FALSE(parseGpx(deep).ok());
    for (int i = 0; i < 200'000; ++i) deep += "</a>";
    EXPECT_FALSE(parseGpx(deep + "</gpx>").ok());
}

TEST_F(TrackFile, OfGpxIsReadAndRefusedLikewise) {
    EXPECT_EQ(readTrack(write(kGpx)).lines.size(), 3u);
    EXPECT_EQ(refusal("<html></html>"), "its root element is <html>, expected <gpx>");
}

#else

TEST_F(TrackFile, OfGpxNeedsTheLibrary) {
    try {
        (void)readTrack(write("<gpx></gpx>"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::unsupported);
    }
}

#endif

}  // namespace
}  // namespace terray
