// SPDX-License-Identifier: Apache-2.0
// Searches the superclasses breadth-first.
#include "tasks/evaluation/truth_class.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace cluxel::tasks {

namespace {

std::size_t numberOf(const std::string& iri, const TruthClasses& truth, const rdf::ClassNames& names) {
  std::string name = names.nameOf(iri);
  if (const auto other = truth.counts_as.find(name); other != truth.counts_as.end()) name = other->second;
  return static_cast<std::size_t>(std::find(truth.names.begin(), truth.names.end(), name) - truth.names.begin());
}

std::size_t nearestNumber(const std::string& iri, const TruthClasses& truth, const rules::ClassCatalogue& catalogue,
                          const rdf::ClassNames& names) {
  std::set<std::string> seen{iri};
  std::vector<std::string> level{iri};
  while (!level.empty()) {
    std::size_t best = truth.names.size();
    std::vector<std::string> above;
    for (const std::string& name : level) {
      best = std::min(best, numberOf(name, truth, names));
      const rules::ClassEntry* entry = catalogue.find(name);
      if (entry == nullptr) continue;
      for (const std::string& superclass : entry->superclasses)
        if (seen.insert(superclass).second) above.push_back(superclass);
    }
    if (best < truth.names.size()) return best;
    level = std::move(above);
  }
  return truth.names.size();
}

}  // namespace

std::vector<std::size_t> truthClassesOf(const std::vector<rules::SemanticObject>& objects, const TruthClasses& truth,
                                        const rules::ClassCatalogue& catalogue) {
  const rdf::ClassNames names = namesOf(catalogue);
  std::map<std::string, std::size_t> known;
  std::vector<std::size_t> numbers;
  numbers.reserve(objects.size());
  for (const rules::SemanticObject& object : objects) {
    const auto [entry, is_new] = known.try_emplace(object.class_iri, truth.names.size());
    if (is_new) entry->second = nearestNumber(object.class_iri, truth, catalogue, names);
    numbers.push_back(entry->second);
  }
  return numbers;
}

}  // namespace cluxel::tasks
