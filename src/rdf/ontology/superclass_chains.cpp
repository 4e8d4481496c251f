// SPDX-License-Identifier: Apache-2.0
// Takes the classes from the top down: one is taken when all its superclasses are.
#include "rdf/ontology/superclass_chains.hpp"

#include <algorithm>

namespace cluxel::rdf {

SuperclassChains::SuperclassChains(const std::map<std::string, std::set<std::string>>& above) {
  std::map<std::string, std::vector<std::string>> below;
  std::map<std::string, std::size_t> missing;  // superclasses that are not taken yet
  for (const auto& [iri, supers] : above) {
    missing[iri] += supers.size();
    for (const std::string& super : supers) {
      below[super].push_back(iri);
      missing.try_emplace(super, 0);
    }
  }
  std::map<std::string, Place> candidates;
  std::vector<std::string> open;
  for (const auto& [iri, count] : missing)
    if (count == 0) open.push_back(iri);
  while (!open.empty()) {
    const std::string super = std::move(open.back());
    open.pop_back();
    const std::size_t depth = below_top_[super].depth + 1;
    for (const std::string& iri : below[super]) {
      Place& place = candidates[iri];
      if (depth > place.depth) place = {depth, super};
      if (--missing[iri] > 0) continue;
      below_top_[iri] = place;
      open.push_back(iri);
    }
  }
}

std::vector<std::string> SuperclassChains::longest() const {
  const auto lowest = std::max_element(below_top_.begin(), below_top_.end(),
                                       [](const auto& a, const auto& b) { return a.second.depth < b.second.depth; });
  std::vector<std::string> chain;
  if (lowest == below_top_.end()) return chain;
  for (std::string iri = lowest->first; !iri.empty(); iri = below_top_.at(iri).next) chain.push_back(iri);
  return chain;
}

}  // namespace cluxel::rdf
