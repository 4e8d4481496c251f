// SPDX-License-Identifier: Apache-2.0
// The classes that a rule can give are those that it names for them; whether there are others is told.
#include "tasks/rule_classes.hpp"

#include <gtest/gtest.h>

namespace cluxel::tasks {
namespace {

using Names = std::set<std::string>;

constexpr const char* kA = "http://e.org/A";
constexpr const char* kB = "http://e.org/B";

GivenClasses givenBy(const std::string& rule) {
  return classesGivenBy({"own.rq", "PREFIX : <http://e.org/> PREFIX o: <http://other.org/> " + rule});
}

void expectGiven(const std::string& rule, const Names& named, bool is_open) {
  const GivenClasses given = givenBy(rule);
  EXPECT_EQ(given.named, named) << rule;
  EXPECT_EQ(given.is_open, is_open) << rule;
}

TEST(RuleClasses, AreNamedInTheTemplate) {
  expectGiven("CONSTRUCT { ?x a :A ; :is :B } WHERE { ?x a o:A }", {kA}, false);
  expectGiven("CONSTRUCT { ?x :is :B } WHERE { ?x a :A }", {}, false);
  expectGiven("CONSTRUCT { ?x ?p :A } WHERE { ?x :p ?p }", {}, true);
}

TEST(RuleClasses, AreThoseThatAVariableCanBe) {
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x a o:A ; :h ?h BIND(IF(?h > 1, :A, IF(?h > 0, :B, 0)) AS ?k) } # :C",
              {kA, kB}, false);
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x a o:A BIND(:A AS ?l) BIND(COALESCE(?l, :B) AS ?k) }", {kA, kB}, false);
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x :kind ?k VALUES ?k { :A :B } }", {kA, kB}, false);
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { { ?x :h 1 BIND(:A AS ?k) } UNION { ?x :h 2 BIND(:B AS ?k) } }", {kA, kB},
              false);
}

TEST(RuleClasses, AreOpenWhereTheMapTellsThem) {
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x :kind ?k }", {}, true);
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x :kind ?o BIND(IF(isIRI(?o), ?o, :A) AS ?k) }", {kA}, true);
  expectGiven("CONSTRUCT { ?x a ?k } WHERE { ?x :kind ?t BIND(IRI(CONCAT('http://e.org/', ?t)) AS ?k) }", {}, true);
}

}  // namespace
}  // namespace cluxel::tasks
