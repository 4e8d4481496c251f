// SPDX-License-Identifier: Apache-2.0
// The quad store over an environment: a term dictionary and sorted indexes of 16-byte quads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/knowledge/term.hpp"

namespace cluxel {

/// The number of a term in one store's dictionary. 0 is the unnamed default graph, and "any" in a pattern's s, p, o.
/// Ids follow arrival, so no order of results or bytes may depend on them.
using TermId = std::uint32_t;
inline constexpr TermId kNoTerm = 0;

struct QuadIds {
  TermId s = 0, p = 0, o = 0, g = 0;
  auto operator<=>(const QuadIds&) const = default;
};

/// Positions bound by a pattern; absent ones match anything.
struct QuadPattern {
  std::optional<TermId> s, p, o, g;
};

/// The sort orders that exist as indexes: the letters say which position sorts first.
enum class QuadOrder : std::uint8_t { Spog, Posg, Ospg, Gspo };

/// A value decoded when its term entered the dictionary.
struct DecodedValue {
  enum class Type : std::uint8_t {
    None,        ///< not a literal, or of a datatype that is not decoded, or ill-formed
    Integer,     ///< xsd:integer and its derived types, when it fits 64 bits
    Decimal, Float, Double, Boolean, String, LangString, DateTime, Date
  };
  Type type = Type::None;
  TermKind kind = TermKind::Iri;
  std::int64_t integer = 0;     ///< Integer, Boolean; DateTime and Date: microseconds since 1970-01-01T00:00:00Z
  double number = 0;            ///< the value as a double (exact for Integer below 2^53, Float, Double)
};

/// Sorted quads of one index within a range. Blocks point into the mapped file: no copies.
class QuadCursor {
 public:
  struct Impl;
  QuadCursor();
  explicit QuadCursor(std::unique_ptr<Impl> impl);
  QuadCursor(QuadCursor&&) noexcept;
  QuadCursor& operator=(QuadCursor&&) noexcept;
  ~QuadCursor();

  /// The next quad in s,p,o,g form; false at the end.
  bool next(QuadIds& quad);
  /// Moves forward to the first quad not before `quad` in the cursor's order, without reading what lies between.
  void seek(const QuadIds& quad);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Read access to the quads at one commit. One thread at a time.
class QuadReader {
 public:
  struct Impl;
  explicit QuadReader(ReadTransaction transaction);
  ~QuadReader();
  QuadReader(QuadReader&&) noexcept;

  std::optional<TermId> idOf(const Term& term) const;
  Term termOf(TermId id) const;
  const DecodedValue& valueOf(TermId id) const;
  /// The quads that match, in the order of the index `order`; every bound position must be a prefix of that order, the
  /// rest is filtered.
  QuadCursor scan(const QuadPattern& pattern, QuadOrder order) const;
  /// The same, in the order of the index that answers the pattern from a prefix.
  QuadCursor scan(const QuadPattern& pattern) const;
  bool contains(const QuadIds& quad) const;
  /// How many quads match: exact up to some thousands, an estimate within a factor 2 above. Cost O(log n).
  std::uint64_t estimate(const QuadPattern& pattern) const;
  std::uint64_t size() const;        ///< the number of quads, exact
  std::uint64_t termCount() const;
  /// How many different subjects/objects a predicate has, for join estimates; cached per snapshot.
  struct PredicateStatistics { std::uint64_t quads = 0, subjects = 0, objects = 0; };
  PredicateStatistics statistics(TermId predicate) const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Write access within a transaction. Cheap to construct; holds a write-back cache that flush() empties (commit through
/// the transaction after flush()).
class QuadWriter {
 public:
  struct Impl;
  explicit QuadWriter(WriteTransaction& transaction);
  ~QuadWriter();

  TermId intern(const Term& term);
  void add(const QuadIds& quad);             ///< no effect when it is there
  void add(const Quad& quad);
  void remove(const QuadIds& quad);          ///< no effect when it is not there
  void clearGraph(TermId graph);
  void flush();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel
