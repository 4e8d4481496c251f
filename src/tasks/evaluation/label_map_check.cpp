// SPDX-License-Identifier: Apache-2.0
// Each doubt is told once, however many labels have it.
#include "tasks/evaluation/label_map_check.hpp"

#include <algorithm>

#include "base/nearest_name.hpp"
#include "rdf/iri.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

LabelMapCheck::LabelMapCheck(const scan::LabelMap& labels, const rules::ClassCatalogue& catalogue, std::string file)
    : labels_(labels), catalogue_(catalogue), file_(std::move(file)) {
  class_names_ = namesOf(catalogue);
  for (const rules::ClassEntry& entry : catalogue.classes)
    if (class_names_.meantBy(rdf::localName(entry.iri)).size() == 1)
      iri_of_.emplace(rdf::localName(entry.iri), class_names_.meantBy(rdf::localName(entry.iri)).front());
  for (const auto& [name, iri] : iri_of_) names_.push_back(name);
}

std::vector<std::string> LabelMapCheck::run() {
  checkCountsAs();
  for (const auto& [id, meaning] : labels_.entries()) {
    if (meaning.object_class) checkObject(*meaning.object_class);
    if (meaning.near) checkObject(meaning.near->object_class);
    if (meaning.part && meaning.object_class) checkPart(*meaning.part, *meaning.object_class);
  }
  return std::move(doubts_);
}

/// One label map serves maps with different ontologies: a class that one of them lacks may be right for another.
void LabelMapCheck::checkCountsAs() {
  for (const auto& [name, target] : labels_.countsAs()) {
    checkNamesakes(name);
    if (!class_names_.withLocalName(name).empty()) continue;
    const std::string hint = nearestHint(name);
    add("counts_as: the ontology of the map has no class '" + name + "', so no answer is of it" +
        (hint.empty() ? "" : "; ") + hint);
  }
}

/// A truth may have classes of its own (StaticOrPlant); answers reach them by counts_as alone.
void LabelMapCheck::checkObject(const std::string& name) {
  checkNamesakes(name);
  const auto known = iri_of_.find(name);
  if (known != iri_of_.end()) {
    if (!catalogue_.isA(known->second, rdf::vocabulary::clx("Object")))
      add("'object: " + name + "' is no class of objects in the ontology of the map, so no answer is of it");
    return;
  }
  const auto& counts_as = labels_.countsAs();
  const bool is_reached =
      std::any_of(counts_as.begin(), counts_as.end(), [&](const auto& entry) { return entry.second == name; });
  const std::string hint = nearestHint(name);
  if (!is_reached && class_names_.withLocalName(name).empty())
    add("the ontology of the map has no class '" + name + "', so no answer is of it" + (hint.empty() ? "" : "; ") +
        hint);
}

/// Label maps have local names alone, which mean one class.
void LabelMapCheck::checkNamesakes(const std::string& name) {
  const std::vector<std::string> namesakes = class_names_.withLocalName(name), meant = class_names_.meantBy(name);
  if (namesakes.size() < 2) return;
  std::string others;
  for (const std::string& iri : namesakes)
    if (meant.size() > 1 || iri != meant.front()) others += (others.empty() ? "<" : ", <") + iri + ">";
  if (meant.size() > 1)
    add("'" + name + "' is the local name of several classes in the ontology of the map: " + others +
        "; no answer is of it, and each counts as its superclass");
  else
    add("'" + name + "' means <" + meant.front() + "> alone; answers of " + others + " count as their superclass");
}

void LabelMapCheck::checkPart(const std::string& part, const std::string& object) {
  const auto known = iri_of_.find(object);
  if (known == iri_of_.end()) return;
  std::vector<std::string> parts;
  for (const std::string& iri : catalogue_.partsOf(known->second)) parts.push_back(rdf::localName(iri));
  if (std::find(parts.begin(), parts.end(), part) != parts.end()) return;
  const std::string hint = suggestion(part, parts);
  add("'part: " + part + "' is no part of " + object + " in the ontology of the map" + (hint.empty() ? "" : "; ") +
      hint);
}

void LabelMapCheck::add(const std::string& doubt) {
  const std::string text = file_ + ": " + doubt;
  if (std::find(doubts_.begin(), doubts_.end(), text) == doubts_.end()) doubts_.push_back(text);
}

std::string LabelMapCheck::nearestHint(const std::string& name) const {
  const auto near = nearestName(name, names_);
  return near ? "did you mean '" + *near + "'?" : "";
}

}  // namespace cluxel::tasks
