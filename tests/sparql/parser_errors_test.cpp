// SPDX-License-Identifier: Apache-2.0
// Tests of the parser's messages for faulty requests, and of hostile requests.
#include <gtest/gtest.h>

#include <random>

#include "cluxel/error.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::sparql {
namespace {

SparqlParseOptions withPrefix() {
  SparqlParseOptions options;
  options.prefixes = {{"", "http://example.org/"}, {"clx", "https://w3id.org/cluxel/ontology#"}};
  return options;
}

std::string queryError(const std::string& text) {
  try {
    parseQuery(text, withPrefix());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string updateError(const std::string& text) {
  try {
    parseUpdate(text, withPrefix());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SparqlParserErrors, NamePlaceExpectationAndKeyword) {
  EXPECT_EQ(queryError("SELECT ?x\nWHER { ?x a ?y }"),
            "query:2:1: error: expected WHERE or '{', but found WHER\n"
            "  WHER { ?x a ?y }\n"
            "  ^\n"
            "  hint: did you mean WHERE?");
  EXPECT_EQ(queryError("SELECT * { ?x a ?y FILTR(?x > 3) }"),
            "query:1:20: error: expected a triple, a keyword such as OPTIONAL or FILTER, or '}', but found FILTR\n"
            "  SELECT * { ?x a ?y FILTR(?x > 3) }\n"
            "                     ^\n"
            "  hint: did you mean FILTER?");
  EXPECT_EQ(queryError("SELECT * { FILTER(STRLENG(?x) > 3) }"),
            "query:1:19: error: expected an expression, but found STRLENG\n"
            "  SELECT * { FILTER(STRLENG(?x) > 3) }\n"
            "                    ^\n"
            "  hint: did you mean STRLEN?");
  EXPECT_EQ(
      queryError("ASK { ?s ?p ?o"),
      "query:1:15: error: expected a triple, a keyword such as OPTIONAL or FILTER, or '}', but the request ends here\n"
      "  ASK { ?s ?p ?o\n"
      "                ^");
}

TEST(SparqlParserErrors, OfferPrefixes) {
  EXPECT_EQ(queryError("ASK { ?s a rdfs:Class }"),
            "query:1:12: error: the prefix rdfs: is not declared\n"
            "  ASK { ?s a rdfs:Class }\n"
            "             ^\n"
            "  hint: add PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#>");
  EXPECT_EQ(queryError("ASK { ?s a clxx:Tree }"),
            "query:1:12: error: the prefix clxx: is not declared\n"
            "  ASK { ?s a clxx:Tree }\n"
            "             ^\n"
            "  hint: did you mean 'clx:'?");
}

TEST(SparqlParserErrors, PointIntoTheOriginalTextBehindCodePoints) {
  EXPECT_EQ(queryError("ASK { ?\\u0073 ?p 'ok\\u00e4' ; }} "),
            "query:1:32: error: expected the end of the query, but found }\n"
            "  ASK { ?\\u0073 ?p 'ok\\u00e4' ; }} \n"
            "                                 ^");
}

/// Faulty texts, each with a part of its message.
struct Fault {
  std::string text, message;
};

TEST(SparqlParserErrors, CoverTheNotesOfTheQueryGrammar) {
  const std::vector<Fault> faults{
      {"SELECT (1 AS ?x) { ?x ?p ?o }", "?x already has a value in the pattern"},
      {"SELECT (1 AS ?x) (2 AS ?x) { }", "?x is selected before"},
      {"SELECT ?a { ?a ?b ?c } GROUP BY ?b", "?a is neither grouped by nor inside an aggregate"},
      {"SELECT (?a + COUNT(?b) AS ?n) { ?a ?b ?c }", "?a is neither grouped by"},
      {"SELECT * { ?a ?b ?c } GROUP BY ?a", "SELECT * cannot be grouped"},
      {"SELECT (SUM(COUNT(?a)) AS ?n) { }", "an aggregate cannot stand inside an aggregate"},
      {"ASK { FILTER(COUNT(?a) > 1) }", "an aggregate can stand only in SELECT, HAVING and ORDER BY"},
      {"ASK { ?a ?b ?c BIND(1 AS ?c) }", "?c already has a value in this group"},
      {"ASK { VALUES (?a ?b) { (1) } }", "this row has 1 values for 2 variables"},
      {"ASK { VALUES (?a ?a) { (1 2) } }", "?a stands twice in this VALUES"},
      {"ASK { VALUES ?a { ?b } }", "expected an IRI, a literal or UNDEF"},
      {"ASK { _:a ?p ?o OPTIONAL { _:a ?q ?r } }", "the blank node label _:a is already used in another group"},
      {"ASK { _:a ?p ?o . { } _:a ?q ?r }", "the blank node label _:a is already used in another group"},
      {"CONSTRUCT { ?a :p* ?b } { ?a :p ?b }", "a property path cannot stand here"},
      {"CONSTRUCT WHERE { ?a :p ?b FILTER(?b) }", "expected a triple or '}'"},
      {"ASK { FILTER(REGEX(?a)) }", "REGEX takes 2 or 3 arguments, not 1"},
      {"ASK { FILTER(BOUND(1)) }", "expected '(' and a variable after BOUND"},
      {"ASK { FILTER(RAND(1)) }", "RAND takes no argument, not 1"},
      {"ASK { FILTER :f }", "expected '(' and the function's arguments"},
      {"ASK { ?s <a> ?o }", "the relative IRI <a> has no base"},
      {"ASK { ?s ?p ?o FILTER(?s<?p&&?o>1) }", "put a space after it"},
      {"ASK { ?s ?p 'a }", "the string is not closed on its line"},
      {"ASK { ?s ?p '''a }", "the string is never closed"},
      {"ASK { ?s ?p 'a\\q' }", "this escape means nothing"},
      {"ASK { ?s ?p '\\uD800' }", "this is no code point that text may hold"},
      {"ASK { ?s ?p :a\\b }", "in a local name a backslash may stand only before"},
      {"ASK { ?s ?p :a%2g }", "two hexadecimal digits must follow '%'"},
      {"ASK { ?s ?p ?o & ?q }", "and is '&&'"},
      {"SELECT ?x { } LIMIT 1.5", "expected a whole number after LIMIT"},
      {"INSERT DATA { :a :b :c }", "this is an update, not a query"},
      {"", "expected SELECT, CONSTRUCT, DESCRIBE or ASK, but the request ends here"},
      {"ASK { ?s ?p \xFF }", "this byte is not UTF-8"},
      {std::string("ASK { \0 }", 9), "the request holds a zero byte"}};
  for (const Fault& fault : faults)
    EXPECT_NE(queryError(fault.text).find(fault.message), std::string::npos) << fault.text << "\n"
                                                                             << queryError(fault.text);
}

TEST(SparqlParserErrors, CoverTheNotesOfTheUpdateGrammar) {
  const std::vector<Fault> faults{
      {"DELETE { _:a :p ?o } WHERE { ?s :p ?o }", "a blank node cannot be deleted by its label"},
      {"DELETE WHERE { [] :p ?o }", "a blank node cannot be deleted by its label"},
      {"DELETE DATA { :a :p [] }", "a blank node cannot be deleted by its label"},
      {"DELETE WHERE { ?a :p/:q ?o }", "a property path cannot stand here"},
      {"INSERT DATA { ?a :p 1 }", "a variable cannot stand in DATA"},
      {"INSERT DATA { GRAPH ?g { :a :p 1 } }", "a variable cannot stand in DATA"},
      {"INSERT DATA { 1 :p 1 }", "a literal cannot be the subject of a triple"},
      {"INSERT DATA { _:a :p 1 } ; INSERT DATA { _:a :p 2 }", "was used by an earlier operation"},
      {"INSERT { :a :p :b }", "expected WHERE"},
      {"CREATE :g", "expected GRAPH"},
      {"CLEAR :g", "expected GRAPH and an IRI, DEFAULT, NAMED or ALL"},
      {"COPY ALL TO :g", "expected a graph's IRI or DEFAULT"},
      {"SELECT * { }", "this is a query, not an update"},
      {"INSRT DATA { }", "did you mean INSERT?"},
      {"CLEAR ALL CLEAR ALL", "expected ';' and another operation"}};
  for (const Fault& fault : faults)
    EXPECT_NE(updateError(fault.text).find(fault.message), std::string::npos) << fault.text << "\n"
                                                                              << updateError(fault.text);
}

std::string repeated(const std::string& part, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

TEST(SparqlParserErrors, RefuseDeepNestingInPlainWords) {
  constexpr std::size_t deep = 100000;
  for (const std::string& text :
       {"ASK " + repeated("{", deep), "ASK { FILTER" + repeated("(", deep), "ASK { FILTER(" + repeated("!(", deep),
        "ASK { ?s " + repeated("(", deep), "ASK { ?s ?p " + repeated("(", deep),
        "ASK { ?s ?p " + repeated("[ :p ", deep), "ASK { FILTER(" + repeated("STR(", deep),
        "ASK { FILTER(" + repeated("NOT EXISTS { FILTER(", deep), "SELECT * " + repeated("{ SELECT * ", deep),
        "ASK { ?s !" + repeated("(", deep), "ASK { FILTER(" + repeated("1 + ", deep) + "1) }",
        "ASK { FILTER(1" + repeated(" IN (1) = 2 || 1", 10) + repeated(" * 1", deep) + ") }"}) {
    const std::string error = queryError(text);
    const bool plain =
        error.find("nested deeper than 256") != std::string::npos || error.find("expected") != std::string::npos;
    EXPECT_TRUE(plain) << text.substr(0, 40) << ": " << error.substr(0, 200);
  }
}

TEST(SparqlParserErrors, TakeLongButFlatRequests) {
  EXPECT_EQ(queryError("ASK { FILTER(" + repeated("?a = 1 || ", 50000) + "?b) }"), "no error");
  EXPECT_EQ(queryError("ASK { ?s ?p " + repeated("1, ", 50000) + "2 }"), "no error");
  EXPECT_EQ(queryError("ASK { ?s :a" + repeated("/:a", 50000) + " ?o }"), "no error");
  EXPECT_EQ(queryError("ASK { { }" + repeated(" UNION { }", 50000) + " }"), "no error");
  EXPECT_EQ(queryError("ASK { VALUES ?a { " + repeated("1 ", 50000) + " } }"), "no error");
}

TEST(SparqlParserErrors, RefuseWhatIsLongerThanTheLimit) {
  SparqlParseOptions options;
  options.max_bytes = 10;
  EXPECT_THROW(parseQuery("ASK { ?s ?p ?o }", options), InputError);
}

/// Any prefix of a request and any request with changed bytes gives a syntax tree or an InputError.
TEST(SparqlParserErrors, SurviveDamagedRequests) {
  const std::string whole =
      "PREFIX a: <http://a/> SELECT DISTINCT ?x (GROUP_CONCAT(?y ; SEPARATOR = ', ') AS ?z) FROM <http://g> WHERE { ?x "
      "a:p/^a:q*|!(a|^a:r) [ a:s (1 2.5 -3e4 'x'@en) ] . OPTIONAL { GRAPH ?g { ?x ?p \"\"\"\\u00e9\"\"\" } FILTER NOT "
      "EXISTS { ?x a:t _:b } } MINUS { VALUES (?x ?y) { (UNDEF true) } } BIND(IF(?x > 3, STR(?y), COALESCE(?p)) AS ?w) "
      "{ "
      "SELECT ?q { ?q ?r ?s } LIMIT 3 } } GROUP BY ?x HAVING (COUNT(*) > 1) ORDER BY DESC(?z) OFFSET 2";
  ASSERT_NO_THROW(parseQuery(whole));
  std::mt19937 random(7);
  for (std::size_t i = 0; i < 6000; ++i) {
    std::string damaged = i < whole.size() ? whole.substr(0, i) : whole;
    for (int changes = static_cast<int>(random() % 4); changes > 0 && !damaged.empty(); --changes)
      damaged[random() % damaged.size()] = static_cast<char>(random() % 256);
    try {
      parseQuery(damaged);
    } catch (const InputError& error) {
      EXPECT_FALSE(error.diagnostics().empty());
    }
  }
}

}  // namespace
}  // namespace cluxel::sparql
