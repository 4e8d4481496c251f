// SPDX-License-Identifier: Apache-2.0
// Reads the statements as facts: their outcomes are facts, too, when inference begins.
#include "mapping/statements/excluded_types.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

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
        disjoint_(idOf(std::string(rdf::vocabulary::kOwl) + "disjointWith")),
        stated_class_(idOf(clx("statedClass"))),
        kind_(idOf(clx("statementKind"))),
        effect_(idOf(clx("statementEffect"))),
        about_(idOf(clx("appliesTo"))) {}

  std::vector<rdf::Triple> all() {
    std::vector<rdf::Triple> excluded;
    if (!operator_ || !observed_ || !type_ || !stated_class_ || !about_) return excluded;
    forEach({.s = {}, .p = stated_class_, .o = {}, .g = operator_}, [&](const rdf::QuadIds& stated) {
      if (!isApplied(stated.s)) return;
      const std::set<TermId>& classes = ruledOutBy(kindOf(stated.s), stated.o);
      if (classes.empty()) return;
      forEach({.s = stated.s, .p = about_, .o = {}, .g = observed_}, [&](const rdf::QuadIds& applied) {
        for (const TermId one : classes) excluded.push_back({applied.o, *type_, one});
      });
    });
    std::sort(excluded.begin(), excluded.end());
    excluded.erase(std::unique(excluded.begin(), excluded.end()), excluded.end());
    return excluded;
  }

  /// The IRIs of the statements that rule out the class of the object.
  std::vector<std::string> statementsAgainst(const std::string& object_iri, const std::string& class_iri) {
    std::vector<std::string> found;
    const auto object = idOf(object_iri), class_id = idOf(class_iri);
    if (!operator_ || !observed_ || !stated_class_ || !about_ || !object || !class_id) return found;
    forEach({.s = {}, .p = about_, .o = object, .g = observed_}, [&](const rdf::QuadIds& applied) {
      if (!isApplied(applied.s)) return;
      forEach({.s = applied.s, .p = stated_class_, .o = {}, .g = operator_}, [&](const rdf::QuadIds& stated) {
        if (ruledOutBy(kindOf(stated.s), stated.o).contains(*class_id)) found.push_back(reader_.termOf(stated.s).text);
      });
    });
    return found;
  }

  /// By a statement of this kind, "is" or "is not", about this class.
  const std::set<TermId>& ruledOutBy(const std::string& kind, TermId class_id) {
    const auto [place, is_new] = ruled_out_.try_emplace({kind, class_id});
    if (is_new && kind == nameOf(StatementKind::IsNot)) addWithSubclasses(class_id, place->second);
    if (is_new && kind == nameOf(StatementKind::Is)) addDisjoint(class_id, place->second);
    return place->second;
  }

  std::optional<TermId> idOf(const std::string& iri) const { return reader_.idOf(Term::iri(iri)); }

 private:
  bool isApplied(TermId statement) const {
    return textOf(statement, effect_, observed_) == nameOf(StatementEffect::Applied);
  }
  std::string kindOf(TermId statement) const { return textOf(statement, kind_, operator_); }

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
  std::optional<TermId> stated_class_, kind_, effect_, about_;
  std::map<std::pair<std::string, TermId>, std::set<TermId>> ruled_out_;  ///< by kind and class of a statement
};

}  // namespace

std::vector<rdf::Triple> excludedTypes(const rdf::QuadReader& reader) {
  return Exclusions(reader).all();
}

std::vector<std::string> statementsAgainst(const rdf::QuadReader& reader, const std::string& object_iri,
                                           const std::string& class_iri) {
  std::vector<std::string> found = Exclusions(reader).statementsAgainst(object_iri, class_iri);
  std::sort(found.begin(), found.end());
  return found;
}

bool rulesOut(const rdf::QuadReader& reader, const Statement& statement, const std::string& class_iri) {
  Exclusions exclusions(reader);
  const auto stated = exclusions.idOf(statement.value.text), asked = exclusions.idOf(class_iri);
  return stated && asked && exclusions.ruledOutBy(std::string(nameOf(statement.kind)), *stated).contains(*asked);
}

}  // namespace cluxel::mapping
