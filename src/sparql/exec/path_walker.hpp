// SPDX-License-Identifier: Apache-2.0
// Property path evaluation: the distinct nodes that a path reaches from a node.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

/// Evaluates paths in one graph or union of graphs, and caches closures.
class PathWalker {
 public:
  PathWalker(Runtime& runtime, const GraphFilter& graphs);

  using Nodes = std::vector<ValueId>;
  /// The distinct nodes reached by `path` from `node`, or (backwards) from which it reaches `node`. A path of length
  /// zero reaches the node itself, even if the graph does not contain it.
  const Nodes& reach(const CompiledPath& path, ValueId node, bool forward);
  /// The candidate start nodes of a path when both ends are unbound.
  Nodes starts(const CompiledPath& path);
  /// True when the node is a subject or object in the graph.
  bool isNode(ValueId node);
  /// Clears the cache of reach() and releases its memory budget.
  void forget();

 private:
  struct Key {
    const CompiledPath* path;
    ValueId node;
    bool forward;
    bool operator==(const Key&) const = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };

  void step(const CompiledPath& path, ValueId node, bool forward, Nodes& out);
  void link(ValueId predicate, ValueId node, bool forward, Nodes& out);
  void negated(const CompiledPath& path, ValueId node, bool forward, Nodes& out);
  void excluding(const std::vector<ValueId>& predicates, ValueId node, bool forward, Nodes& out);
  void closure(const CompiledPath& inner, ValueId node, bool forward, bool with_start, Nodes& out);
  template <typename Take>
  void entries(rdf::QuadOrder order, std::span<const rdf::TermId> prefix, Take take);

  Runtime& runtime_;
  GraphFilter graphs_;
  rdf::PrefixLookup by_subject_, by_predicate_, by_object_;
  std::unordered_map<Key, Nodes, KeyHash> known_;
  std::size_t known_bytes_ = 0;  ///< charged to the guard
};

}  // namespace cluxel::sparql
