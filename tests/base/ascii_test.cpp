// SPDX-License-Identifier: Apache-2.0
// Case, white space and percent-encoding, byte by byte.
#include "base/ascii.hpp"

#include <gtest/gtest.h>

namespace cluxel {

TEST(Ascii, LowersLettersAndKeepsOtherBytes) {
  EXPECT_EQ(lowerCase("AZaz09[`{\xC3\x84"), "azaz09[`{\xC3\x84");
  for (int byte = 0; byte < 256; ++byte) {
    const char c = static_cast<char>(byte);
    EXPECT_EQ(lowerAscii(c) != c, byte >= 'A' && byte <= 'Z') << byte;
    EXPECT_EQ(isAsciiLetter(c), (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z')) << byte;
    EXPECT_EQ(isAsciiAlphanumeric(c) && !isAsciiLetter(c), byte >= '0' && byte <= '9') << byte;
  }
}

TEST(Ascii, TrimsBlanksTabsAndLineEndsOnly) {
  EXPECT_EQ(trimmed(" \t\r\na b\v\n "), "a b\v");
  EXPECT_EQ(trimmed(" \n"), "");
  EXPECT_EQ(trimmed(""), "");
}

TEST(Ascii, EncodesAllButUnreservedCharacters) {
  EXPECT_EQ(percentEncoded("aZ09-._~"), "aZ09-._~");
  EXPECT_EQ(percentEncoded("a/b c%\xC3\xA4"), "a%2Fb%20c%25%C3%A4");
  EXPECT_EQ(percentEncoded("/tmp/a b", "/"), "/tmp/a%20b");
}

}  // namespace cluxel
