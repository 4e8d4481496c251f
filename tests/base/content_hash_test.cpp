// SPDX-License-Identifier: Apache-2.0
// Content hashes against published digests, and what they must tell apart.
#include "base/content_hash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace cluxel {
namespace {

TEST(ContentHash, IsTheBeginningOfASha256) {
  ContentHasher hasher;
  hasher.addBytes("abc", 3);
  EXPECT_EQ(hasher.finish().hex(), "ba7816bf8f01cfea414140de5dae2223");  // FIPS 180-4, example 1
  EXPECT_EQ(ContentHasher().finish().hex(), "e3b0c44298fc1c149afbf4c8996fb924");
}

TEST(ContentHash, IsReadBackFromItsDigits) {
  const ContentHash hash = ContentHasher().addText("a map").finish();
  EXPECT_EQ(ContentHash::fromHex(hash.hex()), hash);
  EXPECT_FALSE(hash.isZero());
  EXPECT_TRUE(ContentHash::fromHex(std::string(32, '0')).isZero());
}

TEST(ContentHash, RefusesOtherDigits) {
  for (const char* digits : {"", "12", "ba7816bf8f01cfea414140de5dae222", "ba7816bf8f01cfea414140de5dae22233",
                             "ga7816bf8f01cfea414140de5dae2223", " a7816bf8f01cfea414140de5dae2223"})
    EXPECT_THROW(ContentHash::fromHex(digits), std::invalid_argument) << digits;
}

TEST(ContentHash, OrdersByBytes) {
  const auto low = ContentHash::fromHex("00000000000000000000000000000001");
  const auto high = ContentHash::fromHex("01000000000000000000000000000000");
  EXPECT_LT(low, high);
}

TEST(ContentHasher, TellsTheSplitOfTextsApart) {
  EXPECT_NE(ContentHasher().addText("ab").addText("c").finish(), ContentHasher().addText("a").addText("bc").finish());
}

TEST(ContentHasher, TellsTheSplitOfSpansApart) {
  const std::vector<float> one{1, 2}, two{3}, a{1}, b{2, 3};
  const auto hashOf = [](std::span<const float> x, std::span<const float> y) {
    return ContentHasher().addSpan(x).addSpan(y).finish();
  };
  EXPECT_NE(hashOf(one, two), hashOf(a, b));
}

TEST(ContentHasher, TakesTheSameBytesInAnyPieces) {
  const std::string text(1000, 'x');
  const ContentHash whole = ContentHasher().addBytes(text.data(), text.size()).finish();
  ContentHasher pieces;
  for (std::size_t at = 0; at < text.size(); at += 7)
    pieces.addBytes(text.data() + at, std::min<std::size_t>(7, text.size() - at));
  EXPECT_EQ(pieces.finish(), whole);
}

}  // namespace
}  // namespace cluxel
