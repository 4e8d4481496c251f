// SPDX-License-Identifier: Apache-2.0
// Reads the statements as facts: their outcomes are facts, too, when inference begins.
#include "mapping/statements/excluded_types.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <string>

#include "mapping/statements/applied_statements.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

using rdf::TermId;
using rdf::vocabulary::clx;

class Exclusions {
 public:
  explicit Exclusions(const rdf::QuadReader& reader)
      : reader_(reader),
        operator_(idOf(std::string(rdf::vocabulary::kGraphOperator))),
        observed_(idOf(std::string(rdf::vocabulary::kGraphObserved))),
        ontology_(idOf(std::string(rdf::vocabulary::kGraphOntology))),
        history_(idOf(std::string(rdf::vocabulary::kGraphHistory))),
        type_(idOf(rdf::vocabulary::rdf("type"))),
        sub_class_(idOf(rdf::vocabulary::rdfs("subClassOf"))),
        disjoint_(idOf(std::string(rdf::vocabulary::kOwl) + "disjointWith")) {}

  std::vector<rdf::Triple> all() {
    const auto stated_class = idOf(clx("statedClass"));
    if (!operator_ || !observed_ || !type_ || !stated_class) return {};
    const auto kind = idOf(clx("statementKind")), effect = idOf(clx("statementEffect")), about = idOf(clx("appliesTo"));
    forEach({.s = {}, .p = stated_class, .o = {}, .g = operator_}, [&](const rdf::QuadIds& stated) {
      if (textOf(stated.s, effect, observed_) != nameOf(StatementEffect::Applied)) return;
      const std::string written = textOf(stated.s, kind, operator_);
      std::set<TermId> classes;
      if (written == "is not") addWithSubclasses(stated.o, classes);
      if (written == "is") addDisjoint(stated.o, classes);
      if (about && !classes.empty())
        forEach({.s = stated.s, .p = about, .o = {}, .g = observed_}, [&](const rdf::QuadIds& applied) {
          for (const TermId excluded : classes) excluded_.push_back({applied.o, *type_, excluded});
        });
    });
    std::sort(excluded_.begin(), excluded_.end());
    excluded_.erase(std::unique(excluded_.begin(), excluded_.end()), excluded_.end());
    return std::move(excluded_);
  }

 private:
  std::optional<TermId> idOf(const std::string& iri) const { return reader_.idOf(Term::iri(iri)); }

  template <typename Visit>
  void forEach(const rdf::QuadPattern& pattern, const Visit& visit) const {
    rdf::QuadCursor cursor = reader_.scan(pattern);
    for (rdf::QuadIds quad; cursor.next(quad);)
      if (!history_ || quad.g != *history_) visit(quad);
  }

  std::string textOf(TermId subject, std::optional<TermId> property, std::optional<TermId> graph) const {
    std::string text;
    if (property)
      forEach({.s = subject, .p = property, .o = {}, .g = graph},
              [&](const rdf::QuadIds& quad) { text = reader_.termOf(quad.o).text; });
    return text;
  }

  void addWithSubclasses(TermId class_id, std::set<TermId>& classes) const {
    classes.insert(class_id);
    if (sub_class_)
      forEach({.s = {}, .p = sub_class_, .o = class_id, .g = {}},
              [&](const rdf::QuadIds& quad) { classes.insert(quad.s); });
  }

  void addDisjoint(TermId class_id, std::set<TermId>& classes) const {
    if (!disjoint_ || !ontology_) return;
    std::set<TermId> above{class_id};
    if (sub_class_)
      forEach({.s = class_id, .p = sub_class_, .o = {}, .g = {}},
              [&](const rdf::QuadIds& quad) { above.insert(quad.o); });
    for (const TermId one : above) {
      forEach({.s = one, .p = disjoint_, .o = {}, .g = ontology_},
              [&](const rdf::QuadIds& quad) { addWithSubclasses(quad.o, classes); });
      forEach({.s = {}, .p = disjoint_, .o = one, .g = ontology_},
              [&](const rdf::QuadIds& quad) { addWithSubclasses(quad.s, classes); });
    }
  }

  const rdf::QuadReader& reader_;
  std::optional<TermId> operator_, observed_, ontology_, history_, type_, sub_class_, disjoint_;
  std::vector<rdf::Triple> excluded_;
};

}  // namespace

std::vector<rdf::Triple> excludedTypes(const rdf::QuadReader& reader) {
  return Exclusions(reader).all();
}

}  // namespace cluxel::mapping
