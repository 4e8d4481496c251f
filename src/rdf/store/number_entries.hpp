// SPDX-License-Identifier: Apache-2.0
// Quads with numbers in the order of index posg, which lacks them. Many subjects share a number, and their ids are
// spread over the whole map, so that each number would cost a page of its own whenever a part of the map changes.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Where the quads with an object are: only links are in index ospg, and numbers are in psog instead of posg. A number
/// has a decoded value of type Integer, Decimal, Float or Double.
enum class ObjectKind : std::uint8_t { Link, Literal, Number };

/// Collects entries from the indexes posg and psog.
class NumberEntries {
 public:
  using Keys = std::shared_ptr<const std::vector<QuadKey>>;

  explicit NumberEntries(ReadTransaction transaction) : transaction_(std::move(transaction)) {}

  /// False for maps whose index posg holds all quads. Of these only the kind of objects and matching() may be asked.
  bool areApart() const;
  ObjectKind kindOf(TermId id) const;  ///< Link for unknown terms
  bool isNumber(TermId id) const { return kindOf(id) == ObjectKind::Number; }
  bool has(TermId predicate) const;        ///< some quads of the predicate have a number
  bool hasOnly(TermId predicate) const;    ///< as above, and no quad has another object
  std::vector<TermId> predicates() const;  ///< those that have numbers, ascending
  /// All quads of a predicate as ascending keys of posg. Made once in a commit. Cost: all quads of the predicate.
  Keys of(TermId predicate) const;
  /// All quads that the bound positions admit, also those without numbers, as ascending keys of `order`. Cost: a look
  /// at all quads of the predicate, or of the map where none is bound.
  std::vector<QuadKey> matching(const QuadPattern& pattern, QuadOrder order) const;

 private:
  const PageDirectory& directory(QuadOrder order) const;
  bool hasIn(QuadOrder order, TermId predicate) const;

  ReadTransaction transaction_;
};

/// The kinds of objects, each found once. Memory follows the ids that are asked for, not the terms of the map.
class ObjectKinds {
 public:
  explicit ObjectKinds(ReadTransaction transaction) : entries_(std::move(transaction)) {}
  ObjectKind of(TermId id);
  /// Of an id that was asked for.
  ObjectKind known(TermId id) const { return *(*chunks_[id / kChunkSize])[id % kChunkSize]; }

 private:
  static constexpr TermId kChunkSize = 4096;
  using Chunk = std::array<std::optional<ObjectKind>, kChunkSize>;
  NumberEntries entries_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
};

/// The distinct first ids of an index, ascending. Cost: one seek for each.
std::vector<TermId> distinctFirst(const PageDirectory& directory);

}  // namespace cluxel::rdf
