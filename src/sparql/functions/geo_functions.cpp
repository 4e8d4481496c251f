// SPDX-License-Identifier: Apache-2.0
// GeoSPARQL functions on WKT literals in the map's metric frame.
#include <cmath>

#include "rdf/vocabulary.hpp"
#include "sparql/functions/function_bodies.hpp"
#include "sparql/functions/geometry.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

const std::string& wktDatatype() {
  static const std::string iri = std::string(rdf::vocabulary::kGeo) + "wktLiteral";
  return iri;
}

template <typename Test>
Value relate(Arguments arguments, FunctionContext& context, Test test) {
  const auto a = geometryOf(arguments[0], context), b = geometryOf(arguments[1], context);
  if (!a || !b || !mayMeasure(*a, *b)) return {};
  return Value::boolean(test(*a, *b));
}

}  // namespace

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
  if (!a || !b || !mayMeasure(*a, *b)) return {};
  const double distance_m = distanceBetween(*a, *b);
  return std::isfinite(distance_m) ? Value::ofDouble(distance_m) : Value();
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
  if (!geometry || !std::isfinite(boundsOf(*geometry).min_x)) return {};
  const Term term = Term::literal(envelopeWkt(*geometry), wktDatatype());
  return context.terms.valueOf(context.terms.intern(term));
}

}  // namespace cluxel::sparql
