// SPDX-License-Identifier: Apache-2.0
// URLs, forms and media types.
#include "serve/http/url.hpp"
#include "base/ascii.hpp"

#include <gtest/gtest.h>

#include <random>

#include "base/ascii.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/start_page.hpp"
#include "serve/served_map.hpp"

namespace cluxel::serve {
namespace {

TEST(Url, WhatIsEncodedIsDecodedToTheSame) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::string name(random() % 12, '\0'), value(random() % 40, '\0');
    for (std::string* text : {&name, &value})
      for (char& c : *text) c = static_cast<char>(random() % 256);
    const Target target = parseTarget("/a/" + percentEncoded("x" + name) + "?" + percentEncoded("k" + name) + "=" +
                                      percentEncoded(value));
    EXPECT_EQ(target.segments, (std::vector<std::string>{"a", "x" + name}));
    EXPECT_EQ(target.parameters, (Parameters{{"k" + name, value}}));
  }
}

TEST(Url, PathsAndFormsAreSplitAsWritten) {
  const Target target = parseTarget("//maps//a%2Fb/?x=1&y&&x=a+b%2B#fragment");
  EXPECT_EQ(target.segments, (std::vector<std::string>{"maps", "a/b"}));
  EXPECT_EQ(target.parameters, (Parameters{{"x", "1"}, {"y", ""}, {"x", "a b+"}}));
  EXPECT_EQ(parseTarget("/a+b").segments.at(0), "a+b") << "plus is a space in forms only";
  EXPECT_TRUE(parseTarget("/a?").has_query);
  EXPECT_FALSE(parseTarget("/a").has_query);
}

TEST(Url, MalformedEscapesAndNumbersAreRefused) {
  for (const char* bad : {"/%", "/%4", "/%zz", "/?a=%f"}) EXPECT_THROW(parseTarget(bad), Refusal) << bad;
  const Parameters parameters = parseForm("n=1.5&w=7&twice=1&twice=2&bad=1,5&inf=inf&huge=1e999");
  EXPECT_EQ(numberOf(parameters, "n"), 1.5);
  EXPECT_EQ(wholeNumberOf(parameters, "w"), 7U);
  EXPECT_EQ(numberOf(parameters, "absent"), std::nullopt);
  for (const char* name : {"twice", "bad", "inf", "huge"}) EXPECT_THROW(numberOf(parameters, name), Refusal) << name;
  EXPECT_THROW(wholeNumberOf(parameters, "n"), Refusal);
  EXPECT_THROW(requireKnown(parameters, {"n"}), Refusal);
}

TEST(MediaTypes, TheMostSpecificRangeGivesTheQuality) {
  const std::vector<std::string> offers{"application/json", "text/csv", "text/plain"};
  const auto chosen = [&](const char* accept) {
    const auto place = negotiate(accept, offers);
    return place ? offers[*place] : std::string("none");
  };
  EXPECT_EQ(chosen(""), "application/json");
  EXPECT_EQ(chosen(" , "), "none");
  EXPECT_EQ(chosen("text/*"), "text/csv");
  EXPECT_EQ(chosen("*/*;q=0.1, text/csv;q=0, text/*;q=0.5"), "text/plain");
  EXPECT_EQ(chosen("application/json;q=0.5;version=2, text/plain;q=0.6"), "text/plain");
  EXPECT_EQ(chosen("text/csv;q=0.000"), "none");
  EXPECT_EQ(chosen("text/csv;q=nan"), "none");
  EXPECT_EQ(mediaTypeOf("Text/Turtle ; charset=\"UTF-8\""), "text/turtle");
  EXPECT_EQ(charsetOf("Text/Turtle ; Charset=\"UTF-8\""), "utf-8");
}

TEST(MediaTypes, AnyBytesAreTakenForAnHeader) {
  std::mt19937 random(5);
  const std::string alphabet = "text/csv*;q=0.1, \t\"=\xff";
  for (int i = 0; i < 2000; ++i) {
    std::string accept(random() % 60, ' ');
    for (char& c : accept) c = alphabet[random() % alphabet.size()];
    const auto place = negotiate(accept, {"text/csv", "text/plain"});
    EXPECT_TRUE(!place || *place < 2) << accept;
  }
}

TEST(MapArguments, NamesComeFromFilesOrAreGiven) {
  const auto maps = mapArgumentsOf({"a/b.c/campus.clx", "town=x=y.clx", "./odd=name.clx"});
  ASSERT_EQ(maps.size(), 3U);
  EXPECT_EQ(maps[0].name, "campus");
  EXPECT_EQ(maps[1].name, "town");
  EXPECT_EQ(maps[1].file, "x=y.clx");
  EXPECT_EQ(maps[2].name, "odd=name");
  EXPECT_THROW(mapArgumentsOf({"a.clx", "b/a.clx"}), Error);
  EXPECT_THROW(mapArgumentsOf({"=a.clx"}), Error);
}

TEST(StartPage, TextIsNeverMarkup) {
  EXPECT_EQ(htmlText("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
  const std::string page = startPage({"</h2><script>alert(1)</script>"}).body;
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

}  // namespace
}  // namespace cluxel::serve
