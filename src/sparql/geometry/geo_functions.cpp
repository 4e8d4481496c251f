// SPDX-License-Identifier: Apache-2.0
// GeoSPARQL functions on WKT literals in the map's metric frame, or in one named system.
#include <cmath>

#include "base/proj_reference_system.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/functions/function_bodies.hpp"
#include "sparql/geometry/geometry.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

const std::string& wktDatatype() {
  static const std::string iri = std::string(rdf::vocabulary::kGeo) + "wktLiteral";
  return iri;
}

std::string shownSystem(const std::string& name) {
  return name.empty() ? "none (the map frame)" : name;
}

/// False, with a note, for geometries of different systems: they are not converted.
bool haveOneSystem(const Geometry& a, const Geometry& b, FunctionContext& context) {
  if (systemOf(a) == systemOf(b)) return true;
  noteDifferentSystems(systemOf(a), systemOf(b), context);
  return false;
}

/// In metres; absent, with a note, where no correct distance is known.
std::optional<double> metresBetween(const Geometry& a, const Geometry& b, FunctionContext& context) {
  const std::string& name = systemOf(a);
  if (name.empty()) return distanceBetween(a, b);
  const ReferenceSystem& system = context.geometries->system(name);
  switch (system.kind) {
    case ReferenceSystem::Kind::Projected:
      return distanceBetween(a, b) * system.metres_per_unit;
    case ReferenceSystem::Kind::Geographic:
      if (const auto distance_m = geodesicDistance(a, b, system)) return distance_m;
      context.note("a latitude beyond 90 degrees in " + name + " has no distance: " +
                   (system.latitude_first ? "this system names the latitude first" : "it names the longitude first"));
      return std::nullopt;
    case ReferenceSystem::Kind::Unknown:
      break;
  }
  context.note("distances in " + name + " are unknown: it is no projected or geographic system that PROJ knows");
  return std::nullopt;
}

template <typename Test>
Value relate(Arguments arguments, FunctionContext& context, Test test) {
  const auto a = geometryOf(arguments[0], context), b = geometryOf(arguments[1], context);
  if (!a || !b || !haveOneSystem(*a, *b, context)) return {};
  return Value::boolean(test(*a, *b));
}

}  // namespace

void noteDifferentSystems(const std::string& a, const std::string& b, FunctionContext& context) {
  std::string first = shownSystem(a), second = shownSystem(b);
  if (second < first) std::swap(first, second);
  context.note("geometries of different coordinate systems are not related to each other: " + first + " and " + second +
               "; write both in one system");
}

std::shared_ptr<const Geometry> geometryOf(const Value& value, FunctionContext& context) {
  if (value.type != Type::Other) return nullptr;
  const bool is_stored = value.id < kFirstComputed;
  if (is_stored) {
    if (const auto* known = context.geometries->known(value.id)) return *known;
  }
  const rdf::TermView literal = context.terms.view(value.id);
  if (literal.datatype != wktDatatype()) return nullptr;
  return is_stored ? context.geometries->add(value.id, literal.text) : context.geometries->find(literal.text);
}

Value geoDistanceFunction(Arguments arguments, FunctionContext& context) {
  // The optional unit must be metre.
  if (arguments.size() == 3) {
    const std::string iri = context.terms.textOf(arguments[2]);
    const std::string_view unit = std::string_view(iri).substr(iri.find_last_of("/#:") + 1);
    if (unit != "metre" && unit != "meter") return {};
  }
  const auto a = geometryOf(arguments[0], context), b = geometryOf(arguments[1], context);
  if (!a || !b || !haveOneSystem(*a, *b, context)) return {};
  if (hasHeight(*a) || hasHeight(*b)) context.note("geof:distance leaves the Z and M coordinates of geometries out");
  const auto distance_m = metresBetween(*a, *b, context);
  return distance_m && std::isfinite(*distance_m) ? Value::ofDouble(*distance_m) : Value();
}

Value sfIntersectsFunction(Arguments arguments, FunctionContext& context) {
  return relate(arguments, context, [](const Geometry& a, const Geometry& b) { return intersects(a, b); });
}

Value sfDisjointFunction(Arguments arguments, FunctionContext& context) {
  return relate(arguments, context, [](const Geometry& a, const Geometry& b) { return !intersects(a, b); });
}

Value sfWithinFunction(Arguments arguments, FunctionContext& context) {
  return relate(arguments, context, [](const Geometry& a, const Geometry& b) { return within(a, b); });
}

Value sfContainsFunction(Arguments arguments, FunctionContext& context) {
  return relate(arguments, context, [](const Geometry& a, const Geometry& b) { return within(b, a); });
}

Value sfTouchesFunction(Arguments arguments, FunctionContext& context) {
  return relate(arguments, context, [](const Geometry& a, const Geometry& b) { return touches(a, b); });
}

Value envelopeFunction(Arguments arguments, FunctionContext& context) {
  const auto geometry = geometryOf(arguments[0], context);
  const auto box = geometry ? envelopeWkt(*geometry) : std::nullopt;
  if (!box) return {};
  const Term term = Term::literal(*box, wktDatatype());
  return context.terms.valueOf(context.terms.intern(term));
}

}  // namespace cluxel::sparql
