// SPDX-License-Identifier: Apache-2.0
// What was appended is read again from any place.
#include "base/sorting/temporary_bytes.hpp"

#include <gtest/gtest.h>

#include <string>

namespace cluxel {
namespace {

TEST(TemporaryBytes, GiveBackWhatWasAppendedAlsoAfterTheyWereForgotten) {
  TemporaryBytes bytes;
  for (int round = 0; round < 2; ++round) {
    std::string all;
    for (std::size_t i = 0; i < 50; ++i) {
      const std::string piece(i * 37 % 1000, static_cast<char>('a' + i % 26));
      EXPECT_EQ(bytes.append(piece), all.size());
      all += piece;
    }
    EXPECT_EQ(bytes.size(), all.size());
    for (const std::size_t place : {std::size_t{0}, all.size() / 3, all.size() - 1}) {
      std::string part(all.size() - place, ' ');
      bytes.read(place, part.data(), part.size());
      EXPECT_EQ(part, all.substr(place));
    }
    bytes.clear();
    EXPECT_EQ(bytes.size(), 0U);
  }
}

}  // namespace
}  // namespace cluxel
