#include "client/render/slot_table.h"

#include <set>

#include <gtest/gtest.h>

namespace terray {
namespace {

constexpr TileId tile(uint32_t x) {
    return {.level = 10, .x = x, .y = 0};
}

TEST(SlotTable, GivesEverySlotOnceBeforeItEvicts) {
    SlotTable table(4);
    std::set<uint32_t> slots;
    for (uint32_t i = 0; i < 4; ++i) {
        const auto place = table.place(tile(i));
        ASSERT_TRUE(place);
        EXPECT_FALSE(place->evicted);
        slots.insert(place->slot);
        EXPECT_EQ(table.find(tile(i)), place->slot);
    }
    EXPECT_EQ(slots, (std::set<uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(table.size(), 4u);
}

TEST(SlotTable, EvictsTheLeastRecentlyUsed) {
    SlotTable table(3);
    for (uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(table.place(tile(i)));
    EXPECT_TRUE(table.touch(tile(0)));  // now 1 is the oldest
    const uint32_t slotOf1 = table.find(tile(1)).value();
    const auto place = table.place(tile(3));
    ASSERT_TRUE(place);
    EXPECT_EQ(place->evicted, tile(1));
    EXPECT_EQ(place->slot, slotOf1);
    EXPECT_FALSE(table.find(tile(1)));
    EXPECT_EQ(table.place(tile(4))->evicted, tile(2));
    EXPECT_EQ(table.place(tile(5))->evicted, tile(0));
    EXPECT_EQ(table.size(), 3u);
}

TEST(SlotTable, PlacingATileAgainKeepsItsSlotAndMakesItRecent) {
    SlotTable table(2);
    const uint32_t slot = table.place(tile(0))->slot;
    ASSERT_TRUE(table.place(tile(1)));
    const auto again = table.place(tile(0));
    ASSERT_TRUE(again);
    EXPECT_EQ(again->slot, slot);
    EXPECT_FALSE(again->evicted);
    EXPECT_EQ(table.place(tile(2))->evicted, tile(1));
}

TEST(SlotTable, NeverEvictsThePinned) {
    SlotTable table(3);
    for (uint32_t i = 0; i < 3; ++i) ASSERT_TRUE(table.place(tile(i)));
    EXPECT_TRUE(table.pin(tile(0)));
    EXPECT_TRUE(table.pin(tile(1)));
    EXPECT_EQ(table.place(tile(3))->evicted, tile(2));
    EXPECT_EQ(table.place(tile(4))->evicted, tile(3));  // the newcomer is not pinned
}

TEST(SlotTable, HasNoSlotWhenAllArePinnedAndChangesNothing) {
    SlotTable table(2);
    for (uint32_t i = 0; i < 2; ++i) {
        ASSERT_TRUE(table.place(tile(i)));
        ASSERT_TRUE(table.pin(tile(i)));
    }
    EXPECT_FALSE(table.place(tile(2)));
    EXPECT_TRUE(table.find(tile(0)));
    EXPECT_TRUE(table.find(tile(1)));
    EXPECT_FALSE(table.find(tile(2)));
    EXPECT_TRUE(table.place(tile(1)));  // who has a slot keeps it
    table.unpinAll();
    EXPECT_EQ(table.place(tile(2))->evicted, tile(0));
}

TEST(SlotTable, APinLastsUntilUnpinAll) {
    SlotTable table(2);
    ASSERT_TRUE(table.place(tile(0)));
    ASSERT_TRUE(table.pin(tile(0)));
    ASSERT_TRUE(table.place(tile(1)));
    EXPECT_EQ(table.place(tile(2))->evicted, tile(1));
    table.unpinAll();
    EXPECT_EQ(table.place(tile(3))->evicted, tile(0));  // older than 2, and free to go
}

TEST(SlotTable, AReusedSlotDoesNotInheritThePin) {
    SlotTable table(1);
    ASSERT_TRUE(table.place(tile(0)));
    ASSERT_TRUE(table.pin(tile(0)));
    table.unpinAll();
    ASSERT_TRUE(table.place(tile(1)));
    EXPECT_EQ(table.place(tile(2))->evicted, tile(1));
}

TEST(SlotTable, AnswersThatStrangersHaveNoSlot) {
    SlotTable table(1);
    EXPECT_FALSE(table.pin(tile(0)));
    EXPECT_FALSE(table.touch(tile(0)));
    EXPECT_FALSE(table.find(tile(0)));
}

TEST(SlotTable, WithoutSlotsHasRoomForNobody) {
    SlotTable table(0);
    EXPECT_FALSE(table.place(tile(0)));
    EXPECT_EQ(table.capacity(), 0u);
}

}  // namespace
}  // namespace terray
