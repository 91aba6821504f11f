// verify finds what is wrong: each test damages a good dataset in one way and expects the tile to be named.

#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "common/error.h"
#include "preprocess/verify_dataset.h"
#include "tests/preprocess/test_dataset.h"

namespace terray {
namespace {

const std::atomic<bool> kNeverStop = false;

/// A small dataset of three levels with holes, and with imagery where this build can make it.
class Verify : public testing::Test {
  protected:
    void SetUp() override {
        const GridHeights source(makeHills({1300, 1100}, 11, 3));
        OpenPhoto photo;
#if TERRAY_WITH_STB
        photo = gridPhoto(Grid<Rgba>({1300, 1100}, Rgba{90, 120, 40, 255}), 2);
#endif
        (void)buildTestDataset(source, path(), {.jobs = 2, .depth = 1}, photo);
    }

    [[nodiscard]] std::filesystem::path path() const {
        return directory_ / "out";
    }
    [[nodiscard]] std::filesystem::path heights() const {
        return path() / kHeightsFile;
    }
    [[nodiscard]] std::vector<Fault> faults() const {
        return verifyDataset(openDataset(path()), 2, kNeverStop).faults;
    }
    /// Faults as "where: what" lines.
    [[nodiscard]] std::string text() const {
        std::string lines;
        for (const Fault& fault : faults()) lines += fault.where + ": " + fault.what + "\n";
        return lines;
    }
    /// Decodes a height tile, lets `edit` change it, and puts it back with a right checksum.
    void editTile(const TileId& id, const std::function<void(HeightTile&)>& edit) const {
        rewriteArchive(heights(), [&](Payloads& payloads, std::string&) {
            HeightTile tile = decodeHeightTile(payloads.at(id), id).value();
            edit(tile);
            tile.record = measureRecord(tile.codes, tile.encoding, tile.record.error);
            payloads.at(id) = encodeHeightTile(tile);
        });
    }
    void editMetadata(const std::function<void(DatasetMetadata&)>& edit) const {
        for (const auto* name : {kHeightsFile, kImageryFile}) {
            if (!std::filesystem::exists(path() / name)) continue;
            rewriteArchive(path() / name, [&](Payloads&, std::string& text) {
                DatasetMetadata metadata = metadataFromJson(Json::parse(text).value()).value();
                edit(metadata);
                text = toJson(metadata).dump();
            });
        }
    }
    void expectFault(const std::string& where, const std::string& what) const {
        const std::string lines = text();
        EXPECT_NE(lines.find(where + ": "), std::string::npos) << lines;
        EXPECT_NE(lines.find(what), std::string::npos) << lines;
    }

    TemporaryDirectory directory_;
};

TEST_F(Verify, AGoodDatasetHasNoFaults) {
    EXPECT_EQ(text(), "");
    const VerifyReport report = verifyDataset(openDataset(path()), 1, kNeverStop);
    EXPECT_EQ(report.heightTiles, 9u + 4 + 1);
    EXPECT_EQ(report.imageryTiles, TERRAY_WITH_STB ? 9u + 4 + 1 : 0u);
}

TEST_F(Verify, RewritingAnArchiveUnchangedKeepsItsBytes) {
    const Bytes before = readFile(heights());
    rewriteArchive(heights(), [](Payloads&, std::string&) {});
    EXPECT_EQ(readFile(heights()), before);
}

TEST_F(Verify, FindsEveryFlippedBitInATile) {
    const Bytes good = readFile(heights());
    const PmtilesHeader header = decodePmtilesHeader(good).value();
    std::mt19937_64 random(4);
    for (int i = 0; i < 40; ++i) {
        Bytes damaged = good;
        const uint64_t bit = random() % (8 * header.tilesLength);
        damaged[header.tilesOffset + bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
        writeFile(heights(), damaged);
        EXPECT_FALSE(faults().empty()) << "bit " << bit;
    }
}

TEST_F(Verify, NoFlippedBitInTheHeaderGoesUnseen) {
    // A dataset of one tile, since it is verified a thousand times.
    std::filesystem::remove_all(path());
    (void)buildTestDataset(GridHeights(makeHills({9, 9}, 1, 0)), path());
    const Bytes good = readFile(heights());
    for (size_t bit = 0; bit < 8 * kPmtilesHeaderBytes; ++bit) {
        Bytes damaged = good;
        damaged[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
        writeFile(heights(), damaged);
        bool seen = false;
        try {
            seen = !faults().empty();
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::dataset) << error.what();
            seen = true;
        }
        EXPECT_TRUE(seen) << "bit " << bit % 8 << " of byte " << bit / 8;
    }
}

TEST_F(Verify, RefusesEveryTruncation) {
    const Bytes good = readFile(heights());
    std::mt19937_64 random(8);
    for (int i = 0; i < 60; ++i) {
        const size_t length = i < 30 ? static_cast<size_t>(i) * 20 : random() % good.size();
        writeFile(heights(), ByteView(good).first(length));
        try {
            (void)faults();
            ADD_FAILURE() << "an archive of " << length << " of " << good.size() << " bytes was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::dataset) << error.what();
        }
    }
}

TEST_F(Verify, FindsSwappedTiles) {
    rewriteArchive(heights(), [](Payloads& payloads, std::string&) {
        std::swap(payloads.at({2, 0, 0}), payloads.at({2, 1, 1}));
    });
    expectFault("heights 2/0/0", "2/1/1");
    expectFault("heights 2/1/1", "2/0/0");
}

TEST_F(Verify, FindsAMissingTile) {
    rewriteArchive(heights(), [](Payloads& payloads, std::string&) { payloads.erase({2, 2, 1}); });
    expectFault("heights 1/1/0", "its child 2/2/1 is missing");
    expectFault("metadata", "counts 14 height tiles, the archive has 13");
}

TEST_F(Verify, FindsATileWithoutParent) {
    rewriteArchive(heights(), [](Payloads& payloads, std::string&) { payloads.erase({1, 1, 1}); });
    expectFault("heights 2/2/2", "its parent is missing");
    expectFault("heights 0/0/0", "its child 1/1/1 is missing");
}

TEST_F(Verify, FindsATileThatItsParentDenies) {
    editTile({1, 0, 0}, [](HeightTile& tile) { tile.children[3] = {}; });
    expectFault("heights 1/0/0", "says that its child 2/1/1 does not exist");
}

TEST_F(Verify, FindsAWrongChildRecord) {
    for (const auto& edit : std::vector<std::function<void(HeightRecord&)>>{
             [](HeightRecord& record) { record.error += 1; }, [](HeightRecord& record) { record.maxHeight += 1; },
             [](HeightRecord& record) { record.hasHoles = !record.hasHoles; }}) {
        editTile({0, 0, 0}, [&](HeightTile& tile) { edit(tile.children[0]); });
        expectFault("heights 0/0/0", "what it says of its child 1/0/0 is not what that tile says");
    }
}

TEST_F(Verify, FindsAnErrorClaimedTooSmallOrTooLarge) {
    // Just above the finest level children err by half a centimetre, so they prove nearly the whole error.
    float error = 0;
    editTile({1, 0, 0}, [&](HeightTile& tile) {
        error = tile.record.error;
        tile.record.error = error - 0.02f;
    });
    expectFault("heights 1/0/0", "but its children prove");
    editTile({1, 0, 0}, [&](HeightTile& tile) { tile.record.error = error + 0.02f; });
    expectFault("heights 1/0/0", "but its children allow at most");
    editTile({2, 0, 0}, [](HeightTile& tile) { tile.record.error = 1; });
    expectFault("heights 2/0/0", "more than the rounding of its codes");
}

TEST_F(Verify, FindsChangedHeights) {
    // One cell of a middle tile, with a right checksum and record.
    editTile({1, 0, 0}, [](HeightTile& tile) {
        for (int64_t x = 100; x < 110; ++x)
            if (uint16_t& code = tile.codes.at(x, 100); code != kNoSurface) code = static_cast<uint16_t>(code ^ 0x40);
    });
    expectFault("heights 1/0/0", "are not the mean of the cells beneath");
}

TEST_F(Verify, FindsAHoleThatIsNone) {
    editTile({1, 0, 0}, [](HeightTile& tile) { tile.codes.at(100, 100) = kNoSurface; });
    expectFault("heights 1/0/0", "1 cells are holes where the tiles beneath are not");
}

TEST_F(Verify, FindsASurfaceBeyondTheEdge) {
    editTile({2, 2, 2}, [](HeightTile& tile) { tile.codes.at(500, 10) = 1; });
    expectFault("heights 2/2/2", "1 cells beyond the sources' edge have a surface");
}

TEST_F(Verify, FindsWrongMetadata) {
    editMetadata([](DatasetMetadata& metadata) {
        metadata.holeSamples += 1;
        metadata.maxHeight += 1;
        metadata.levelErrors[1] *= 2;
        metadata.heightTiles += 1;
    });
    for (const char* what : {"hole samples", "heights range from", "levelErrors", "counts 15 height tiles"})
        expectFault("metadata", what);
}

TEST_F(Verify, RefusesAFormatOfTheFuture) {
    rewriteArchive(heights(), [](Payloads&, std::string& text) {
        Json json = Json::parse(text).value();
        json.set("format", kDatasetFormat + 1);
        text = json.dump();
    });
    try {
        (void)openDataset(path());
        FAIL() << "a format of the future was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::dataset);
        EXPECT_NE(std::string(error.what()).find("format 2"), std::string::npos) << error.what();
    }
}

#if TERRAY_WITH_STB
TEST_F(Verify, FindsFaultsOfImagery) {
    rewriteArchive(path() / kImageryFile, [](Payloads& payloads, std::string&) {
        payloads.erase({2, 1, 0});
        Bytes& damaged = payloads.at({2, 0, 1});
        damaged.at(damaged.size() / 2) ^= std::byte{4};
        ImageryTile tile = decodeImageryTile(payloads.at({1, 1, 1})).value();
        tile.childExists[0] = false;
        payloads.at({1, 1, 1}) = encodeImageryTile(tile);
    });
    expectFault("imagery 1/0/0", "its child 2/1/0 is missing");
    expectFault("imagery 2/0/1", "2/0/1");
    expectFault("imagery 1/1/1", "says that its child 2/2/2 does not exist");
    expectFault("metadata", "counts 14 imagery tiles, the archive has 13");
}

TEST(VerifyFlips, NoFlippedBitAnywhereInTheTwoArchivesGoesUnseen) {
    const TemporaryDirectory directory;
    const std::filesystem::path path = directory / "out";
    (void)buildTestDataset(GridHeights(makeHills({600, 300}, 8, 5)), path, {},
                           gridPhoto(Grid<Rgba>({700, 300}, Rgba{90, 120, 40, 255}), 1));
    const std::atomic<bool> stop = false;
    const auto isSeen = [&] {
        try {
            return !verifyDataset(openDataset(path), 2, stop).faults.empty();
        } catch (const Error& error) {
            return error.code() == ExitCode::dataset;
        }
    };
    ASSERT_FALSE(isSeen());
    std::mt19937_64 random(11);
    constexpr int kFlips = 1000;
    int seen = 0;
    for (int flip = 0; flip < kFlips; ++flip) {
        const std::filesystem::path archive = path / (random() % 2 == 0 ? kHeightsFile : kImageryFile);
        Bytes bytes = readFile(archive);
        // Every other one before the tiles: header, directory and metadata are a hundredth of the bytes.
        const uint64_t bits = 8 * (flip % 2 == 0 ? std::min<size_t>(bytes.size(), 1500) : bytes.size());
        const uint64_t bit = random() % bits;
        bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
        writeFile(archive, bytes);
        const bool isFound = isSeen();
        EXPECT_TRUE(isFound) << archive << ", bit " << bit;
        seen += isFound ? 1 : 0;
        bytes[bit / 8] ^= static_cast<std::byte>(1 << (bit % 8));
        writeFile(archive, bytes);
    }
    std::printf("%d of %d flipped bits were seen\n", seen, kFlips);
}

TEST_F(Verify, RefusesArchivesOfDifferentBuilds) {
    rewriteArchive(heights(), [](Payloads&, std::string& text) {
        Json json = Json::parse(text).value();
        json.set("options", "others");
        text = json.dump();
    });
    EXPECT_THROW((void)openDataset(path()), Error);
    std::filesystem::remove(path() / kImageryFile);
    EXPECT_THROW((void)openDataset(path()), Error);
}
#endif

}  // namespace
}  // namespace terray
