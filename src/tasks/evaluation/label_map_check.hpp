// SPDX-License-Identifier: Apache-2.0
// Compares the classes of a label map with those of an ontology: a slip in a name would count right answers as wrong.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "rules/language/class_catalogue.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::tasks {

class LabelMapCheck {
 public:
  LabelMapCheck(const scan::LabelMap& labels, const rules::ClassCatalogue& catalogue, std::string file);

  /// As TruthSource::doubtfulClasses().
  std::vector<std::string> run();

 private:
  void checkCountsAs();
  void checkObject(const std::string& name);
  void checkNamesakes(const std::string& name);
  void checkPart(const std::string& part, const std::string& object);
  void add(const std::string& doubt);
  std::string nearestHint(const std::string& name) const;

  const scan::LabelMap& labels_;
  const rules::ClassCatalogue& catalogue_;
  std::string file_;
  std::map<std::string, std::string> iri_of_;  ///< by local name; without those of several
  rdf::ClassNames class_names_;
  std::vector<std::string> names_, doubts_;
};

}  // namespace cluxel::tasks
