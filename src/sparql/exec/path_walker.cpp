// SPDX-License-Identifier: Apache-2.0
// Evaluates property paths by breadth-first search (section 18.4, ALP).
#include "sparql/exec/path_walker.hpp"

#include <algorithm>

namespace cluxel::sparql {
namespace {

using PathKind = ast::Path::Kind;
constexpr std::size_t kMaxKnownBytes = 64 << 20, kBytesOfEntry = 96;

void makeUnique(PathWalker::Nodes& nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

}  // namespace

std::size_t PathWalker::KeyHash::operator()(const Key& key) const {
  return std::hash<const void*>()(key.path) * 31 + key.node * 0x9E3779B97F4A7C15ull + (key.forward ? 1 : 0);
}

PathWalker::PathWalker(Runtime& runtime, const GraphFilter& graphs)
    : runtime_(runtime),
      graphs_(graphs),
      by_subject_(runtime.reader.lookup(rdf::QuadOrder::Spog)),
      by_predicate_(runtime.reader.lookup(rdf::QuadOrder::Posg)),
      by_object_(runtime.reader.lookup(rdf::QuadOrder::Ospg)) {}

template <typename Take>
void PathWalker::entries(rdf::QuadOrder order, std::span<const rdf::TermId> prefix, Take take) {
  rdf::PrefixLookup& lookup = order == rdf::QuadOrder::Spog   ? by_subject_
                              : order == rdf::QuadOrder::Posg ? by_predicate_
                                                              : by_object_;
  const std::size_t graph_position = 3;  // last in all three
  for (auto block = lookup.find(prefix); !block.empty(); block = lookup.more()) {
    runtime_.guard.work(block.size());
    for (const rdf::QuadKey& key : block) {
      if (graphs_.admits(key.at(graph_position))) take(key);
    }
  }
}

const PathWalker::Nodes& PathWalker::reach(const CompiledPath& path, ValueId node, bool forward) {
  const Key key{&path, node, forward};
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  Nodes nodes;
  step(path, node, forward, nodes);
  const std::size_t bytes = nodes.size() * sizeof(ValueId) + kBytesOfEntry;
  if (known_bytes_ + bytes > kMaxKnownBytes || !runtime_.guard.hasRoomFor(2 * bytes)) forget();
  runtime_.guard.charge(bytes);
  known_bytes_ += bytes;
  return known_.emplace(key, std::move(nodes)).first->second;
}

void PathWalker::forget() {
  runtime_.guard.release(known_bytes_);
  known_bytes_ = 0;
  known_.clear();
}

void PathWalker::step(const CompiledPath& path, ValueId node, bool forward, Nodes& out) {
  switch (path.kind) {
    case PathKind::Link:
      return link(path.iri, node, forward, out);
    case PathKind::Inverse:
      return step(path.parts[0], node, !forward, out);
    case PathKind::NegatedSet:
      return negated(path, node, forward, out);
    case PathKind::ZeroOrMore:
      return closure(path.parts[0], node, forward, true, out);
    case PathKind::OneOrMore:
      return closure(path.parts[0], node, forward, false, out);
    case PathKind::Alternative:
      for (const CompiledPath& part : path.parts) step(part, node, forward, out);
      return makeUnique(out);
    case PathKind::ZeroOrOne:
      step(path.parts[0], node, forward, out);
      out.push_back(node);
      return makeUnique(out);
    case PathKind::Sequence: {
      Nodes frontier = {node}, next;
      for (std::size_t i = 0; i < path.parts.size(); ++i) {
        const CompiledPath& part = path.parts[forward ? i : path.parts.size() - 1 - i];
        next.clear();
        for (const ValueId from : frontier) step(part, from, forward, next);
        makeUnique(next);
        frontier.swap(next);
      }
      out.insert(out.end(), frontier.begin(), frontier.end());
      return;
    }
  }
}

void PathWalker::link(ValueId predicate, ValueId node, bool forward, Nodes& out) {
  if (predicate >= kFirstComputed || node >= kFirstComputed) return;
  const std::array<rdf::TermId, 2> prefix =
      forward ? std::array<rdf::TermId, 2>{node, predicate} : std::array<rdf::TermId, 2>{predicate, node};
  const std::size_t first = out.size();
  // In both orders the other end is third, and duplicates from several graphs are adjacent.
  entries(forward ? rdf::QuadOrder::Spog : rdf::QuadOrder::Posg, prefix, [&](const rdf::QuadKey& key) {
    const rdf::TermId end = key.at(2);
    if (out.size() == first || out.back() != end) out.push_back(end);
  });
}

void PathWalker::negated(const CompiledPath& path, ValueId node, bool forward, Nodes& out) {
  if (path.has_forward) excluding(path.forward, node, forward, out);
  if (path.has_backward) excluding(path.backward, node, !forward, out);
  makeUnique(out);
}

void PathWalker::excluding(const std::vector<ValueId>& predicates, ValueId node, bool forward, Nodes& out) {
  if (node >= kFirstComputed) return;
  const std::array<rdf::TermId, 1> prefix = {node};
  // spog: s p o; ospg: o s p.
  const std::size_t predicate_position = forward ? 1 : 2, end_position = forward ? 2 : 1;
  entries(forward ? rdf::QuadOrder::Spog : rdf::QuadOrder::Ospg, prefix, [&](const rdf::QuadKey& key) {
    const rdf::TermId predicate = key.at(predicate_position);
    if (std::find(predicates.begin(), predicates.end(), predicate) == predicates.end()) {
      out.push_back(key.at(end_position));
    }
  });
}

void PathWalker::closure(const CompiledPath& inner, ValueId node, bool forward, bool with_start, Nodes& out) {
  std::unordered_set<ValueId> seen;
  Nodes frontier, next;
  if (with_start) seen.insert(node);
  const std::size_t first = out.size();
  if (with_start) out.push_back(node);
  frontier = {node};
  while (!frontier.empty()) {
    Nodes reached;
    for (const ValueId from : frontier) {
      next.clear();
      step(inner, from, forward, next);
      for (const ValueId to : next) {
        if (seen.insert(to).second) reached.push_back(to);
      }
      runtime_.guard.work(next.size() + 1);
    }
    out.insert(out.end(), reached.begin(), reached.end());
    frontier = std::move(reached);
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end());
}

bool PathWalker::isNode(ValueId node) {
  if (node >= kFirstComputed) return false;
  const std::array<rdf::TermId, 1> prefix = {node};
  bool found = false;
  entries(rdf::QuadOrder::Spog, prefix, [&](const rdf::QuadKey&) { found = true; });
  if (!found) entries(rdf::QuadOrder::Ospg, prefix, [&](const rdf::QuadKey&) { found = true; });
  return found;
}

PathWalker::Nodes PathWalker::starts(const CompiledPath& path) {
  Nodes nodes;
  const CompiledPath* first = &path;
  bool zero = false;
  while (first->kind == PathKind::OneOrMore || first->kind == PathKind::Sequence) first = &first->parts[0];
  zero = first->kind == PathKind::ZeroOrMore || first->kind == PathKind::ZeroOrOne;
  rdf::QuadPattern pattern;
  const bool one_predicate = !zero && first->kind == PathKind::Link;
  if (one_predicate) {
    if (first->iri >= kFirstComputed) return nodes;
    pattern.p = first->iri;
  }
  const rdf::QuadOrder order = runtime_.reader.scanOrder(pattern);
  const std::size_t at_subject = order == rdf::QuadOrder::Psog ? 1 : 2;  // of one predicate
  rdf::QuadCursor cursor = runtime_.reader.scan(pattern, order);
  for (auto block = cursor.nextBlock(); !block.empty(); block = cursor.nextBlock()) {
    runtime_.guard.work(block.size());
    for (const rdf::QuadKey& key : block) {
      if (!graphs_.admits(key.at(3))) continue;
      if (one_predicate) {
        nodes.push_back(key.at(at_subject));
        continue;
      }
      if (nodes.empty() || nodes.back() != key.at(0)) nodes.push_back(key.at(0));
      nodes.push_back(key.at(2));
    }
  }
  makeUnique(nodes);
  return nodes;
}

}  // namespace cluxel::sparql
