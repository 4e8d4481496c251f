// SPDX-License-Identifier: Apache-2.0
// A radix sort gives what a stable sort by comparisons gives, for short and long keys.
#include "base/radix_order.hpp"

#include <gtest/gtest.h>

#include <random>

namespace cluxel {
namespace {

/// Keys that differ in the bits of `mask` only; few values, so that many are equal, where `mask` is small.
std::vector<std::uint64_t> randomKeys(std::size_t count, std::uint64_t mask, std::uint64_t rest) {
  std::mt19937_64 random(count + mask);
  std::vector<std::uint64_t> keys(count);
  for (std::uint64_t& key : keys) key = (random() & mask) | (rest & ~mask);
  return keys;
}

std::vector<std::uint32_t> expectedOrder(const std::vector<std::uint64_t>& keys) {
  std::vector<std::uint32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  return order;
}

class RadixOrder : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RadixOrder, IsThatOfAStableSort) {
  for (const std::size_t count : {0U, 1U, 2U, 3U, 100U, 20'000U})
    for (const std::uint64_t rest : {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{0x5555'5555'5555'5555}}) {
      const std::vector<std::uint64_t> keys = randomKeys(count, GetParam(), rest);
      const std::vector<std::uint32_t> expected = expectedOrder(keys);
      EXPECT_EQ(orderOf(keys), expected) << count;
      std::vector<KeyedItem> items;
      for (const std::uint64_t key : keys) items.push_back({key, static_cast<std::uint32_t>(items.size())});
      sortByKey(items);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(items[i].item, expected[i]);
        ASSERT_EQ(items[i].key, keys[expected[i]]);
      }
    }
}

// None, one bit, one digit, 32 and 33 bits (the last that fit beside an index, and the first that do not), bits in
// runs, and all.
INSTANTIATE_TEST_SUITE_P(Bits, RadixOrder,
                         testing::Values(0U, std::uint64_t{1} << 63U, 0x7FFU, 0xFFFU, 0xFFFF'FFFFU, 0x1'FFFF'FFFFU,
                                         0x8001'0F0F'0000'1111U, 0x5555'5555'5555'5555U, ~std::uint64_t{0}));

TEST(KeyBits, KeepTheOrderOfKeysInFewerBits) {
  const std::vector<std::uint64_t> keys = randomKeys(500, 0x00F0'0000'3000'0001U, 0xABCD'EF01'2345'6789U);
  const KeyBits packed(keys.size(), [&](std::size_t i) { return keys[i]; });
  EXPECT_EQ(packed.bits(), 7);
  for (std::size_t i = 1; i < keys.size(); ++i) EXPECT_EQ(keys[i] < keys[0], packed(keys[i]) < packed(keys[0]));
}

TEST(SortNumbers, SortsFewAndManyOfSmallAndLargeRanges) {
  std::mt19937 random(1);
  for (const std::size_t count : {0U, 1U, 100U, 128U, 5000U})
    for (const std::uint32_t range : {1U, 200U, 70'000U, 0xFFFFFFFFU}) {
      std::uniform_int_distribution<std::uint32_t> number(0xFFFFFFFFU - range, 0xFFFFFFFFU);
      std::vector<std::uint32_t> numbers(count);
      for (std::uint32_t& value : numbers) value = number(random);
      std::vector<std::uint32_t> expected = numbers;
      std::sort(expected.begin(), expected.end());
      sortNumbers(numbers);
      EXPECT_EQ(numbers, expected) << count << " numbers of a range of " << range;
    }
}

}  // namespace
}  // namespace cluxel
