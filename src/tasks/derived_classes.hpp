// SPDX-License-Identifier: Apache-2.0
// What SPARQL rules say that an object is, beside its class.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rdf/store/quad_store.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::tasks {

/// A class and the rule file that derived it: "35_fences.rq". What follows from it by the ontology is not named.
struct DerivedClass {
  std::string class_iri, file;
  auto operator<=>(const DerivedClass&) const = default;
};

/// By class, then by file. Cost: that of what rules derived about the thing.
std::vector<DerivedClass> derivedClassesOf(const rdf::QuadReader& quads, const std::string& thing_iri);

/// "also clx:Fence, by SPARQL rule 35_fences.rq", one a line. Sets "derived" in `json` to the same when there are some.
std::string derivedClassesText(const mapping::MapReader& map, const rules::RuleSet& rules, const ContentHash& object,
                               nlohmann::ordered_json& json);

/// What SPARQL rules have to do with the class, about which `explain` is asked why an object is not of it: that one
/// derives it, that statements rule it out, or the files of those that can give it or a class below it, or that compute
/// the class. Empty when there is nothing to tell. Sets "is_of_class", "ruled_out_by" (ids of statements) and
/// "sparql_rules" in `json`. `object`: none for what is no object; of it there is nothing to tell.
std::string sparqlRulesText(const mapping::MapReader& map, const rules::RuleSet& rules,
                            const mapping::MapInputs& inputs, const std::optional<ContentHash>& object,
                            const std::string& class_iri, nlohmann::ordered_json& json);

}  // namespace cluxel::tasks
