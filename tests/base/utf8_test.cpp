// SPDX-License-Identifier: Apache-2.0
// Tests of UTF-8 decoding and of byte order marks.
#include "base/utf8.hpp"

#include <gtest/gtest.h>

namespace cluxel {
namespace {

TEST(ByteOrderMark, IsSkippedOnlyAtTheBeginningAndOnlyOnce) {
  EXPECT_EQ(withoutByteOrderMark("\xEF\xBB\xBFtext"), "text");
  EXPECT_EQ(withoutByteOrderMark("\xEF\xBB\xBF\xEF\xBB\xBF"), "\xEF\xBB\xBF");
  EXPECT_EQ(withoutByteOrderMark("a\xEF\xBB\xBF"), "a\xEF\xBB\xBF");
  EXPECT_EQ(withoutByteOrderMark("\xEF\xBB"), "\xEF\xBB");
  EXPECT_EQ(withoutByteOrderMark(""), "");
}

TEST(Utf8, DecodesWhatItEncodes) {
  for (const std::uint32_t value : {0x41U, 0xE9U, 0x20ACU, 0x1F333U, 0x10FFFFU}) {
    std::string text;
    appendUtf8(text, value);
    const CodePoint decoded = decodeUtf8(text, 0);
    EXPECT_EQ(decoded.value, value);
    EXPECT_EQ(decoded.bytes, text.size());
    EXPECT_EQ(firstInvalidUtf8(text), std::nullopt);
  }
}

TEST(Utf8, RefusesOverlongFormsSurrogatesAndLargeValues) {
  for (const char* text : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80", "\xE2\x82"})
    EXPECT_EQ(firstInvalidUtf8(text), 0U) << text;
}

}  // namespace
}  // namespace cluxel
