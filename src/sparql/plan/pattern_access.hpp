// SPDX-License-Identifier: Apache-2.0
// The access path of a quad pattern: index order, bound prefix, and the handling of each position of an entry.
#pragma once

#include <array>
#include <span>

#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

/// Positions of a quad in s, p, o, g order.
using QuadPlaces = std::array<PatternPlace, 4>;

/// The fourth position is the graph: a slot, a constant or, for the default graph, neither.
QuadPlaces placesOfPattern(const TripleNode& pattern);

/// The graphs that a pattern reads.
GraphFilter graphFilterOf(const TripleNode& pattern, const Dataset& dataset);

/// Bits of bound positions: 1 s, 2 p, 4 o, 8 g.
using BoundMask = unsigned;

/// The index order with the longest bound prefix, not psog, and the prefix length.
struct OrderChoice {
  rdf::QuadOrder order = rdf::QuadOrder::Spog;
  std::size_t prefix = 0;
};
OrderChoice chooseOrder(BoundMask bound);

/// Filters index entries for one pattern and one set of bound positions, and copies them to columns.
class EntryReader {
 public:
  EntryReader() = default;
  EntryReader(const TripleNode& pattern, const GraphFilter& graphs, rdf::QuadOrder order, BoundMask bound);

  /// True when the entry matches the ids in `bound`. Entries must arrive in index order, so that duplicates of a triple
  /// in several graphs can be skipped.
  bool admits(const rdf::QuadKey& key, const std::array<ValueId, 4>& bound) {
    for (std::size_t i = 0; i < check_count_; ++i) {
      if (key.at(checks_[i].position) != bound[checks_[i].place]) return false;
    }
    if (same_count_ != 0 && !samePlacesAgree(key)) return false;
    if (test_graph_ && !graphs_->admits(key.at(graph_position_))) return false;
    if (!excluded_.empty() && isExcluded(key)) return false;
    if (skip_repeats_) {
      if (have_last_ && std::memcmp(last_.bytes.data(), key.bytes.data(), 12) == 0) return false;
      last_ = key;
      have_last_ = true;
    }
    return true;
  }
  /// The slots that an entry binds, with their positions in the entry.
  struct Output {
    Slot slot;
    std::uint8_t position;
  };
  std::span<const Output> outputs() const { return {outputs_.data(), output_count_}; }
  /// Resets duplicate detection at the start of a new prefix.
  void restart() { have_last_ = false; }
  bool admitsAll() const {
    return check_count_ == 0 && same_count_ == 0 && !test_graph_ && excluded_.empty() && !skip_repeats_;
  }

 private:
  struct Check {
    std::uint8_t position, place;
  };
  bool samePlacesAgree(const rdf::QuadKey& key) const;
  bool isExcluded(const rdf::QuadKey& key) const;

  std::array<Check, 4> checks_{};
  std::size_t check_count_ = 0;
  std::array<Check, 4> same_{};  ///< pairs of positions with the same slot
  std::size_t same_count_ = 0;
  std::array<Output, 4> outputs_{};
  std::size_t output_count_ = 0;
  const GraphFilter* graphs_ = nullptr;
  std::uint8_t graph_position_ = 3, predicate_position_ = 1;
  bool test_graph_ = false, skip_repeats_ = false, have_last_ = false;
  std::vector<ValueId> excluded_;
  rdf::QuadKey last_{};
};

}  // namespace cluxel::sparql
