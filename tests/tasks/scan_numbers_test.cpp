// SPDX-License-Identifier: Apache-2.0
// Sets of scans, compared with sets of the standard library.
#include "tasks/changes/scan_numbers.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace cluxel::tasks {
namespace {

std::set<std::uint32_t> scansOf(const ScanNumbers& set) {
  std::set<std::uint32_t> scans;
  set.forEach([&](std::uint32_t scan) { EXPECT_TRUE(scans.insert(scan).second) << "visited twice"; });
  return scans;
}

TEST(ScanNumbers, HoldsWhatASetHolds) {
  std::mt19937 random(8);
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t range = round % 2 == 0 ? 70 : 900;
    ScanNumbers a, b;
    std::set<std::uint32_t> in_a, in_b;
    for (std::uint32_t i = random() % 12; i > 0; --i) {
      const auto scan = static_cast<std::uint32_t>(random() % range);
      a.insert(scan), in_a.insert(scan);
    }
    for (std::uint32_t i = random() % 12; i > 0; --i) {
      const auto scan = static_cast<std::uint32_t>(random() % range);
      b.insert(scan), in_b.insert(scan);
    }
    ASSERT_EQ(scansOf(a), in_a);
    ASSERT_EQ(a.size(), in_a.size());
    ASSERT_EQ(a.empty(), in_a.empty());
    std::size_t without = 0;
    for (const std::uint32_t scan : in_a) {
      ASSERT_TRUE(a.contains(scan));
      ASSERT_EQ(b.contains(scan), in_b.contains(scan));
      without += in_b.contains(scan) ? 0 : 1;
    }
    ASSERT_EQ(a.sizeWithout(b), without);
    const ScanNumbers before = a;
    a |= b;
    std::set<std::uint32_t> both = in_a;
    both.insert(in_b.begin(), in_b.end());
    ASSERT_EQ(scansOf(a), both);
    ASSERT_EQ(scansOf(before), in_a) << "a copy is on its own";
  }
}

}  // namespace
}  // namespace cluxel::tasks
