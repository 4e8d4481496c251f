// SPDX-License-Identifier: Apache-2.0
// Short names of classes that tell them apart: two vocabularies may both have a class Tree.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace cluxel::rdf {

class QuadReader;

class ClassNames {
 public:
  ClassNames() = default;
  explicit ClassNames(const std::vector<std::string>& iris);

  void add(const std::string& iri);
  /// The classes that have a local name, sorted.
  std::vector<std::string> withLocalName(std::string_view local) const;
  /// The classes that a local name may mean: that of the clx namespace alone, else all that have it. A name is clear
  /// when there is one.
  std::vector<std::string> meantBy(std::string_view local) const;
  /// The local name when it means this class, else the IRI: for lists and counts. A class that was not added gets the
  /// name that it would have.
  std::string nameOf(std::string_view iri) const;
  /// nameOf() of all, sorted: for "did you mean".
  std::vector<std::string> all() const;

 private:
  std::multimap<std::string, std::string, std::less<>> by_local_name_;
};

/// The classes that a graph declares, by default the ontology graph.
ClassNames classNamesOf(const QuadReader& reader, std::string_view graph = "");

}  // namespace cluxel::rdf
