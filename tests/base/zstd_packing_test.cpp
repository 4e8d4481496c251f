// SPDX-License-Identifier: Apache-2.0
// What was packed comes back bit for bit; what is damaged is refused before much memory is asked for.
#include "base/packing/zstd_packing.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace cluxel {
namespace {

std::string randomBytes(std::size_t size, std::mt19937& random) {
  std::string bytes(size, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  return bytes;
}

constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 40U;

TEST(Packing, GivesBackWhatWasPacked) {
  std::mt19937 random(1);
  for (const std::size_t size : {0U, 1U, 100U, 200'000U}) {
    for (const std::string& bytes : {randomBytes(size, random), std::string(size, 'a')}) {
      const auto back = unpackedBytes(packedBytes(bytes), kNoLimit);
      ASSERT_TRUE(back.has_value());
      EXPECT_TRUE(back->view() == bytes) << size;
    }
  }
  EXPECT_LT(packedBytes(std::string(1'000'000, 'a')).size(), 1'000U);
}

TEST(Packing, RefusesWhatIsCutShortOrLonger) {
  std::mt19937 random(2);
  const std::string packed = packedBytes(randomBytes(300, random) + std::string(5'000, 'x'));
  for (std::size_t size = 0; size < packed.size(); ++size)
    EXPECT_FALSE(unpackedBytes(packed.substr(0, size), kNoLimit).has_value()) << size;
  EXPECT_FALSE(unpackedBytes(packed + "x", kNoLimit).has_value());
  EXPECT_FALSE(unpackedBytes(packed + packed, kNoLimit).has_value()) << "two frames";
}

TEST(Packing, AFlippedBitGivesNothingOrBytesOfTheStatedNumber) {
  std::mt19937 random(3);
  const std::string packed = packedBytes(randomBytes(300, random) + std::string(500, 'x'));
  for (std::size_t at = 0; at < packed.size(); ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string damaged = packed;
      damaged[at] = static_cast<char>(damaged[at] ^ (1U << bit));
      const auto back = unpackedBytes(damaged, kNoLimit);
      EXPECT_LT(back ? back->size : 0, std::size_t{1} << 26U) << at << ' ' << bit;
    }
}

TEST(Packing, RefusesAFrameThatStatesMoreThanItCanHold) {
  std::string frame = {'\x28', '\xB5', '\x2F', '\xFD', '\xE0'};  // single segment, with a size of 8 bytes
  for (const std::uint64_t size : {std::uint64_t{1} << 40U, std::uint64_t{1} << 62U, ~std::uint64_t{1}}) {
    std::string damaged = frame;
    damaged.append(reinterpret_cast<const char*>(&size), sizeof size);
    EXPECT_FALSE(unpackedBytes(damaged + std::string(100, '\0'), kNoLimit).has_value()) << size;
  }
}

TEST(Packing, RefusesMoreThanTheReaderExpects) {
  const std::string packed = packedBytes(std::string(100'000, 'a'));
  EXPECT_TRUE(unpackedBytes(packed, 100'000).has_value());
  EXPECT_FALSE(unpackedBytes(packed, 99'999).has_value());
}

TEST(Packing, PlanesAreTheBytesOfEqualWeight) {
  std::string planes;
  appendPlanes(planes, "abcdefghi", 3, 3);
  EXPECT_EQ(planes, "adgbehcfi");
  std::mt19937 random(4);
  for (const std::size_t width : {1U, 2U, 3U, 4U, 8U, 12U, 40U})
    for (const std::size_t count : {0U, 1U, 2U, 77U}) {
      const std::string items = randomBytes(width * count, random);
      std::string apart = "head", back(items.size(), '\0');
      appendPlanes(apart, items.data(), count, width);
      ASSERT_EQ(apart.size(), 4 + items.size());
      readPlanes(apart.data() + 4, back.data(), count, width);
      EXPECT_EQ(back, items) << width << ' ' << count;
    }
}

TEST(Packing, DifferencesKeepEveryBitOfNumbers) {
  std::mt19937 random(5);
  std::vector<std::uint32_t> whole{0, 1, 0, ~0U, 0, 1U << 31U};
  std::vector<float> real{0.0F, -0.0F, 1e-45F, -1e-45F, 3e38F, -3e38F, 1.0F};
  for (const auto value : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
    real.insert(real.end(), {value, -value});
  for (int i = 0; i < 10'000; ++i) {
    whole.push_back(static_cast<std::uint32_t>(random()));
    real.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  }
  std::vector<std::uint32_t> differences = differencesOf(whole);
  sumUp(differences);
  EXPECT_EQ(differences, whole);
  std::vector<float> back;
  sumUp(differencesOf(real), back);
  ASSERT_EQ(back.size(), real.size());
  for (std::size_t i = 0; i < real.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint32_t>(back[i]), std::bit_cast<std::uint32_t>(real[i])) << i;
}

TEST(Packing, DifferencesOfNearNumbersAreSmall) {
  EXPECT_EQ(differencesOf(std::vector<std::uint32_t>{5, 6, 4, 4}), (std::vector<std::uint32_t>{10, 2, 3, 0}));
  const float next = std::nextafter(0.0F, 1.0F);
  EXPECT_EQ(differencesOf(std::vector<float>{0.0F, next, -0.0F}), (std::vector<std::uint32_t>{0, 2, 3}));
}

TEST(FastDigest, TellsContentsApartHoweverTheyAreCut) {
  FastDigest whole, parts, other;
  whole.add("abcdef", 6);
  parts.add("ab", 2), parts.add("", 0), parts.add("cdef", 4);
  other.add("abcdeg", 6);
  EXPECT_EQ(whole.finish().size(), 16U);
  EXPECT_EQ(whole.finish(), parts.finish());
  EXPECT_NE(whole.finish(), other.finish());
}

}  // namespace
}  // namespace cluxel
