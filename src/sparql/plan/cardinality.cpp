// SPDX-License-Identifier: Apache-2.0
// Estimates cardinalities.
#include "sparql/plan/cardinality.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::sparql {
namespace {

bool isBound(const PatternPlace& place, const SlotSet& bound) {
  return place.isSlot() && bound.has(place.slot);
}

/// The assumed number of quads per subject or object when there are no statistics.
constexpr double kQuadsPerNode = 8;
constexpr double kFilterKeeps = 0.33;

}  // namespace

const rdf::QuadReader::PredicateStatistics& Cardinality::statistics(rdf::TermId predicate) {
  const auto known = statistics_.find(predicate);
  if (known != statistics_.end()) return known->second;
  return statistics_.emplace(predicate, reader_.statistics(predicate)).first->second;
}

double Cardinality::quadsOf(ValueId predicate) {
  if (predicate >= kFirstComputed) return 0;
  return static_cast<double>(reader_.estimate({.s = {}, .p = predicate, .o = {}, .g = {}}));
}

double Cardinality::matches(const TripleNode& pattern) {
  const auto known = known_.find(&pattern);
  if (known != known_.end()) return known->second;
  rdf::QuadPattern quad_pattern;
  bool possible = true;
  const auto bind = [&possible](const PatternPlace& place, std::optional<rdf::TermId>& id) {
    if (place.isSlot()) return;
    id = place.constant;
    possible = possible && place.constant < kFirstComputed;
  };
  bind(pattern.subject, quad_pattern.s);
  if (!pattern.path) bind(pattern.predicate, quad_pattern.p);
  bind(pattern.object, quad_pattern.o);
  if (pattern.graph.kind == GraphPlace::Kind::Constant) quad_pattern.g = pattern.graph.constant;
  const double count =
      possible && quad_pattern.g.value_or(0) < kFirstComputed ? static_cast<double>(reader_.estimate(quad_pattern)) : 0;
  known_.emplace(&pattern, count);
  return count;
}

double Cardinality::fanOut(const TripleNode& pattern, const SlotSet& bound) {
  if (pattern.path) return pathRows(pattern, bound);
  const double count = matches(pattern);
  if (count == 0) return 0;
  const bool s = isBound(pattern.subject, bound), o = isBound(pattern.object, bound);
  const bool p = isBound(pattern.predicate, bound);
  double result = count;
  if (!pattern.predicate.isSlot()) {
    if (!s && !o) return result;
    const auto& known = statistics(pattern.predicate.constant);
    if (s) result /= std::max(1.0, static_cast<double>(known.subjects));
    if (o) result /= std::max(1.0, static_cast<double>(known.objects));
  } else {
    const double nodes = std::max(1.0, static_cast<double>(reader_.size()) / kQuadsPerNode);
    if (s) result = std::min(result, std::max(count / nodes, kQuadsPerNode * (o ? 0.1 : 1)));
    if (o && !s) result = std::min(result, std::max(count / nodes, kQuadsPerNode));
    if (p) result /= 16;
  }
  return result;
}

double Cardinality::pathRows(const TripleNode& pattern, const SlotSet& bound) {
  const bool s = !pattern.subject.isSlot() || isBound(pattern.subject, bound);
  const bool o = !pattern.object.isSlot() || isBound(pattern.object, bound);
  if (s && o) return 0.5;
  const double all = static_cast<double>(reader_.size());
  const CompiledPath* first = pattern.path.get();
  while (!first->parts.empty()) first = &first->parts[0];
  const bool link = first->kind == ast::Path::Kind::Link && first->iri < kFirstComputed && first->iri != kUnbound;
  const double quads = link ? quadsOf(first->iri) : all;
  if (s || o) return std::min(20.0, quads + 1);
  return (link && pattern.path->kind == ast::Path::Kind::OneOrMore ? quads : all) * 4 + 1;
}

double Cardinality::joinRows(const Node& node) {
  double rows = 1;
  SlotSet bound;
  for (const NodePtr& child : node.children) {
    const double child_rows = child->kind == Node::Kind::Triple ? fanOut(child->triple, bound) : this->rows(*child);
    const bool connected = bound.intersects(child->possible);
    rows = child->kind == Node::Kind::Triple || !connected ? rows * child_rows : std::max(rows, child_rows);
    bound.add(child->certain);
  }
  return rows;
}

double Cardinality::rows(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Unit:
      return 1;
    case Node::Kind::Nothing:
      return 0;
    case Node::Kind::Triple:
      return fanOut(node.triple, {});
    case Node::Kind::GraphNames:
      return static_cast<double>(std::max<std::size_t>(dataset_.named.size(), 1));
    case Node::Kind::Join:
      return joinRows(node);
    case Node::Kind::LeftJoin:
      return rows(*node.children[0]) * 1.2;
    case Node::Kind::Filter:
      return rows(*node.children[0]) * std::pow(kFilterKeeps, static_cast<double>(node.conditions.size()));
    case Node::Kind::Values:
      return static_cast<double>(node.rows.count);
    case Node::Kind::Group:
      return node.grouped_by_keys ? std::max(1.0, std::sqrt(rows(*node.children[0])) * 4) : 1;
    case Node::Kind::Slice: {
      const double all = rows(*node.children[0]);
      return node.limit ? std::min(all, static_cast<double>(*node.limit)) : all;
    }
    case Node::Kind::Union: {
      double sum = 0;
      for (const NodePtr& child : node.children) sum += rows(*child);
      return sum;
    }
    case Node::Kind::GraphLoop:
      return rows(*node.children[0]) * static_cast<double>(dataset_.named.size() + 1);
    case Node::Kind::Minus:
    case Node::Kind::Extend:
    case Node::Kind::OrderBy:
    case Node::Kind::Project:
    case Node::Kind::Distinct:
      return rows(*node.children[0]);
  }
  return 1;
}

}  // namespace cluxel::sparql
