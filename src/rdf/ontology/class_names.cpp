// SPDX-License-Identifier: Apache-2.0
// The class of the clx namespace has the first right to its local name.
#include "rdf/ontology/class_names.hpp"

#include <algorithm>

#include "rdf/iri.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

ClassNames::ClassNames(const std::vector<std::string>& iris) {
  for (const std::string& iri : iris) add(iri);
}

void ClassNames::add(const std::string& iri) {
  const auto [begin, end] = by_local_name_.equal_range(localName(iri));
  if (std::none_of(begin, end, [&](const auto& known) { return known.second == iri; }))
    by_local_name_.emplace(localName(iri), iri);
}

std::vector<std::string> ClassNames::withLocalName(std::string_view local) const {
  std::vector<std::string> iris;
  const auto [begin, end] = by_local_name_.equal_range(local);
  for (auto entry = begin; entry != end; ++entry) iris.push_back(entry->second);
  std::sort(iris.begin(), iris.end());
  return iris;
}

std::vector<std::string> ClassNames::meantBy(std::string_view local) const {
  std::vector<std::string> iris = withLocalName(local);
  const std::string own = vocabulary::clx(std::string(local));
  return std::find(iris.begin(), iris.end(), own) != iris.end() ? std::vector{own} : iris;
}

std::string ClassNames::nameOf(std::string_view iri) const {
  const std::string local = localName(iri);
  if (local.empty()) return std::string(iri);
  if (iri == vocabulary::clx(local)) return local;
  const std::vector<std::string> others = withLocalName(local);
  const bool is_only =
      std::all_of(others.begin(), others.end(), [&](const std::string& other) { return other == iri; });
  return is_only ? local : std::string(iri);
}

std::vector<std::string> ClassNames::all() const {
  std::vector<std::string> names;
  names.reserve(by_local_name_.size());
  for (const auto& [local, iri] : by_local_name_) names.push_back(nameOf(iri));
  std::sort(names.begin(), names.end());
  return names;
}

ClassNames classNamesOf(const QuadReader& reader, std::string_view graph) {
  return ClassNames(classIrisOf(reader, graph));
}

}  // namespace cluxel::rdf
