// SPDX-License-Identifier: Apache-2.0
// Writes the candidates that rules propose in maps with truth as lines of JSON: rule, truth, evidence and attributes.
// Usage: candidate_table RULES TRUTH MAP...
#include <cstdio>
#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "mapping/map_inputs.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/rule_fitting/candidate_examples.hpp"

int main(int argc, char** argv) {
  using namespace cluxel;
  if (argc < 4) {
    std::fprintf(stderr, "usage: candidate_table RULES TRUTH MAP...\n");
    return 2;
  }
  try {
    const auto truth = tasks::TruthSource::open(argv[2], DataHome::find());
    for (int i = 3; i < argc; ++i) {
      const mapping::MapReader map(argv[i]);
      const auto rules =
          rules::loadRules(std::vector{std::filesystem::path(argv[1])}, classCatalogueOf(map.inputs().ontology))
              .require();
      for (const tasks::CandidateExample& example : candidateExamples(map, rules, truth, true)) {
        nlohmann::ordered_json json{{"rule", example.rule_id},
                                    {"leaf", example.leaf},
                                    {"map", argv[i]},
                                    {"place", example.place},
                                    {"right", example.is_right},
                                    {"truth", example.truth_class},
                                    {"points", example.points},
                                    {"confidence", example.confidence},
                                    {"log_odds", example.log_odds}};
        for (const auto& [name, value] : example.attributes) json["attributes"][name] = value;
        std::printf("%s\n", json.dump().c_str());
      }
    }
  } catch (const Error& fault) {
    std::fprintf(stderr, "candidate_table: %s\n", fault.what());
    return 1;
  }
}
