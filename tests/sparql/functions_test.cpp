// SPDX-License-Identifier: Apache-2.0
// Tests of functions, casts, comparisons and three-valued logic on single values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

struct Case {
  std::string expression, expected;
};

class Functions : public testing::TestWithParam<Case> {
 protected:
  static const SmallStore& store() {
    static const SmallStore made;
    return made;
  }
};

TEST_P(Functions, GiveTheValueOfTheSpecification) {
  EXPECT_EQ(store().value(GetParam().expression), GetParam().expected) << GetParam().expression;
}

const std::string kTrue = "\"true\"^^boolean", kFalse = "\"false\"^^boolean";

INSTANTIATE_TEST_SUITE_P(
    Strings, Functions,
    testing::Values(
        Case{"STRLEN(\"Bäume 🌳\")", "\"7\"^^integer"}, Case{"UCASE(\"straße\")", "\"STRASSE\""},
        Case{"LCASE(\"ÄÖÜ\"@de)", "\"äöü\"@de"}, Case{"SUBSTR(\"Bäume\", 2, 2)", "\"äu\""},
        Case{"SUBSTR(\"metadata\", 4)", "\"adata\""}, Case{"SUBSTR(\"12345\", 1.5, 2.6)", "\"234\""},
        Case{"SUBSTR(\"12345\", 0, 3)", "\"12\""}, Case{"SUBSTR(\"12345\", -42)", "\"12345\""},
        Case{"SUBSTR(\"12345\", 0/0)", "-"}, Case{"STRBEFORE(\"abc\"@en, \"b\")", "\"a\"@en"},
        Case{"STRBEFORE(\"abc\", \"x\")", "\"\""}, Case{"STRBEFORE(\"abc\", \"b\"@en)", "-"},
        Case{"STRAFTER(\"abc\"@en, \"\")", "\"abc\"@en"}, Case{"STRAFTER(\"abc\", \"b\")", "\"c\""},
        Case{"CONCAT(\"a\"@en, \"b\"@en)", "\"ab\"@en"}, Case{"CONCAT(\"a\"@en, \"b\")", "\"ab\""},
        Case{"CONCAT()", "\"\""}, Case{"CONCAT(\"a\", 1)", "-"}, Case{"CONTAINS(\"abc\"@en, \"b\")", kTrue},
        Case{"CONTAINS(\"abc\", \"b\"@en)", "-"}, Case{"STRSTARTS(\"abc\", \"ab\")", kTrue},
        Case{"STRENDS(\"abc\", \"ab\")", kFalse}, Case{"ENCODE_FOR_URI(\"Los Ängeles\")", "\"Los%20%C3%84ngeles\""},
        Case{"REPLACE(\"abcd\", \"b(.)\", \"[$1]\")", "\"a[c]d\""},
        Case{"REPLACE(\"abab\", \"B\", \"Z\", \"i\")", "\"aZaZ\""}, Case{"REPLACE(\"abc\", \"x*\", \"-\")", "-"},
        Case{"REPLACE(\"a.b\", \".\", \"-\", \"q\")", "\"a-b\""}, Case{"REGEX(\"Bäume\", \"^B.UME$\", \"i\")", kTrue},
        Case{"REGEX(\"a\\nb\", \"a.b\")", kFalse}, Case{"REGEX(\"a\\nb\", \"a.b\", \"s\")", kTrue},
        Case{"REGEX(\"abc\", \"(\")", "-"}, Case{"REGEX(\"abc\", \"b\", \"z\")", "-"},
        Case{"REGEX(\"a\\n\", \"a$\")", kFalse}, Case{"MD5(\"abc\")", "\"900150983cd24fb0d6963f7d28e17f72\""},
        Case{"SHA1(\"abc\")", "\"a9993e364706816aba3e25717850c26c9cd0d89d\""},
        Case{"SHA256(\"abc\")", "\"ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad\""},
        Case{"SHA1(1)", "-"}));

INSTANTIATE_TEST_SUITE_P(
    Regex, Functions,
    testing::Values(
        Case{"REGEX(\"ax\", \"a#b\", \"x\")", kFalse}, Case{"REGEX(\"a#b\", \" a # b \", \"x\")", kTrue},
        Case{"REGEX(\"a b\", \"a[ ]b\", \"x\")", kTrue}, Case{"REGEX(\"ab\", \"a[ ]b\", \"x\")", kFalse},
        Case{"REGEX(\"a b\", \"a\\\\[ ?b\", \"x\")", kFalse}, Case{"REGEX(\"b\", \"^[a-z-[aeiou]]$\")", kTrue},
        Case{"REGEX(\"e\", \"^[a-z-[aeiou]]$\")", kFalse}, Case{"REGEX(\"e\", \"^[a-z-[aeiou-[e]]]$\")", kTrue},
        Case{"REGEX(\"-\", \"^[a-]$\")", kTrue}, Case{"REGEX(\"]\", \"^[\\\\]-]$\")", kTrue},
        Case{"REPLACE(\"abcde\", \"[a-e-[c]]\", \"x\")", "\"xxcxx\""}, Case{"REGEX(\"K\", \"^\\\\c+$\")", "-"},
        // XML Schema: \w is neither punctuation, nor separator, nor other; \s is four characters; [:alpha:] is nothing
        Case{"REGEX(\"_\", \"\\\\w\")", kFalse}, Case{"REGEX(\"+\", \"^\\\\w$\")", kTrue},
        Case{"REGEX(\"\\u0301\", \"^[\\\\w]$\")", kTrue}, Case{"REGEX(\"_ab\", \"^\\\\W\\\\w[^\\\\W]$\")", kTrue},
        Case{"REGEX(\"é9\", \"^\\\\w{2}$\")", kTrue}, Case{"REGEX(\"\\u00A0\", \"\\\\s\")", kFalse},
        Case{"REGEX(\"\\t\", \"^[\\\\s]$\")", kTrue}, Case{"REGEX(\"\\u00A0\", \"^[\\\\S]\\\\s*$\")", kTrue},
        Case{"REGEX(\" \", \"[\\\\S]\")", kFalse}, Case{"REGEX(\"x\", \"^[\\\\w-[x]]$\")", kFalse},
        Case{"REGEX(\"a\", \"[[:alpha:]]\")", "-"}));

INSTANTIATE_TEST_SUITE_P(
    Terms, Functions,
    testing::Values(Case{"STR(<http://a/>)", "\"http://a/\""}, Case{"STR(1.50)", "\"1.50\""},
                    Case{"LANG(\"a\"@EN)", "\"en\""}, Case{"LANG(1)", "\"\""},
                    Case{"LANGMATCHES(\"de-AT\", \"DE\")", kTrue}, Case{"LANGMATCHES(\"\", \"*\")", kFalse},
                    Case{"DATATYPE(\"a\"@en)", "<http://www.w3.org/1999/02/22-rdf-syntax-ns#langString>"},
                    Case{"DATATYPE(1.0) = xsd:decimal", kTrue}, Case{"STRDT(\"1\", xsd:integer) + 1", "\"2\"^^integer"},
                    Case{"STRDT(\"1\"@en, xsd:integer)", "-"}, Case{"STRLANG(\"a\", \"de\")", "\"a\"@de"},
                    Case{"STRLANG(\"a\", \"!\")", "-"}, Case{"ISNUMERIC(\"x\"^^xsd:integer)", kFalse},
                    Case{"ISNUMERIC(\"1\"^^xsd:byte)", kTrue}, Case{"ISLITERAL(1)", kTrue},
                    Case{"ISIRI(IRI(\"http://a/b\"))", kTrue}, Case{"IRI(\"a b\")", "-"}, Case{"IRI(\"rel\")", "-"},
                    Case{"IRI(\"\")", "-"}, Case{"URI(\"//a/b\")", "-"}, Case{"ISIRI(IRI(\"urn:a\"))", kTrue},
                    Case{"IRI(\"http://a/\\u0001\")", "-"}, Case{"SAMETERM(1, 1.0)", kFalse}, Case{"1 = 1.0", kTrue},
                    Case{"ISBLANK(BNODE())", kTrue}, Case{"STRLEN(STRUUID())", "\"36\"^^integer"},
                    Case{"COALESCE(1/0, \"x\")", "\"x\""}, Case{"IF(1/0, 1, 2)", "-"},
                    Case{"IF(\"\", 1, 2)", "\"2\"^^integer"}));

INSTANTIATE_TEST_SUITE_P(
    Numbers, Functions,
    testing::Values(Case{"ROUND(2.5)", "\"3\"^^decimal"}, Case{"ROUND(-2.5)", "\"-2\"^^decimal"},
                    Case{"ROUND(0.49999999999999994e0)", "\"0.0E0\"^^double"}, Case{"CEIL(-1.6)", "\"-1\"^^decimal"},
                    Case{"FLOOR(-1.6)", "\"-2\"^^decimal"}, Case{"ABS(-1.5e0)", "\"1.5E0\"^^double"},
                    Case{"ABS(-7)", "\"7\"^^integer"}, Case{"ABS(\"07\"^^xsd:byte)", "\"7\"^^integer"},
                    Case{"ROUND(\"7\"^^xsd:byte)", "\"7\"^^integer"}, Case{"+\"7\"^^xsd:byte", "\"7\"^^integer"},
                    Case{"ABS(1.50)", "\"1.5\"^^decimal"}, Case{"+?unbound", "-"}, Case{"+(1.50)", "\"1.50\"^^decimal"},
                    Case{"CEIL(\"a\")", "-"}, Case{"\"NaN\"^^xsd:double = \"NaN\"^^xsd:double", kFalse},
                    Case{"\"NaN\"^^xsd:double != 1", kTrue}, Case{"0.1 + 0.2 = 0.3", kTrue},
                    Case{"0.1e0 + 0.2e0 = 0.3e0", kFalse}, Case{"RAND() < 1", kTrue}));

INSTANTIATE_TEST_SUITE_P(
    Casts, Functions,
    testing::Values(Case{"xsd:integer(\" 7 \")", "\"7\"^^integer"}, Case{"xsd:integer(\"7.5\")", "-"},
                    Case{"xsd:integer(7.9)", "\"7\"^^integer"}, Case{"xsd:integer(-7.9e0)", "\"-7\"^^integer"},
                    Case{"xsd:integer(\"INF\"^^xsd:double)", "-"}, Case{"xsd:decimal(1e-3)", "\"0.001\"^^decimal"},
                    Case{"xsd:string(1e6)", "\"1.0E6\""}, Case{"xsd:string(999999e0)", "\"999999\""},
                    Case{"xsd:string(1.0)", "\"1\""}, Case{"xsd:boolean(\"1\")", kTrue},
                    Case{"xsd:boolean(0.0)", kFalse}, Case{"xsd:boolean(\"yes\")", "-"},
                    Case{"xsd:double(\"1e400\")", "\"INF\"^^double"}, Case{"xsd:float(\"0.1\")", "\"1.0E-1\"^^float"},
                    Case{"xsd:dateTime(\"2024-01-01T00:00:00Z\")", "\"2024-01-01T00:00:00Z\"^^dateTime"},
                    Case{"xsd:dateTime(\"2024\")", "-"},
                    Case{"xsd:date(\"2024-01-01T05:00:00Z\"^^xsd:dateTime)", "\"2024-01-01Z\"^^date"},
                    Case{"xsd:byte(300)", "-"}, Case{"xsd:byte(30)", "\"30\"^^byte"}));

INSTANTIATE_TEST_SUITE_P(Times, Functions,
                         testing::Values(Case{"YEAR(\"2024-02-03T04:05:06.70Z\"^^xsd:dateTime)", "\"2024\"^^integer"},
                                         Case{"SECONDS(\"2024-02-03T04:05:06.70Z\"^^xsd:dateTime)", "\"6.7\"^^decimal"},
                                         Case{"TZ(\"2024-02-03T04:05:06-05:00\"^^xsd:dateTime)", "\"-05:00\""},
                                         Case{"TZ(\"2024-02-03T04:05:06\"^^xsd:dateTime)", "\"\""},
                                         Case{"TIMEZONE(\"2024-02-03T04:05:06-05:30\"^^xsd:dateTime)",
                                              "\"-PT5H30M\"^^dayTimeDuration"},
                                         Case{"TIMEZONE(\"2024-02-03T04:05:06\"^^xsd:dateTime)", "-"},
                                         Case{"HOURS(\"04:05:06\"^^xsd:time)", "\"4\"^^integer"}));

INSTANTIATE_TEST_SUITE_P(
    Logic, Functions,
    testing::Values(Case{"(1/0) || true", kTrue}, Case{"(1/0) || false", "-"}, Case{"(1/0) && false", kFalse},
                    Case{"(1/0) && true", "-"}, Case{"!(1/0)", "-"}, Case{"1 IN (1/0, 1)", kTrue},
                    Case{"2 IN (1/0, 1)", "-"}, Case{"2 NOT IN (1, 3)", kTrue}, Case{"1 IN ()", kFalse},
                    Case{"\"a\" < \"b\"", kTrue}, Case{"\"a\"@en < \"b\"@en", "-"}, Case{"\"a\" = 1", kFalse},
                    Case{"<a:> = <a:>", kTrue}, Case{"<a:> != <b:>", kTrue}, Case{"\"x\"^^<u:t> = \"x\"^^<u:t>", kTrue},
                    Case{"\"x\"^^<u:t> = \"y\"^^<u:t>", "-"}, Case{"\"x\"^^xsd:integer = 1", "-"},
                    Case{"true > false", kTrue}, Case{"!\"x\"^^xsd:integer", kTrue}, Case{"!<a:>", "-"}));

TEST(Functions, UnknownOnesAreErrorsOfTheirExpressionAndWarnedOfOnce) {
  const SmallStore store(":a :p 1 .");
  EXPECT_EQ(store.value("geof:distnace(1, 2)"), "-");
  EXPECT_EQ(store.value("COALESCE(geof:area(:a), 0)"), "\"0\"^^integer");
  EXPECT_TRUE(store.rows("SELECT * { ?s :p ?v FILTER(:nobody(?v)) }").empty());
  EXPECT_EQ(store.rows("SELECT * { ?s :p ?v FILTER(:nobody(?v) || true) }").size(), 1U);
  EXPECT_EQ(store.rows("SELECT (:nobody(COUNT(*)) AS ?n) { ?s :p ?v }"), std::vector<std::string>{"-"});
  const auto warnings =
      checkQuery(store.reader(), kPrefixes + "SELECT (geof:distnace(1, 2) + geof:distnace(2, 3) AS ?d) {}");
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].severity, Severity::Warning);
  EXPECT_THAT(warnings[0].message, testing::HasSubstr("unknown function <"));
  EXPECT_THAT(warnings[0].hint, testing::HasSubstr("geosparql/distance"));
}

TEST(Functions, UnknownOnesAreRefusedInRules) {
  QueryOptions of_a_rule;
  of_a_rule.refuse_volatile = true;
  EXPECT_THROW(SmallStore().rows("SELECT (:nobody(1) AS ?x) {}", of_a_rule), InputError);
}

TEST(Functions, WarnOfConstantPatternsThatAreNoRegularExpressions) {
  const SmallStore store;
  const auto warnings = [&store](const std::string& expression) {
    return checkQuery(store.reader(), "SELECT (" + expression + " AS ?x) { BIND(\"a\" AS ?p) }");
  };
  for (const char* faulty :
       {"REGEX(\"a\", \"(\")", "REGEX(\"a\", \"*a\")", "REGEX(\"a\", \"[a\", \"i\")", "REGEX(\"a\", \"a\", \"z\")",
        "REPLACE(\"a\", \"a{2,1}\", \"\")", "REPLACE(\"a\", \"a\", \"\", \"y\")", "REGEX(\"a\", \"\\\\i\")"}) {
    const auto found = warnings(faulty);
    ASSERT_EQ(found.size(), 1U) << faulty;
    EXPECT_THAT(found[0].message, testing::HasSubstr("is no regular expression: ")) << faulty;
    EXPECT_GT(found[0].location.column, 0U);
  }
  for (const char* right : {"REGEX(\"a\", \"(\", \"q\")", "REGEX(\"a\", \"^a$\", \"ims\")", "REGEX(\"a\", ?p)",
                            "REPLACE(\"a\", \"b\", \"(\")"})
    EXPECT_TRUE(warnings(right).empty()) << right;
}

TEST(Functions, WarnOfVariablesThatNoPatternBinds) {
  const SmallStore store;
  const auto warnings = [&store](const std::string& text) { return checkQuery(store.reader(), text); };
  for (const char* faulty :
       {"SELECT * { ?s ?p ?o FILTER(?o < ?radius * ?radius) }", "SELECT * { ?s ?p ?o BIND(?radius AS ?r) }",
        "SELECT * { ?s ?p ?o } ORDER BY ?radius", "SELECT * { ?radius ?p ?o { ?s ?q ?t FILTER(?t < ?radius) } }",
        "SELECT * { ?s ?p ?o FILTER NOT EXISTS { ?s ?p ?q FILTER(?q < ?radius) } }",
        "SELECT (COALESCE(?radius + 1, 1) AS ?r) { ?s ?p ?o }"}) {
    const auto found = warnings(faulty);
    ASSERT_EQ(found.size(), 1U) << faulty;
    EXPECT_THAT(found[0].message, testing::HasSubstr("?radius has no value here: no pattern binds it")) << faulty;
    EXPECT_GT(found[0].location.column, 0U);
  }
  for (const char* right :
       {"SELECT * { ?s ?p ?o FILTER(!BOUND(?radius)) }", "SELECT (COALESCE(?radius, 1) AS ?r) { ?s ?p ?o }",
        "SELECT * { ?s ?p ?o OPTIONAL { ?s ?q ?t } FILTER(?t < ?o) }",
        "SELECT * { ?s ?p ?o FILTER NOT EXISTS { ?s ?q ?t FILTER(?t < ?o) } }",
        "SELECT * { VALUES ?t { 1 } ?s ?p ?o FILTER(?t < ?o) }",
        "SELECT (SUM(?o) AS ?sum) { ?s ?p ?o } GROUP BY ?s HAVING(SUM(?o) > 1) ORDER BY ?sum"})
    EXPECT_TRUE(warnings(right).empty()) << right;
  EXPECT_TRUE(
      PreparedQuery(store.reader(), "SELECT * { ?s ?p ?o FILTER(?o < ?radius) }", {}, {"radius"}).warnings().empty())
      << "a parameter has a value";
}

TEST(Functions, NewObjectIsAFunctionOfClassAndMembersOnly) {
  const SmallStore store;
  EXPECT_EQ(store.value("clx:newObject(clx:Avenue, :a, :b) = clx:newObject(clx:Avenue, :b, :a, :b)"), kTrue);
  EXPECT_EQ(store.value("clx:newObject(clx:Avenue, :a) = clx:newObject(clx:Tree, :a)"), kFalse);
  EXPECT_EQ(store.value("clx:newObject(clx:Avenue, \"a\")"), "-");
}

TEST(Functions, BlankNodesOfOneLabelAreOneNodeWithinASolution) {
  const SmallStore store(":a :p 1 . :b :p 2 .");
  EXPECT_THAT(store.rows("SELECT ?s (BNODE(\"x\") = BNODE(\"x\") AS ?same) WHERE { ?s :p ?v }"),
              testing::ElementsAre(":a " + kTrue, ":b " + kTrue));
  EXPECT_THAT(store.rows("SELECT (COUNT(DISTINCT ?b) AS ?n) WHERE { ?s :p ?v BIND(BNODE(\"x\") AS ?b) }"),
              testing::ElementsAre("\"2\"^^integer"));
}

TEST(Functions, TheClockAndChanceFollowTheOptions) {
  const SmallStore store;
  QueryOptions options;
  options.seed = 7;
  options.now_us = 1'700'000'000'000'000;
  EXPECT_THAT(store.rows("SELECT (NOW() AS ?now) {}", options),
              testing::ElementsAre("\"2023-11-14T22:13:20Z\"^^dateTime"));
  EXPECT_EQ(store.rows("SELECT (RAND() AS ?r) (UUID() AS ?u) {}", options),
            store.rows("SELECT (RAND() AS ?r) (UUID() AS ?u) {}", options));
  options.refuse_volatile = true;
  EXPECT_THROW(store.rows("SELECT (RAND() AS ?r) {}", options), InputError);
}

}  // namespace
}  // namespace cluxel::test
