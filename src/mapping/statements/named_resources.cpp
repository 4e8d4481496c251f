// SPDX-License-Identifier: Apache-2.0
// Whole graphs are looked through, so that names are compared where they are stored.
#include "mapping/statements/named_resources.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "mapping/layers/stored_layers.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

/// Kinds of resources without a name that stays.
constexpr std::array<std::string_view, 3> kPiecesOfObjects{"part", "primitive", "observation"};

bool isOfKind(std::string_view iri, std::string_view kind) {
  const std::string_view map = rdf::vocabulary::kMap;
  if (!iri.starts_with(map)) return false;
  iri.remove_prefix(map.size());
  return iri.starts_with(kind) && iri.substr(kind.size()).starts_with("/");
}

bool namesPiece(std::string_view iri) {
  return std::any_of(kPiecesOfObjects.begin(), kPiecesOfObjects.end(),
                     [&](std::string_view kind) { return isOfKind(iri, kind); });
}

bool namesResource(const rdf::TermView& term) {
  return term.kind == TermKind::Iri &&
         (isOfKind(term.text, "object") || isOfKind(term.text, "thing") || namesPiece(term.text));
}

/// "<NAME> ONE", or "<NAME> and 2 more MANY".
std::string namesWith(const std::set<std::string>& names, const std::string& one, const std::string& many) {
  const std::string first = "<" + *names.begin() + "> ";
  return names.size() == 1 ? first + one : first + "and " + std::to_string(names.size() - 1) + " more " + many;
}

/// Of an object that is all of its class, such as the ground, the name stays.
bool changesItsName(const rdf::ReadTransaction& transaction, const std::string& iri) {
  if (namesPiece(iri)) return true;
  const auto object = hashIn(iri, "object");
  const auto record = object ? storedRecord(transaction, *object) : std::nullopt;
  return object.has_value() && !(record && record->is_class_wide);
}

/// What to state instead of the first of the values that has a thing; empty when none has.
std::string remedyFor(const rdf::QuadReader& reader, const std::set<std::string>& values) {
  const ThingLookup lookup(reader);
  for (const std::string& iri : values) {
    const auto object = hashIn(iri, "object");
    const std::vector<Thing> things = object ? lookup.thingsOf(*object) : std::vector<Thing>();
    if (!things.empty())
      return ". The thing of an object keeps its name: state <" + things.front().iri + "> instead of <" + iri + ">";
  }
  return "";
}

}  // namespace

bool namesObject(const Term& subject) {
  return subject.kind == TermKind::Iri && (isOfKind(subject.text, "object") || isOfKind(subject.text, "thing"));
}

std::set<rdf::QuadIds> quadsThatNameResources(const rdf::ReadTransaction& transaction) {
  const rdf::QuadReader reader(transaction);
  const auto graph = reader.idOf(Term::iri(rdf::vocabulary::kGraphOperator));
  if (!graph) return {};
  std::set<rdf::QuadIds> naming;
  rdf::QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = *graph}, rdf::QuadOrder::Gspo);
  rdf::TermId subject = 0;
  bool is_named = false;  // the subject, which the quads of one share
  for (rdf::QuadIds quad; cursor.next(quad);) {
    if (quad.s != subject) is_named = namesResource(reader.viewOf(quad.s));
    subject = quad.s;
    if (is_named || namesResource(reader.viewOf(quad.o))) naming.insert(naming.end(), quad);
  }
  return naming;
}

void noteNamesThatChange(const rdf::ReadTransaction& transaction, const std::set<rdf::QuadIds>& stated,
                         ProgressSink& sink) {
  const rdf::QuadReader reader(transaction);
  std::set<std::string> subjects, values;
  for (const rdf::QuadIds& quad : stated) {
    const Term subject = reader.termOf(quad.s), value = reader.termOf(quad.o);
    if (subject.kind == TermKind::Iri && namesPiece(subject.text)) subjects.insert(subject.text);
    if (value.kind == TermKind::Iri && changesItsName(transaction, value.text)) values.insert(value.text);
  }
  if (!subjects.empty())
    sink.note(namesWith(subjects, "is no object", "are no objects") +
              ": what is stated of parts, primitives and observations stays with their names, which change with their "
              "members. State it of their objects, which it follows");
  if (!values.empty())
    sink.note("the value " +
              namesWith(values, "is the name of an object, or of a piece of one",
                        "are names of objects, or of pieces of them") +
              ". Such names change with the points of what they name, and values do not follow them" +
              remedyFor(reader, values));
}

}  // namespace cluxel::mapping
