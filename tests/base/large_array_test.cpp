// SPDX-License-Identifier: Apache-2.0
// Large arrays hold what vectors hold, and are in files.
#include "base/sorting/large_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/error.hpp"

namespace cluxel {
namespace {

constexpr std::size_t kFew = kMostBytesInMemory / sizeof(std::uint32_t), kMany = kFew + 1000;

/// The anonymous memory of this process [bytes].
std::size_t anonymousMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (std::size_t kilobytes = 0; word == "RssAnon:" && status >> kilobytes) return kilobytes * 1024;
  return 0;
}

TEST(LargeArray, HoldsWhatAVectorHoldsWhileItGrowsAndIsCopied) {
  std::vector<std::uint32_t> expected;
  LargeArray<std::uint32_t> array;
  for (std::uint32_t i = 0; i < kMany; ++i) expected.push_back(i * 2654435761U), array.push_back(i * 2654435761U);
  EXPECT_TRUE(std::equal(array.begin(), array.end(), expected.begin(), expected.end()));
  LargeArray<std::uint32_t> copy = array;
  copy[7] = 1;
  EXPECT_EQ(array[7], expected[7]) << "a copy is another file";
  const LargeArray<std::uint32_t> moved = std::move(copy);
  EXPECT_EQ(moved[7], 1U);
  EXPECT_EQ(moved[kMany - 1], expected[kMany - 1]);
}

TEST(LargeArray, TakesNoAnonymousMemory) {
  const std::size_t before = anonymousMemory();
  const LargeArray<std::uint32_t> array(4 * kMany, 5U);
  EXPECT_LT(anonymousMemory(), before + kMostBytesInMemory);
  EXPECT_EQ(std::accumulate(array.begin(), array.end(), std::uint64_t{0}), std::uint64_t{20} * kMany);
}

TEST(LargeArray, NeedsTheFolderForTemporaryFilesOnlyWhenItIsLarge) {
  const char* before = std::getenv("TMPDIR");
  const std::optional<std::string> kept = before == nullptr ? std::nullopt : std::optional<std::string>(before);
  ::setenv("TMPDIR", "/there/is/none", 1);
  EXPECT_NO_THROW(LargeArray<std::uint32_t>(kFew, 0U));
  try {
    const LargeArray<std::uint32_t> array(kMany, 0U);
    ADD_FAILURE() << "there is no folder";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    EXPECT_NE(std::string(error.what()).find("/there/is/none"), std::string::npos);
  }
  kept ? ::setenv("TMPDIR", kept->c_str(), 1) : ::unsetenv("TMPDIR");
}

}  // namespace
}  // namespace cluxel
