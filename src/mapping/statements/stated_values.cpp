// SPDX-License-Identifier: Apache-2.0
// Checked wherever statements come in: from the command `state`, from updates, and from files.
#include "mapping/statements/stated_values.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/nearest_name.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/iri.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::clx;

constexpr std::array<std::string_view, 32> kComputed{"confidence",
                                                     "rule",
                                                     "x",
                                                     "y",
                                                     "z",
                                                     "minX",
                                                     "minY",
                                                     "minZ",
                                                     "maxX",
                                                     "maxY",
                                                     "maxZ",
                                                     "height",
                                                     "length",
                                                     "width",
                                                     "bottom",
                                                     "top",
                                                     "pointCount",
                                                     "heading",
                                                     "viewCount",
                                                     "firstSeen",
                                                     "lastSeen",
                                                     "seenEmpty",
                                                     "seenThrough",
                                                     "porosity",
                                                     "rayCount",
                                                     "hasPart",
                                                     "hasPrimitive",
                                                     "near",
                                                     "appliesTo",
                                                     "rulesSay",
                                                     "statementEffect",
                                                     "contradictsRules"};

/// What the graph `history` tells of objects and things. A stated one would follow the points to objects of which it is
/// not true. Of PROV; isReplacedBy() comes to them.
constexpr std::array<std::string_view, 6> kHistory{"wasDerivedFrom",   "wasGeneratedBy",  "wasInvalidatedBy",
                                                   "specializationOf", "generatedAtTime", "invalidatedAtTime"};

/// Classes that say no more than that it is an object.
constexpr std::array<std::string_view, 2> kAnyObject{"SpatialThing", "Object"};

constexpr double kMinArea_m2 = 1e-4, kMaxCorner_m = 1e6;

bool isAnyObject(const std::string& iri) {
  return std::any_of(kAnyObject.begin(), kAnyObject.end(), [&](std::string_view local) { return iri == clx(local); });
}

[[noreturn]] void failUnknownClass(const std::string& iri, const rules::ClassCatalogue& classes) {
  const std::vector<std::string> names = rules::namesOf(classes).all();
  const std::string hint = suggestion(rdf::localName(iri), names);
  throw Error(ErrorKind::NotFound,
              "the map's ontology knows no class <" + iri + ">" + (hint.empty() ? "" : "; " + hint));
}

/// An object can be stated not to be of a class that it could not be stated to be of: SPARQL rules may derive any.
void requireClass(StatementKind kind, const std::string& iri, const rules::ClassCatalogue& classes) {
  if (classes.find(iri) == nullptr) failUnknownClass(iri, classes);
  if (isAnyObject(iri) || classes.isA(clx("Object"), iri))
    throw Error(
        ErrorKind::InvalidArgument,
        "<" + iri + "> is no class of objects that tells them apart; state one such as clx:Tree or clx:StreetSign");
  if (kind == StatementKind::Is && !isClassOfObjects(iri, classes))
    throw Error(ErrorKind::InvalidArgument,
                noClassOfObjects(iri) +
                    "; state one such as clx:Tree, or write in the ontology that it is rdfs:subClassOf one");
}

void requireRegion(const RegionAnchor& region) {
  double twice_area = 0;
  for (std::size_t i = 0; i < region.corners.size(); ++i) {
    const Eigen::Vector3d &a = region.corners[i], &b = region.corners[(i + 1) % region.corners.size()];
    if (!a.allFinite() || a.cwiseAbs().maxCoeff() > kMaxCorner_m)
      throw Error(ErrorKind::InvalidArgument,
                  "a corner of the region is no number, or farther than 1000 km from its scan; give metres of the map");
    twice_area += a.x() * b.y() - b.x() * a.y();
  }
  if (!(std::abs(twice_area) / 2 >= kMinArea_m2))
    throw Error(ErrorKind::InvalidArgument, "the region has no area; give its corners in their order along the border");
}

bool isComputed(const std::string& property) {
  return property == isReplacedBy() ||
         std::any_of(kComputed.begin(), kComputed.end(),
                     [&](std::string_view local) { return property == clx(local); }) ||
         std::any_of(kHistory.begin(), kHistory.end(),
                     [&](std::string_view local) { return property == provenance(local); });
}

/// Of a fact.
void requireValue(const Statement& statement) {
  if (statement.value.kind == TermKind::BlankNode)
    throw Error(ErrorKind::InvalidArgument,
                "<" + statement.property + "> of an object is a blank node; state an IRI or a literal");
  if (firstInvalidUtf8(statement.value.text))
    throw Error(ErrorKind::InvalidArgument, "the value of <" + statement.property + "> is not UTF-8");
}

bool namesClass(const Statement& statement) {
  return (statement.kind == StatementKind::Is || statement.kind == StatementKind::IsNot) &&
         statement.value.kind == TermKind::Iri;
}

}  // namespace

bool isClassOfObjects(const std::string& iri, const rules::ClassCatalogue& classes) {
  return classes.find(iri) != nullptr && !isAnyObject(iri) && classes.isA(iri, clx("Object"));
}

std::string noClassOfObjects(const std::string& iri) {
  return "<" + iri + "> is no class of objects: it is not below clx:Object";
}

void requireStatable(const std::string& property) {
  const bool is_type = property == rdf::vocabulary::rdf("type");
  const bool is_geometry = property.starts_with(rdf::vocabulary::kGeo) || property.starts_with(rdf::vocabulary::kSosa);
  if (is_type || is_geometry || isComputed(property))
    throw Error(ErrorKind::InvalidArgument,
                "<" + property + "> of an object is computed by the map; state its class, or another property");
}

void requireStatable(const Statement& statement, const rules::ClassCatalogue& classes) {
  switch (statement.kind) {
    case StatementKind::Is:
    case StatementKind::IsNot:
      return requireClass(statement.kind, statement.value.text, classes);
    case StatementKind::IgnoreRegion:
      return requireRegion(statement.region);
    case StatementKind::Remove:
      return;
    case StatementKind::Fact:
      break;
  }
  requireStatable(statement.property);
  requireValue(statement);
}

void requireStatableOrDormant(const Statement& statement, const rules::ClassCatalogue& classes, ProgressSink& sink) {
  if (!namesClass(statement) || classes.find(statement.value.text) != nullptr)
    return requireStatable(statement, classes);
  sink.note("the statement " + statement.id().hex() + " has no effect: the map's ontology knows no class <" +
            statement.value.text + ">");
}

void requireStatableOrKept(const Statement& statement, const rules::ClassCatalogue& classes, ProgressSink& sink) {
  const bool is_known_class = namesClass(statement) && classes.find(statement.value.text) != nullptr;
  const bool is_computed = statement.kind == StatementKind::Fact && isComputed(statement.property);
  if (!is_known_class && !is_computed) return requireStatableOrDormant(statement, classes, sink);
  if (is_computed) requireValue(statement);
  try {
    requireStatable(statement, classes);
  } catch (const Error& fault) {
    const bool has_effect = statement.kind != StatementKind::Is;
    sink.note("the statement " + statement.id().hex() +
              (has_effect ? " is kept, but nobody can make it now: " : " has no effect: ") + fault.what());
  }
}

void requireNoWholeClass(const rdf::ReadTransaction& transaction, const Statement& statement) {
  if (statement.kind != StatementKind::Is || !storedRecord(transaction, rules::idOfClassWide(statement.value.text)))
    return;
  throw Error(ErrorKind::InvalidArgument,
              "<" + statement.value.text +
                  "> is one object over all of the map, which nothing else can become; state "
                  "that the object is removed");
}

}  // namespace cluxel::mapping
