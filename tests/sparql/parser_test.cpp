// SPDX-License-Identifier: Apache-2.0
// Tests of the syntax trees of queries and updates.
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::sparql {
namespace {

using namespace ast;

SparqlParseOptions withBase() {
  SparqlParseOptions options;
  options.base_iri = "http://example.org/a/b?q#f";
  options.prefixes = {{"", "http://example.org/"}};
  return options;
}

Query read(const std::string& text) {
  return parseQuery(text, withBase());
}
Update readUpdate(const std::string& text) {
  return parseUpdate(text, withBase());
}

const TriplesBlock& firstBlock(const Query& query) {
  return std::get<TriplesBlock>(query.select.where.elements.at(0).value);
}
const Expression& firstFilter(const Query& query) {
  return std::get<Filter>(query.select.where.elements.at(0).value).condition;
}

/// An expression as nested calls, which show its structure.
std::string shape(const Expression& expression, const Query& query) {
  using K = Expression::Kind;
  static const std::map<K, std::string> signs{{K::Or, "||"},
                                              {K::And, "&&"},
                                              {K::Not, "!"},
                                              {K::Equal, "="},
                                              {K::NotEqual, "!="},
                                              {K::Less, "<"},
                                              {K::Greater, ">"},
                                              {K::LessEqual, "<="},
                                              {K::GreaterEqual, ">="},
                                              {K::In, "in"},
                                              {K::NotIn, "notin"},
                                              {K::Add, "+"},
                                              {K::Subtract, "-"},
                                              {K::Multiply, "*"},
                                              {K::Divide, "/"},
                                              {K::Negate, "neg"},
                                              {K::Plus, "pos"},
                                              {K::Exists, "exists"},
                                              {K::NotExists, "notexists"}};
  if (expression.kind == K::Variable) return query.variables[expression.variable].name;
  if (expression.kind == K::Constant) return expression.term.text;
  std::string text = "(";
  if (expression.kind == K::Call)
    text += nameOf(expression.builtin);
  else if (expression.kind == K::Aggregate)
    text += nameOf(expression.aggregate);
  else if (expression.kind == K::Function)
    text += expression.term.text;
  else
    text += signs.at(expression.kind);
  for (const Expression& argument : expression.arguments) text += " " + shape(argument, query);
  return text + ")";
}

std::string filterShape(const std::string& condition) {
  const Query query = read("ASK { FILTER(" + condition + ") }");
  return shape(firstFilter(query), query);
}

TEST(SparqlParser, BindsOperatorsByRank) {
  EXPECT_EQ(filterShape("?a || ?b && ?c = ?d + ?e * ?f"), "(|| a (&& b (= c (+ d (* e f)))))");
  EXPECT_EQ(filterShape("?a * ?b + ?c < ?d && ?e || ?f"), "(|| (&& (< (+ (* a b) c) d) e) f)");
  EXPECT_EQ(filterShape("(?a || ?b) && !?c"), "(&& (|| a b) (! c))");
  EXPECT_EQ(filterShape("?a - ?b - ?c / ?d / ?e"), "(- (- a b) (/ (/ c d) e))");
}

TEST(SparqlParser, JoinsRunsOfOrAndOfAndButKeepsParentheses) {
  EXPECT_EQ(filterShape("?a || ?b || ?c"), "(|| a b c)");
  EXPECT_EQ(filterShape("?a || (?b || ?c)"), "(|| a (|| b c))");
  EXPECT_EQ(filterShape("(?a && ?b) && ?c"), "(&& (&& a b) c)");
}

TEST(SparqlParser, TellsSignedNumbersFromOperators) {
  EXPECT_EQ(filterShape("?a -1 = 0"), "(= (- a 1) 0)");
  EXPECT_EQ(filterShape("-1 < +2"), "(< -1 +2)");
  EXPECT_EQ(filterShape("- ?a = ?b-1"), "(= (neg a) (- b 1))");
  const Query query = read("ASK { ?s :p -5, +1.5, -2e3 }");
  EXPECT_EQ(firstBlock(query).triples[0].object.term(),
            Term::literal("-5", "http://www.w3.org/2001/XMLSchema#integer"));
  EXPECT_EQ(firstBlock(query).triples[1].object.term().text, "+1.5");
  EXPECT_EQ(firstBlock(query).triples[2].object.term().datatype, "http://www.w3.org/2001/XMLSchema#double");
}

TEST(SparqlParser, TakesAComparisonOnlyOnce) {
  EXPECT_THROW(filterShape("?a = ?b = ?c"), InputError);
  EXPECT_EQ(filterShape("?a = ?b && ?c = ?d"), "(&& (= a b) (= c d))");
  EXPECT_EQ(filterShape("?a IN (1, ?b) || ?a NOT IN ()"), "(|| (in a 1 b) (notin a))");
}

TEST(SparqlParser, ReadsBuiltInsWhateverTheirCase) {
  EXPECT_EQ(filterShape("regex(sTr(?a), \"x\", \"i\") && isURI(?b) && BOUND(?c)"),
            "(&& (REGEX (STR a) x i) (ISIRI b) (BOUND c))");
  EXPECT_EQ(filterShape(":f(?a, 1)"), "(http://example.org/f a 1)");
}

TEST(SparqlParser, ResolvesIrisAsRfc3986Says) {
  SparqlParseOptions options;
  options.base_iri = "http://a/b/c/d;p?q";
  const auto resolved = [&](const std::string& reference) {
    const Query query = parseQuery("DESCRIBE <" + reference + ">", options);
    return query.describe[0].term().text;
  };
  const std::vector<std::pair<std::string, std::string>> examples{// RFC 3986, 5.4
                                                                  {"g:h", "g:h"},
                                                                  {"g", "http://a/b/c/g"},
                                                                  {"./g", "http://a/b/c/g"},
                                                                  {"g/", "http://a/b/c/g/"},
                                                                  {"/g", "http://a/g"},
                                                                  {"//g", "http://g"},
                                                                  {"?y", "http://a/b/c/d;p?y"},
                                                                  {"g?y", "http://a/b/c/g?y"},
                                                                  {"#s", "http://a/b/c/d;p?q#s"},
                                                                  {"g#s", "http://a/b/c/g#s"},
                                                                  {"g?y#s", "http://a/b/c/g?y#s"},
                                                                  {";x", "http://a/b/c/;x"},
                                                                  {"g;x=1", "http://a/b/c/g;x=1"},
                                                                  {"", "http://a/b/c/d;p?q"},
                                                                  {".", "http://a/b/c/"},
                                                                  {"./", "http://a/b/c/"},
                                                                  {"..", "http://a/b/"},
                                                                  {"../", "http://a/b/"},
                                                                  {"../g", "http://a/b/g"},
                                                                  {"../..", "http://a/"},
                                                                  {"../../g", "http://a/g"},
                                                                  {"../../../g", "http://a/g"},
                                                                  {"/./g", "http://a/g"},
                                                                  {"/../g", "http://a/g"},
                                                                  {"g.", "http://a/b/c/g."},
                                                                  {"..g", "http://a/b/c/..g"},
                                                                  {"./../g", "http://a/b/g"},
                                                                  {"./g/.", "http://a/b/c/g/"},
                                                                  {"g/./h", "http://a/b/c/g/h"},
                                                                  {"g/../h", "http://a/b/c/h"},
                                                                  {"g;x=1/./y", "http://a/b/c/g;x=1/y"},
                                                                  {"g;x=1/../y", "http://a/b/c/y"},
                                                                  {"g?y/./x", "http://a/b/c/g?y/./x"},
                                                                  {"g#s/../x", "http://a/b/c/g#s/../x"}};
  for (const auto& [reference, expected] : examples) EXPECT_EQ(resolved(reference), expected) << reference;
}

TEST(SparqlParser, DecodesEscapesOfStringsNamesAndCodePoints) {
  const Query query = read(
      "ASK { ?s :p 'a\\t\\n\\\\\\'\\u00e4\\U0001F333', '''x''y\n\"z''', \"\\\\u0041\" ; "
      ":a\\,b%20c.d :\\u006f . ?\\u0078 :q 1 }");
  const auto& triples = firstBlock(query).triples;
  EXPECT_EQ(triples[0].object.term().text, "a\t\n\\'\u00e4\U0001F333");
  EXPECT_EQ(triples[1].object.term().text, "x''y\n\"z");
  EXPECT_EQ(triples[2].object.term().text, "\\u0041");
  EXPECT_EQ(triples[3].predicate.term().text, "http://example.org/a,b%20c.d");
  EXPECT_EQ(triples[3].object.term().text, "http://example.org/o");
  EXPECT_EQ(query.variables[triples[4].subject.variable()].name, "x");
}

TEST(SparqlParser, GivesLanguageTagsInLowerCaseAndPlainLiteralsTheTypeString) {
  const Query query = read("ASK { ?s ?p 'a'@EN-gb, 'b', 'c'^^:t, true, 1.0 }");
  const auto& triples = firstBlock(query).triples;
  EXPECT_EQ(triples[0].object.term(), Term::langLiteral("a", "en-gb"));
  EXPECT_EQ(triples[1].object.term(), Term::literal("b"));
  EXPECT_EQ(triples[2].object.term(), Term::literal("c", "http://example.org/t"));
  EXPECT_EQ(triples[3].object.term(), Term::boolean(true));
  EXPECT_EQ(triples[4].object.term(), Term::literal("1.0", "http://www.w3.org/2001/XMLSchema#decimal"));
}

TEST(SparqlParser, ExpandsListsAndBlankNodePropertyLists) {
  const Query query = read("SELECT * { (1 ?x) :p [ :q ?y ; a :C ] }");
  EXPECT_EQ(firstBlock(query).triples.size(), 4U + 2U + 1U);
  ASSERT_EQ(query.select.projection.size(), 2U) << "blank nodes are no columns";
  EXPECT_EQ(query.variables[query.select.projection[0].variable].name, "x");
  EXPECT_EQ(query.variables[query.select.projection[1].variable].name, "y");
}

std::string pathShape(const Path& path) {
  using K = Path::Kind;
  const auto local = [](const Term& iri) { return iri.text.substr(iri.text.find_last_of("/#") + 1); };
  std::string text;
  const auto parts = [&](const std::string& between) {
    for (const Path& part : path.parts) text += (text.empty() ? "" : between) + pathShape(part);
    return "(" + text + ")";
  };
  switch (path.kind) {
    case K::Link:
      return local(path.iri);
    case K::Inverse:
      return "^" + pathShape(path.parts[0]);
    case K::Sequence:
      return parts("/");
    case K::Alternative:
      return parts("|");
    case K::ZeroOrMore:
      return pathShape(path.parts[0]) + "*";
    case K::OneOrMore:
      return pathShape(path.parts[0]) + "+";
    case K::ZeroOrOne:
      return pathShape(path.parts[0]) + "?";
    case K::NegatedSet:
      break;
  }
  for (const Term& iri : path.forward) text += "!" + local(iri);
  for (const Term& iri : path.backward) text += "!^" + local(iri);
  return text;
}

TEST(SparqlParser, ReadsAllFormsOfPaths) {
  const auto read_path = [](const std::string& path) {
    const Query query = read("ASK { ?s " + path + " ?o }");
    const TriplePattern& triple = firstBlock(query).triples.at(0);
    return triple.isPath() ? pathShape(*triple.path) : "plain " + triple.predicate.term().text;
  };
  EXPECT_EQ(read_path(":p"), "plain http://example.org/p");
  EXPECT_EQ(read_path("(:p)"), "plain http://example.org/p");
  EXPECT_EQ(read_path(":a/:b|:c/^:d"), "((a/b)|(c/^d))");
  EXPECT_EQ(read_path("^:a*/(:b|:c)+/a?"), "(^a*/(b|c)+/type?)");
  EXPECT_EQ(read_path("^(:a/:b)"), "^(a/b)");
  EXPECT_EQ(read_path("!:a"), "!a");
  EXPECT_EQ(read_path("!(:a|^:b|a)*"), "!a!type!^b*");
  EXPECT_EQ(read_path("!^:b"), "!^b");
}

TEST(SparqlParser, KeepsTriplesAroundFiltersInOneBlock) {
  const Query query = read("SELECT * { ?a :p ?b FILTER(?b > 1) ?b :q ?c OPTIONAL { ?c :r ?d } ?d :s ?e }");
  ASSERT_EQ(query.select.where.elements.size(), 4U);
  EXPECT_EQ(firstBlock(query).triples.size(), 2U);
  EXPECT_TRUE(std::holds_alternative<Filter>(query.select.where.elements[1].value));
  EXPECT_TRUE(std::holds_alternative<OptionalPattern>(query.select.where.elements[2].value));
}

TEST(SparqlParser, ListsTheVisibleVariablesOfSelectAll) {
  const Query query = read(
      "SELECT * { ?a :p [] . { SELECT (COUNT(?z) AS ?n) { ?z :q ?y } } MINUS { ?m :p ?a } "
      "FILTER EXISTS { ?e :p ?a } BIND(1 AS ?b) GRAPH ?g { } VALUES (?v) { (1) } } VALUES ?w { 2 }");
  std::vector<std::string> names;
  for (const Projection& column : query.select.projection) names.push_back(query.variables[column.variable].name);
  EXPECT_EQ(names, (std::vector<std::string>{"a", "n", "b", "g", "v", "w"}));
}

TEST(SparqlParser, MakesTemplatesWithBlankNodesAndPatternsWithHiddenVariables) {
  const Query query = read("CONSTRUCT WHERE { _:x :p ?y }");
  EXPECT_EQ(query.construct_template.at(0).subject.term(), Term::blank("x"));
  const VariableIndex hidden = firstBlock(query).triples.at(0).subject.variable();
  EXPECT_TRUE(query.variables[hidden].hidden);
}

TEST(SparqlParser, ReadsSolutionModifiers) {
  const Query query = read(
      "SELECT ?a (SUM(DISTINCT ?b) AS ?n) (?n * 2 AS ?m) { ?a :p ?b } GROUP BY ?a (?a + 1 AS ?c) "
      "HAVING (?n > 1) ORDER BY DESC(?n) ?a LIMIT 5 OFFSET 7");
  EXPECT_TRUE(query.select.grouped);
  EXPECT_EQ(query.select.modifiers.group_by.size(), 2U);
  EXPECT_EQ(query.select.modifiers.having.size(), 1U);
  EXPECT_TRUE(query.select.modifiers.order_by.at(0).descending);
  EXPECT_EQ(query.select.modifiers.limit, 5U);
  EXPECT_EQ(query.select.modifiers.offset, 7U);
  EXPECT_TRUE(query.select.projection.at(1).expression->distinct);
}

TEST(SparqlParser, ReadsEveryUpdateOperation) {
  const Update update = readUpdate(
      "LOAD SILENT :f INTO GRAPH :g ; CLEAR NAMED ; DROP SILENT ALL ; CREATE GRAPH :g ; ADD DEFAULT TO :g ; MOVE :g TO "
      ":h ;"
      "COPY SILENT GRAPH :h TO DEFAULT ; INSERT DATA { :a :p 1 GRAPH :g { _:b :p _:b } } ; DELETE DATA { :a :p 1 } ;"
      "DELETE WHERE { ?s :p ?o GRAPH ?g { } } ; WITH :g DELETE { ?s :p ?o } INSERT { _:n :q ?o } USING :u USING NAMED "
      ":v "
      "WHERE { ?s :p ?o } ;");
  ASSERT_EQ(update.operations.size(), 11U);
  EXPECT_EQ(std::get<Load>(update.operations[0].value).into->text, "http://example.org/g");
  EXPECT_EQ(std::get<Clear>(update.operations[1].value).target.kind, GraphTarget::Kind::Named);
  EXPECT_TRUE(std::get<Drop>(update.operations[2].value).silent);
  EXPECT_EQ(std::get<Transfer>(update.operations[5].value).kind, Transfer::Kind::Move);
  const auto& data = std::get<DataUpdate>(update.operations[7].value);
  EXPECT_EQ(data.quads.at(1).graph.text, "http://example.org/g");
  EXPECT_EQ(data.quads.at(1).subject, Term::blank("b"));
  EXPECT_EQ(std::get<Modify>(update.operations[9].value).where.elements.size(), 2U);
  const auto& modify = std::get<Modify>(update.operations[10].value);
  EXPECT_EQ(modify.with->text, "http://example.org/g");
  EXPECT_EQ(modify.insert.at(0).subject.term(), Term::blank("n"));
  EXPECT_EQ(modify.using_clause.named_graphs.at(0).text, "http://example.org/v");
}

TEST(SparqlParser, ReadsAnEmptyUpdate) {
  EXPECT_TRUE(readUpdate("PREFIX x: <http://x/> # nothing").operations.empty());
}

TEST(SparqlParser, CountsOffsetsInTheDecodedText) {
  const Query query = read("SELECT ?\\u0061 { ?a :p ?b }");
  EXPECT_EQ(query.text, "SELECT ?a { ?a :p ?b }");
  EXPECT_EQ(firstBlock(query).triples.at(0).subject.at, 12U);
}

}  // namespace
}  // namespace cluxel::sparql
