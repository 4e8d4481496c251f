// SPDX-License-Identifier: Apache-2.0
// Tests of the semantics of patterns: scopes, OPTIONAL, negation, graphs, sub-selects and groups, with cases in which
// other engines are known to be wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const char* const kPeople = R"(
  :a :name "Anna" ; :knows :b , :c ; :age 30 .
  :b :name "Bert" ; :knows :c .
  :c :age 20 ; :knows :a .
)";

TEST(Optionals, KeepSolutionsWithoutMatch) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?n { ?p :knows :c OPTIONAL { ?p :age ?n } }"),
              ElementsAre(":a \"30\"^^integer", ":b -"));
}

TEST(Optionals, SeeTheOuterVariablesInTheirOwnFilter) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?q { ?p :age ?x OPTIONAL { ?q :age ?y FILTER(?y > ?x) } }"),
              ElementsAre(":a -", ":c :a"));
}

TEST(Optionals, DoNotShowOuterVariablesToFiltersOfNestedGroups) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?q { ?p :age ?x OPTIONAL { { ?q :age ?y FILTER(?y > ?x) } } }"),
              ElementsAre(":a -", ":c -"));
}

TEST(Optionals, ThatAreNotWellDesignedAreComputedBottomUp) {
  // ?x is bound by the inner OPTIONAL before it is joined with the outer one.
  const SmallStore store(":a :p 1 . :b :p 2 . :c :q 2 .");
  EXPECT_THAT(store.rows("SELECT ?x ?y { ?x :p 1 OPTIONAL { ?y :p 2 OPTIONAL { ?x :p 2 } } }"), ElementsAre(":a -"));
}

TEST(Optionals, WithSharedUnboundVariablesJoinLikeTheSpecification) {
  const SmallStore store(":a :p :x . :b :p :y . :a :q 1 . :b :r 5 . :a :r 6 .");
  EXPECT_THAT(store.rows("SELECT ?s ?v { ?s :p ?o OPTIONAL { ?s :q ?v } OPTIONAL { ?s :r ?v } }"),
              ElementsAre(":a \"1\"^^integer", ":b \"5\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?s ?v { { ?s :p ?o OPTIONAL { ?s :q ?v } } { ?s :r ?v } }"),
              ElementsAre(":b \"5\"^^integer"));
}

TEST(Filters, HoldForTheWholeGroupWhereverTheyStand) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p { FILTER(?n > 25) ?p :age ?n }"), ElementsAre(":a"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n { FILTER(?n > 25) } }"), IsEmpty()) << "?n is not in that group";
  EXPECT_THAT(store.rows("SELECT ?p { ?p :knows :c { ?p :age ?n FILTER(BOUND(?p)) } }"), ElementsAre(":a"));
}

/// A variable of a preceding BIND is bound within EXISTS.
TEST(Binds, AreSeenByExistsInTheNextOne) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?e { BIND(:z AS ?x) BIND(EXISTS { ?p :knows ?x } AS ?e) }"),
              ElementsAre("\"false\"^^boolean"));
  EXPECT_THAT(store.rows("SELECT (:z AS ?x) (EXISTS { ?p :knows ?x } AS ?e) { }"),
              ElementsAre(":z \"false\"^^boolean"));
  EXPECT_THAT(store.rows("SELECT ?p ?e { ?p :age ?n BIND(?n - 10 AS ?m) BIND(EXISTS { ?q :age ?m } AS ?e) }"),
              ElementsAre(":a \"true\"^^boolean", ":c \"false\"^^boolean"));
}

TEST(Aggregates, CountDistinctSolutionsByTheirVariablesAlone) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT (COUNT(DISTINCT *) AS ?n) { ?p :knows [] }"), ElementsAre("\"3\"^^integer"));
  EXPECT_THAT(store.rows("SELECT (COUNT(*) AS ?n) { ?p :knows [] }"), ElementsAre("\"4\"^^integer"));
  EXPECT_THAT(store.rows("SELECT (COUNT(DISTINCT *) AS ?n) { ?p :knows/:knows ?q }"), ElementsAre("\"5\"^^integer"));
  EXPECT_THAT(store.rows("SELECT (COUNT(DISTINCT *) AS ?n) { [] :knows [] }"), ElementsAre("\"1\"^^integer"));
}

/// Regression test: planning these queries did not terminate.
TEST(Unions, OfFewSolutionsMayShareAVariableWithAllAroundThem) {
  SmallStore store(":a :r 1 .");
  store.load(":a :p 1 . :b :q 2 .", "http://example.org/g");
  EXPECT_THAT(store.rows("SELECT ?g ?s { GRAPH ?g { SELECT ?s { { ?s :p ?o } UNION { ?s :q ?o } } } }"),
              ElementsAre(":g :a", ":g :b"));
  EXPECT_THAT(store.rows("SELECT ?s { ?s :r ?v FILTER EXISTS { SELECT ?s { { ?s :p ?o } UNION { ?s :q ?o } } } }"),
              ElementsAre(":a"));
  const QuadReader reader = store.reader();
  PreparedQuery query(reader, kPrefixes + "SELECT ?s { { ?s :p ?o } UNION { ?s :q ?o } }", {}, {"o"});
  EXPECT_EQ(query.evaluate({{"o", Term::integer(2)}}).table.row_count, 1u);
  EXPECT_EQ(query.evaluate({{"o", Term::integer(3)}}).table.row_count, 0u);
}

TEST(Aggregates, SumsAreTooGreatAtTheEndOnlyWhateverTheOrder) {
  const SmallStore store;
  const auto sum = [&](const std::string& values) {
    return store.rows("SELECT (SUM(?v) AS ?s) { VALUES ?v { " + values + " } }").front();
  };
  EXPECT_EQ(sum("1e308 1e308 -1e308"), "\"1.0E308\"^^double");
  EXPECT_EQ(sum("1e308 -1e308 1e308"), "\"1.0E308\"^^double");
  EXPECT_EQ(sum("1e308 1e308 -1e308 -1e308 2.5"), "\"2.5E0\"^^double");
  EXPECT_EQ(sum("1e308 1e308"), "\"INF\"^^double");
  EXPECT_EQ(sum("-1e308 -1e308 1.0"), "\"-INF\"^^double");
}

TEST(Filters, OnAnIriBindItsVariable) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?q { ?p :knows ?q FILTER(?p = :a) }"), ElementsAre(":b", ":c"));
  EXPECT_THAT(store.rows("SELECT ?q { ?p :knows ?q FILTER(?p IN (:b, :c, :b)) }"), ElementsAre(":a", ":c"));
  EXPECT_THAT(store.rows("SELECT ?p ?q { OPTIONAL { ?p :none ?q } FILTER(?p = :a) }"), IsEmpty());
}

TEST(Negation, NotExistsSeesTheSolutionAndMinusDoesNot) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p { ?p :knows :c FILTER NOT EXISTS { ?p :age ?n } }"), ElementsAre(":b"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :knows :c MINUS { ?p :age ?n } }"), ElementsAre(":b"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n FILTER NOT EXISTS { ?q :age ?m FILTER(?m > ?n) } }"),
              ElementsAre(":a"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n MINUS { ?q :age ?m FILTER(?m > ?n) } }"), ElementsAre(":a", ":c"))
      << "?n is unbound there";
}

TEST(Negation, MinusWithoutSharedVariablesRemovesNothing) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n MINUS { ?x :knows ?y } }"), ElementsAre(":a", ":c"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n MINUS { :a :knows :b } }"), ElementsAre(":a", ":c"));
}

TEST(Negation, MinusComparesOnlyWhatIsBoundOnBothSides) {
  const SmallStore store(":a :p 1 . :b :p 2 . :a :q 3 .");
  EXPECT_THAT(store.rows("SELECT ?s { ?s :p ?v MINUS { ?s :p ?w OPTIONAL { ?s :q ?v } } }"), ElementsAre(":a"));
}

TEST(Negation, ExistsWithinExistsAndInsideExpressions) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p { ?p :knows ?q FILTER EXISTS { ?q :knows ?r FILTER NOT EXISTS { ?r :name ?n } } }"),
              ElementsAre(":a", ":c"));
  EXPECT_THAT(store.rows("SELECT ?p (EXISTS { ?p :age ?a } AS ?e) { ?p :name ?n }"),
              ElementsAre(":a \"true\"^^boolean", ":b \"false\"^^boolean"));
}

TEST(Negation, SubSelectsAndMinusWithinExistsSeeTheSolution) {
  const SmallStore store(":a :v 3 ; :n :x , :y . :b :v 1 ; :n :x . :x :w 2 . :y :w 5 .");
  // The sub-select projects ?v, so its filter sees the value; LIMIT applies to each solution separately.
  EXPECT_THAT(
      store.rows(
          "SELECT ?s { ?s :v ?v FILTER EXISTS { { SELECT ?s ?v { ?s :n ?x . ?x :w ?w FILTER(?w > ?v + 1) } } } }"),
      ElementsAre(":a"));
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { { SELECT ?s ?x { ?s :n ?x } ORDER BY ?x LIMIT 1 } } }"),
              ElementsAre(":a", ":b"));
  // A variable that a sub-select does not project is a different variable.
  EXPECT_THAT(
      store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { { SELECT ?s { ?s :n ?x . ?x :w ?w FILTER(?w > ?v) } } } }"),
      ElementsAre());
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { ?s :n ?x MINUS { ?x :w ?w FILTER(?w > ?v) } } }"),
              ElementsAre(":a"));
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER NOT EXISTS { ?s :n ?x MINUS { ?x :w ?w FILTER(?w > ?v) } } }"),
              ElementsAre(":b"));
}

TEST(Negation, PartsOfAnExistsThatStandAloneSeeTheSolutionButNotEachOther) {
  const SmallStore store(":a :v 3 ; :n :x . :b :v 1 ; :n :x . :x :w 2 .");
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { ?s :n ?x { ?x :w ?w FILTER(?w < ?v) } } }"),
              ElementsAre(":a"));
  // ?x of the outer group is not bound within the nested group, so the filter is an error there.
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { ?s :n ?x { ?y :w ?w FILTER(?x = ?y) } } }"),
              ElementsAre());
  EXPECT_THAT(store.rows("SELECT ?s { ?s :v ?v FILTER EXISTS { ?s :n ?x OPTIONAL { ?s :n ?z { ?z :w ?w FILTER(?v > 2) "
                         "} } FILTER(?w = 2) } }"),
              ElementsAre(":a"));
}

TEST(Binds, JoinWithTheirValueAndAreUnboundOnErrors) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?x { ?p :age ?n BIND(1 / (?n - 20) AS ?x) }"),
              ElementsAre(":a \"0.1\"^^decimal", ":c -"));
  EXPECT_THAT(store.rows("SELECT ?q { BIND(:a AS ?p) ?p :knows ?q }"), ElementsAre(":b", ":c"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n BIND(?n + 10 AS ?m) { ?q :age ?m } }"), ElementsAre(":c"));
}

TEST(Unions, KeepDuplicatesAndTheirOwnBindings) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p { { ?p :age ?n } UNION { ?p :name ?m } }"), ElementsAre(":a", ":a", ":b", ":c"));
  EXPECT_THAT(store.rows("SELECT ?p ?q { ?p :age ?n { ?p :knows ?q } UNION { BIND(:z AS ?q) } }"),
              ElementsAre(":a :b", ":a :c", ":a :z", ":c :a", ":c :z"));
}

TEST(Values, JoinWithUndefAsAnything) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?n { ?p :age ?n VALUES (?p ?n) { (:a UNDEF) (UNDEF 20) (:b 30) } }"),
              ElementsAre(":a \"30\"^^integer", ":c \"20\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p :age ?n } VALUES ?p { :a :a :nobody }"), ElementsAre(":a", ":a"));
}

TEST(SubSelects, HideWhatTheyDoNotProject) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT ?p ?n { { SELECT ?p { ?p :age ?n } } OPTIONAL { ?p :name ?n } }"),
              ElementsAre(":a \"Anna\"", ":c -"));
  EXPECT_THAT(store.rows("SELECT ?p ?oldest { { SELECT (MAX(?n) AS ?oldest) { ?x :age ?n } } ?p :age ?oldest }"),
              ElementsAre(":a \"30\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?p ?q { ?p :name ?n { SELECT ?q { ?q :age ?a } ORDER BY ?a LIMIT 1 } }"),
              ElementsAre(":a :c", ":b :c"));
}

TEST(Groups, OfNothingAreOneWithoutGroupByAndNoneWithIt) {
  const SmallStore store;
  EXPECT_THAT(store.rows("SELECT (COUNT(*) AS ?c) (SUM(?x) AS ?s) (AVG(?x) AS ?a) (MIN(?x) AS ?m) (GROUP_CONCAT(?x) AS "
                         "?g) (SAMPLE(?x) AS ?p) { ?x :p ?y }"),
              ElementsAre("\"0\"^^integer \"0\"^^integer \"0\"^^integer - \"\" -"));
  EXPECT_THAT(store.rows("SELECT ?x (COUNT(*) AS ?c) { ?x :p ?y } GROUP BY ?x"), IsEmpty());
}

TEST(Groups, TreatErrorsAsTheSpecificationSays) {
  const SmallStore store(":a :p 1 , 2 , \"x\" . :b :p 3 , 4.5 .");
  EXPECT_THAT(store.rows("SELECT ?s (SUM(?v) AS ?sum) (COUNT(?v) AS ?n) (MIN(?v) AS ?m) { ?s :p ?v } GROUP BY ?s"),
              ElementsAre(":a - \"3\"^^integer \"1\"^^integer", ":b \"7.5\"^^decimal \"2\"^^integer \"3\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?s (COUNT(?v + 1) AS ?n) { ?s :p ?v } GROUP BY ?s"),
              ElementsAre(":a \"2\"^^integer", ":b \"2\"^^integer"));
}

TEST(Groups, WithAnUnboundValueHaveNoMinimumMaximumOrConcatenationButACountAndASample) {
  const SmallStore store(":a :p 1 . :b :p 2 . :b :q 7 .");
  EXPECT_THAT(
      store.rows("SELECT (MIN(?w) AS ?l) (MAX(?w) AS ?m) (GROUP_CONCAT(?w) AS ?g) (COUNT(?w) AS ?n) (SAMPLE(?w) AS ?x) "
                 "{ ?s :p ?v OPTIONAL { ?s :q ?w } }"),
      ElementsAre("- - - \"1\"^^integer \"7\"^^integer"));
}

TEST(Groups, ByExpressionsWithHavingAndDistinct) {
  const SmallStore store(":a :p 1 . :b :p 1 . :c :p 2 . :d :q 9 .");
  EXPECT_THAT(store.rows("SELECT ?k (COUNT(*) AS ?n) { ?s :p ?v } GROUP BY (?v * 10 AS ?k) HAVING(COUNT(*) > 1)"),
              ElementsAre("\"10\"^^integer \"2\"^^integer"));
  EXPECT_THAT(
      store.rows("SELECT (COUNT(DISTINCT ?v) AS ?n) (SUM(DISTINCT ?v) AS ?t) (COUNT(DISTINCT *) AS ?r) { ?s :p ?v }"),
      ElementsAre("\"2\"^^integer \"3\"^^integer \"3\"^^integer"));
  EXPECT_THAT(store.rows("SELECT (GROUP_CONCAT(?v; SEPARATOR=\",\") AS ?all) { ?s :p ?v }"), ElementsAre("\"1,1,2\""));
}

TEST(Groups, OrderByAggregatesThatAreNotShown) {
  const SmallStore store(":a :p 1 . :b :p 5 , 6 . :c :p 2 , 3 , 4 .");
  EXPECT_THAT(store.ordered("SELECT ?s { ?s :p ?v } GROUP BY ?s ORDER BY DESC(COUNT(?v))"),
              ElementsAre(":c", ":b", ":a"));
}

TEST(Order, IsTotalOverAllKindsOfTerms) {
  const SmallStore store(
      ":s :p 2 , 1.5 , \"b\" , \"a\"@en , \"a\" , :iri , [] , true , \"2024-01-01T00:00:00Z\"^^xsd:dateTime , 1e0 .");
  EXPECT_THAT(store.ordered("SELECT ?v { { ?s :p ?v FILTER(!ISBLANK(?v)) } UNION { BIND(1/0 AS ?v) } } ORDER BY ?v"),
              ElementsAre("-", ":iri", "\"1e0\"^^double", "\"1.5\"^^decimal", "\"2\"^^integer", "\"a\"", "\"b\"",
                          "\"a\"@en", "\"true\"^^boolean", "\"2024-01-01T00:00:00Z\"^^dateTime"));
}

TEST(Order, WithLimitIsTheHeadOfTheWholeOrder) {
  SmallStore store;
  std::vector<Quad> quads;
  for (int i = 0; i < 9000; ++i) {
    quads.push_back({Term::iri("http://example.org/s" + std::to_string(i)), Term::iri("http://example.org/p"),
                     Term::integer(i * 7919 % 1000), Term::iri("")});
  }
  store.load(quads);
  const auto all = store.ordered("SELECT ?s ?v { ?s :p ?v } ORDER BY DESC(?v)");
  const auto head = store.ordered("SELECT ?s ?v { ?s :p ?v } ORDER BY DESC(?v) LIMIT 25 OFFSET 10");
  EXPECT_EQ(head, std::vector<std::string>(all.begin() + 10, all.begin() + 35));
}

TEST(Distinct, AndSliceCountProjectedRows) {
  const SmallStore store(kPeople);
  EXPECT_THAT(store.rows("SELECT DISTINCT ?p { ?p ?x ?y }"), ElementsAre(":a", ":b", ":c"));
  EXPECT_THAT(store.ordered("SELECT DISTINCT ?p { ?p ?x ?y } ORDER BY DESC(?p) LIMIT 1 OFFSET 1"), ElementsAre(":b"));
  EXPECT_THAT(store.rows("SELECT ?p { ?p ?x ?y } LIMIT 0"), IsEmpty());
}

TEST(Patterns, WithARepeatedVariableMatchEqualTermsOnly) {
  const SmallStore store(":a :p :a . :a :p :b . :p :p :p .");
  EXPECT_THAT(store.rows("SELECT ?x { ?x :p ?x }"), ElementsAre(":a", ":p"));
  EXPECT_THAT(store.rows("SELECT ?x { ?x ?x ?x }"), ElementsAre(":p"));
  EXPECT_THAT(store.rows("SELECT ?x { ?x :p :b . ?x :p ?x }"), ElementsAre(":a"));
}

TEST(Constructs, InstantiateTemplatesOnceAndSkipWhatIsNoTriple) {
  const SmallStore store(kPeople);
  const QueryResult result = store.ask("CONSTRUCT { ?p :is [ :of ?n ] . ?n :bad ?p . :all :same :all } { ?p :age ?n }");
  EXPECT_EQ(result.graph.size(), 5u);
}

TEST(Describes, GoThroughBlankNodes) {
  const SmallStore store(":a :p [ :q [ :r 1 ] ] ; :s :b . :b :t 2 .");
  EXPECT_EQ(store.ask("DESCRIBE :a").graph.size(), 4u);
  EXPECT_EQ(store.ask("DESCRIBE ?x { ?x :t 2 }").graph.size(), 1u);
}

}  // namespace
}  // namespace cluxel::test
