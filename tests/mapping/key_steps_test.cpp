// SPDX-License-Identifier: Apache-2.0
// Patterns lead to the key when each solution has a triple for them.
#include "mapping/inference/key_steps.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace cluxel::mapping {

namespace {

/// The steps from each variable: "?p 0> ?a" is one by pattern 0 from its subject to its object, "?p 1< ?a" one by
/// pattern 1 the other way. The key is the subject of the first pattern.
std::string keySteps(const std::string& where) {
  const RuleShape shape =
      shapeOf({"a.rq", "PREFIX : <https://example.org/> CONSTRUCT { ?a :made ?a } WHERE { " + where + " }"});
  EXPECT_EQ(shape.following, RuleShape::Following::ByKey) << shape.reason;
  const auto name_of = [&](ast::VariableIndex variable) { return "?" + shape.query.variables[variable].name; };
  std::set<std::string> found;
  for (const auto& [variable, steps] : stepsToKey(shape))
    for (const KeyStep& step : steps)
      found.insert(name_of(variable) + " " + std::to_string(step.read) + (step.to_subject ? "< " : "> ") +
                   name_of(step.to) + "\n");
  std::string all;
  for (const std::string& line : found) all += line;
  return all;
}

TEST(KeySteps, FollowPatternsInBothDirections) {
  EXPECT_EQ(keySteps("?a :part ?b . ?c :of ?b . ?c :on ?d"), "?b 0< ?a\n?c 1> ?b\n?d 2< ?c\n");
  EXPECT_EQ(keySteps("?a :part/:wall ?c"), "?_:step2 0< ?a\n?c 1< ?_:step2\n") << "the steps of a path of fixed length";
  EXPECT_EQ(keySteps("{ SELECT ?a { ?a :part ?b . ?b :on ?c } GROUP BY ?a }"), "?b 0< ?a\n?c 1< ?b\n");
}

TEST(KeySteps, GoThroughAUnionByAllOfItsBranches) {
  EXPECT_EQ(keySteps("?a :is :that . { ?a :near ?p } UNION { ?p :part ?a } ?p :at ?x"),
            "?p 1< ?a\n?p 2> ?a\n?x 3< ?p\n");
  EXPECT_EQ(keySteps("?a :is :that . { ?a :near ?p } UNION { ?p :is :this } ?p :at ?x"), "");
}

TEST(KeySteps, LeadToAVariableOfAKnownTypeWhereNoneLeadToTheKey) {
  EXPECT_EQ(keySteps("?a :at ?x . ?b :is :that ; :at/:is ?y . ?c :at ?y"),
            "?_:step5 2< ?b\n?c 4> ?y\n?x 0< ?a\n?y 3< ?_:step5\n");
}

TEST(KeySteps, LeaveOutWhatSolutionsMayLackOrRepeat) {
  EXPECT_EQ(keySteps("?a :is :that OPTIONAL { ?a :near ?b }"), "");
  EXPECT_EQ(keySteps("?a :is :that FILTER NOT EXISTS { ?a :near ?b }"), "");
  EXPECT_EQ(keySteps("?a :near+ ?b . ?b :at ?c"), "") << "a path of any length";
  EXPECT_EQ(keySteps("?a :near ?b . ?b :near ?a . ?b :near ?b"), "?b 0< ?a\n");
}

}  // namespace
}  // namespace cluxel::mapping
