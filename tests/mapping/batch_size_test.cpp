// SPDX-License-Identifier: Apache-2.0
// How scans of equal size are divided into batches.
#include "mapping/build/batch_size.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace cluxel::mapping {
namespace {

std::vector<std::size_t> batchesOf(std::size_t scans, std::uint64_t points_of_scan, std::uint64_t batch_points) {
  std::vector<std::size_t> batches;
  std::size_t of_batch = 0;
  for (std::size_t i = 0; i < scans; ++i) {
    ++of_batch;
    if (!isFull(of_batch * points_of_scan, of_batch, scans - i - 1, batch_points)) continue;
    batches.push_back(of_batch);
    of_batch = 0;
  }
  if (of_batch > 0) batches.push_back(of_batch);
  return batches;
}

using ::testing::ElementsAre;

TEST(BatchSize, TakesAlongARestOfLessThanHalfABatch) {
  EXPECT_THAT(batchesOf(5, 100, 1000), ElementsAre(5));
  EXPECT_THAT(batchesOf(14, 100, 1000), ElementsAre(14));
  EXPECT_THAT(batchesOf(15, 100, 1000), ElementsAre(15));
  EXPECT_THAT(batchesOf(16, 100, 1000), ElementsAre(10, 6));
  EXPECT_THAT(batchesOf(34, 100, 1000), ElementsAre(10, 10, 14));
}

TEST(BatchSize, IsAfterEachScanThatFillsABatch) {
  EXPECT_THAT(batchesOf(3, 100, 1), ElementsAre(1, 1, 1));
  EXPECT_FALSE(isFull(0, 0, 9, 1)) << "nothing to commit";
}

TEST(PartSize, IsAQuarterOfTheMapAtMostUnlessOnePartIsEnough) {
  EXPECT_EQ(partSize(1400, 9000, 1000), 1400U);
  EXPECT_EQ(partSize(1600, 1600, 1000), 400U);
  EXPECT_EQ(partSize(1600, 9000, 1000), 1000U);
  EXPECT_EQ(partSize(9000, 9000, 1000), 1000U);
  EXPECT_EQ(partSize(3, 3, 1), 1U);
}

}  // namespace
}  // namespace cluxel::mapping
