// SPDX-License-Identifier: Apache-2.0
// A name is looked up as an IRI, with its prefix, as a local name, as a label, and as a local name whatever its case,
// in this order.
#include "tasks/named_class.hpp"

#include <algorithm>
#include <vector>

#include "base/ascii.hpp"
#include "base/content_hash.hpp"
#include "base/nearest_name.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/statements/stated_values.hpp"
#include "rdf/iri.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/language/rule_set.hpp"
#include "tasks/objects_of_class.hpp"

namespace cluxel::tasks {

namespace {

class ClassLookup {
 public:
  ClassLookup(const rdf::OntologyView& ontology, const std::function<Namespaces()>& namespaces)
      : ontology_(ontology), namespaces_(namespaces), names_(ontology.classNames()) {}

  std::vector<std::string> find(const std::string& name) const {
    if (ontology_.find(name) != nullptr) return {name};
    if (auto found = prefixed(name); !found.empty()) return found;
    if (auto found = names_.meantBy(name); !found.empty() && !name.empty()) return found;
    return labelled(name);
  }

  std::string hintFor(const std::string& name) const {
    const std::string local = name.starts_with("clx:") ? name.substr(4) : name;
    return suggestion(local, names_.all());
  }

 private:
  std::vector<std::string> prefixed(const std::string& name) const {
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos || name.substr(colon).starts_with("://")) return {};
    const std::string prefix = name.substr(0, colon), local = name.substr(colon + 1);
    Namespaces spaces;
    if (prefix == "clx")
      spaces.emplace(prefix, rdf::vocabulary::kClx);
    else if (namespaces_)
      spaces = namespaces_();
    std::vector<std::string> found;
    const auto [begin, end] = spaces.equal_range(prefix);
    for (auto space = begin; space != end; ++space)
      if (const std::string iri = space->second + local; ontology_.find(iri) != nullptr) found.push_back(iri);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// By a label in any language as it is written, else by one whatever its case, else by the local name whatever its
  /// case, to which the class of the clx namespace has the first right.
  std::vector<std::string> labelled(const std::string& name) const {
    const std::string words = rdf::plainWords(name), composed = rdf::composedWords(name);
    if (words.empty()) return {};
    const auto withLabel = [&](const auto& is_meant) {
      return classesWhere([&](const rdf::OntologyClass& known) {
        return std::any_of(known.labels.begin(), known.labels.end(),
                           [&](const rdf::ClassLabel& label) { return is_meant(label); });
      });
    };
    if (auto found = withLabel([&](const auto& label) { return rdf::composedWords(label.text) == composed; });
        !found.empty())
      return found;
    if (auto found = withLabel([&](const auto& label) { return rdf::isCalled(label, name); }); !found.empty())
      return found;
    std::vector<std::string> found = classesWhere(
        [&](const rdf::OntologyClass& known) { return rdf::plainWords(rdf::localName(known.iri)) == words; });
    const auto own = [](const std::string& iri) { return iri.starts_with(rdf::vocabulary::kClx); };
    if (std::any_of(found.begin(), found.end(), own))
      std::erase_if(found, [&](const std::string& iri) { return !own(iri); });
    return found;
  }

  template <typename Condition>
  std::vector<std::string> classesWhere(const Condition& is_meant) const {
    std::vector<std::string> found;
    for (const rdf::OntologyClass& known : ontology_.classes)
      if (is_meant(known)) found.push_back(known.iri);
    return found;
  }

  const rdf::OntologyView& ontology_;
  const std::function<Namespaces()>& namespaces_;
  rdf::ClassNames names_;
};

[[noreturn]] void failForSeveral(const std::string& name, const std::vector<std::string>& iris) {
  std::string list;
  for (const std::string& iri : iris) list += (list.empty() ? "<" : ", <") + iri + ">";
  throw Error(ErrorKind::NotFound, "'" + name + "' names " + std::to_string(iris.size()) +
                                       " classes of the map's ontology: " + list + "; write the IRI of one of them");
}

}  // namespace

std::string distinctName(const std::string& class_iri) {
  const std::string local = rdf::localName(class_iri);
  if (class_iri == rdf::vocabulary::clx(local)) return local;
  return local + "-" + ContentHasher().addText(class_iri).finish().hex().substr(0, 8);
}

std::string classNamed(const rdf::OntologyView& ontology, const std::string& written,
                       const std::function<Namespaces()>& namespaces) {
  std::string name(trimmed(written));
  if (name.starts_with('<') && name.ends_with('>')) name = name.substr(1, name.size() - 2);
  const ClassLookup lookup(ontology, namespaces);
  const std::vector<std::string> found = lookup.find(name);
  if (found.size() == 1) return found.front();
  if (!found.empty()) failForSeveral(name, found);
  const std::string hint = lookup.hintFor(name);
  throw Error(ErrorKind::NotFound,
              "the map's ontology has no class '" + name + "'" + (hint.empty() ? "" : "; " + hint));
}

std::string classNamed(const mapping::MapReader& map, const rdf::OntologyView& ontology, const std::string& written) {
  return classNamed(ontology, written, [&] { return namespacesOf(map.inputs()); });
}

std::string classNamed(const mapping::MapReader& map, const std::string& written) {
  return classNamed(map, ontologyViewOf(map.quads()), written);
}

std::optional<rdf::Mobility> mobilityNamed(const rdf::OntologyView& ontology, const std::string& written) {
  const bool is_label =
      std::any_of(ontology.classes.begin(), ontology.classes.end(), [&](const rdf::OntologyClass& known) {
        return std::any_of(known.labels.begin(), known.labels.end(),
                           [&](const rdf::ClassLabel& label) { return rdf::isCalled(label, written); });
      });
  for (const auto& [local, mobility] :
       {std::pair("Movable", rdf::Mobility::Movable), std::pair("Static", rdf::Mobility::Static)}) {
    const std::string iri = rdf::vocabulary::clx(local);
    if (written == iri || written == "<" + iri + ">" || written == std::string("clx:") + local ||
        (!is_label && rdf::plainWords(written) == rdf::plainWords(local)))
      return mobility;
  }
  return std::nullopt;
}

void requireClassOfObjects(const rdf::OntologyView& ontology, const std::string& class_iri) {
  const std::string object = rdf::vocabulary::clx("Object");
  const auto isOfObjects = [&](const rdf::OntologyClass& known) {
    return ontology.isA(known.iri, object) && ontology.isA(known.iri, class_iri);
  };
  if (std::none_of(ontology.classes.begin(), ontology.classes.end(), isOfObjects))
    throw Error(ErrorKind::InvalidArgument, mapping::noClassOfObjects(class_iri) +
                                                "; name one such as clx:Tree, or ask for what has it by a query");
}

void requireClassOfObjects(const mapping::MapReader& map, const rdf::OntologyView& ontology,
                           const std::string& class_iri) {
  if (!hasObjectOfClass(map, class_iri)) requireClassOfObjects(ontology, class_iri);
}

Namespaces namespacesOf(const mapping::MapInputs& inputs) {
  Namespaces spaces;
  for (const auto& [prefix, space] : mapping::parseInputs(inputs).rules.prefixes) spaces.emplace(prefix, space);
  for (const rdf::RdfSource& source : mapping::ontologySources(inputs.ontology))
    for (const auto& [prefix, space] : rdf::prefixesIn(source)) spaces.emplace(prefix, space);
  return spaces;
}

}  // namespace cluxel::tasks
