// SPDX-License-Identifier: Apache-2.0
// Lists the axioms by name: annotations such as owl:versionInfo are none.
#include "rdf/ontology/unused_axioms.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::array<std::string_view, 15> kProperties{"equivalentClass",
                                                       "equivalentProperty",
                                                       "propertyDisjointWith",
                                                       "disjointUnionOf",
                                                       "members",
                                                       "propertyChainAxiom",
                                                       "hasKey",
                                                       "sameAs",
                                                       "differentFrom",
                                                       "onProperty",
                                                       "intersectionOf",
                                                       "unionOf",
                                                       "complementOf",
                                                       "oneOf",
                                                       "onProperties"};
constexpr std::array<std::string_view, 5> kKindsOfProperties{"FunctionalProperty", "InverseFunctionalProperty",
                                                             "ReflexiveProperty", "IrreflexiveProperty",
                                                             "AsymmetricProperty"};

template <typename Names>
bool isAmong(const Names& names, const std::string& iri) {
  return iri.starts_with(vocabulary::kOwl) &&
         std::find(names.begin(), names.end(), std::string_view(iri).substr(vocabulary::kOwl.size())) != names.end();
}

}  // namespace

std::map<std::string, std::size_t> unusedAxioms(std::span<const RdfSource> sources) {
  std::map<std::string, std::size_t> counts;
  const auto count = [&](const std::string& iri) { ++counts["owl:" + iri.substr(vocabulary::kOwl.size())]; };
  for (const RdfSource& source : sources)
    parseRdf(source, [&](const Quad& quad) {
      if (isAmong(kProperties, quad.predicate.text)) count(quad.predicate.text);
      if (quad.predicate.text == vocabulary::rdf("type") && isAmong(kKindsOfProperties, quad.object.text))
        count(quad.object.text);
    });
  return counts;
}

}  // namespace cluxel::rdf
