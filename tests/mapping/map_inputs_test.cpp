// SPDX-License-Identifier: Apache-2.0
// What people are told of the files that a map was built from.
#include "mapping/map_inputs.hpp"

#include <gtest/gtest.h>

namespace cluxel::mapping {
namespace {

TEST(DescribedInputs, AreShortWithinTheDataHomeAndWholeElsewhere) {
  MapInputs inputs;
  inputs.ontology = {{"/home/ontology/core.ttl", ""}};
  inputs.rules = {{"/elsewhere/my.rules.yaml", ""}, {"/home/rules/outdoor.rules.yaml", ""}};
  inputs.model.name = "/home/models/oakland/model.json";
  EXPECT_EQ(describeFiles(inputs),
            "data home unknown; ontology /home/ontology/core.ttl; rules /elsewhere/my.rules.yaml, "
            "/home/rules/outdoor.rules.yaml; SPARQL rules none; model /home/models/oakland/model.json");
  inputs.home = "/home";
  EXPECT_EQ(describeFiles(inputs),
            "data home /home; ontology ontology/core.ttl; rules /elsewhere/my.rules.yaml, rules/outdoor.rules.yaml; "
            "SPARQL rules none; model models/oakland/model.json");
}

}  // namespace
}  // namespace cluxel::mapping
