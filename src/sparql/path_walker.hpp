// SPDX-License-Identifier: Apache-2.0
// Property paths over the graph: which nodes a path leads to from a node, each once.
#pragma once

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sparql/runtime.hpp"

namespace cluxel::sparql {

/// Walks the paths of one graph (or union of graphs). Remembers closures it has computed.
class PathWalker {
 public:
  PathWalker(Runtime& runtime, const GraphFilter& graphs);

  using Nodes = std::vector<ValueId>;
  /// The nodes that `path` leads to from `node`, or from which it leads to `node`; each once. A path of length zero
  /// leads to the node itself, whether the graph has it or not.
  const Nodes& reach(const CompiledPath& path, ValueId node, bool forward);
  /// The nodes at which a path may begin when neither end is known.
  Nodes starts(const CompiledPath& path);
  /// The node is a subject or object in the graph.
  bool isNode(ValueId node);
  /// Drops what reach() has kept, and gives its memory back to the budget.
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
  void entries(QuadOrder order, std::span<const TermId> prefix, Take take);

  Runtime& runtime_;
  GraphFilter graphs_;
  PrefixLookup by_subject_, by_predicate_, by_object_;
  std::unordered_map<Key, Nodes, KeyHash> known_;
  std::size_t known_bytes_ = 0;  ///< charged
};

}  // namespace cluxel::sparql
