// SPDX-License-Identifier: Apache-2.0
// The words of errors are what people see of the program when something is wrong.
#include "cluxel/error.hpp"

#include <gtest/gtest.h>

namespace cluxel {
namespace {

Diagnostic faultAt(std::size_t line, std::size_t column, std::string source_line) {
  Diagnostic diagnostic;
  diagnostic.location = {.file = "rules.yaml", .line = line, .column = column};
  diagnostic.message = "unknown key";
  diagnostic.hint = "did you mean 'tree'?";
  diagnostic.source_line = std::move(source_line);
  return diagnostic;
}

TEST(SourceLocation, IsWrittenAsFarAsItIsKnown) {
  EXPECT_EQ(toString(SourceLocation{.file = "a"}), "a");
  EXPECT_EQ(toString(SourceLocation{.file = "a", .line = 3}), "a:3");
  EXPECT_EQ(toString(SourceLocation{.file = "a", .line = 3, .column = 7}), "a:3:7");
  EXPECT_EQ(toString(SourceLocation{.file = "a", .byte_offset = 0}), "a: byte 0");
}

TEST(Error, IsReadToItsEndBehindANulCharacter) {
  const std::string name("a\0b", 3);
  EXPECT_STREQ(Error(ErrorKind::NotFound, "no class '" + name + "'").what(), "no class 'a\\0b'");
  EXPECT_STREQ(InputError({.file = "f"}, "no '" + name + "'", "write 'c'").what(),
               "f: error: no 'a\\0b'\n  hint: write 'c'");
}

TEST(Diagnostic, ShowsTheLineTheCaretAndTheHint) {
  EXPECT_EQ(format(faultAt(2, 3, "  tre: x")),
            "rules.yaml:2:3: error: unknown key\n    tre: x\n    ^\n  hint: did you mean 'tree'?");
}

TEST(Diagnostic, PutsTheCaretUnderTheColumnBehindTabsAndLettersOfTwoBytes) {
  EXPECT_NE(format(faultAt(1, 2, "\tkey")).find("\n  \t^"), std::string::npos);
  EXPECT_NE(format(faultAt(1, 6, "B\xC3\xA4um: x")).find("\n      ^"), std::string::npos);
}

TEST(Diagnostic, CountsSeveralFaultsAtTheEnd) {
  Diagnostic warning = faultAt(4, 1, "");
  warning.severity = Severity::Warning;
  const std::string text = format({faultAt(2, 3, ""), warning, faultAt(9, 9, "")});
  EXPECT_TRUE(text.ends_with("\n2 errors, 1 warnings")) << text;
  EXPECT_NE(text.find("rules.yaml:4:1: warning: unknown key"), std::string::npos);
  EXPECT_FALSE(hasErrors({warning}));
  EXPECT_TRUE(hasErrors({warning, faultAt(1, 1, "")}));
}

TEST(LineOf, GivesLinesWithoutTheirEnds) {
  EXPECT_EQ(lineOf("a\r\nb\nc", 1), "a");
  EXPECT_EQ(lineOf("a\r\nb\nc", 2), "b");
  EXPECT_EQ(lineOf("a\r\nb\nc", 3), "c");
  EXPECT_EQ(lineOf("a\r\nb\nc", 4), "");
  EXPECT_EQ(lineOf("a", 0), "");
}

TEST(Locate, AgreesWithCountingByHandForEveryByte) {
  const std::string text = "ab\n\ncde\n";
  std::size_t line = 1, column = 1;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    const SourceLocation place = locate("f", text, at);
    EXPECT_EQ(place.line, line) << at;
    EXPECT_EQ(place.column, column) << at;
    const bool ends = at < text.size() && text[at] == '\n';
    line += ends ? 1 : 0;
    column = ends ? 1 : column + 1;
  }
  EXPECT_EQ(locate("f", text, 999).line, 4U);
}

TEST(InputError, CarriesItsFaultsAndTheExitCode) {
  const InputError error({.file = "a.bin", .byte_offset = 16}, "is cut off", "copy it again");
  EXPECT_EQ(error.kind(), ErrorKind::FaultyInput);
  EXPECT_STREQ(error.what(), "a.bin: byte 16: error: is cut off\n  hint: copy it again");
  EXPECT_EQ(error.diagnostics().size(), 1U);
}

}  // namespace
}  // namespace cluxel
