// SPDX-License-Identifier: Apache-2.0
// How deep the classes of an ontology lie below each other, and which may lie in a cycle.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace cluxel::rdf {

/// Cost: linear in the statements.
class SuperclassChains {
 public:
  /// `above`: the direct superclasses of each class.
  explicit SuperclassChains(const std::map<std::string, std::set<std::string>>& above);

  /// False for a class that lies in a cycle of superclasses or below one.
  bool isClear(const std::string& iri) const { return below_top_.contains(iri); }
  /// The longest chain, the lowest class first, among classes for which isClear() holds.
  std::vector<std::string> longest() const;

 private:
  struct Place {
    std::size_t depth = 0;  ///< number of superclasses in the longest chain above
    std::string next;       ///< the first of these; "" when there is none
  };
  std::map<std::string, Place> below_top_;
};

}  // namespace cluxel::rdf
