// SPDX-License-Identifier: Apache-2.0
// The quad store: a term dictionary and sorted indexes of 16-byte quads in an environment.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/term.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// The id of a term in the dictionary. 0 is the unnamed default graph, and a wildcard in a pattern's s, p and o. Ids
/// are assigned in arrival order, so results and stored bytes must not depend on them.
using TermId = std::uint32_t;
inline constexpr TermId kNoTerm = 0;

struct QuadIds {
  TermId s = 0, p = 0, o = 0, g = 0;
  auto operator<=>(const QuadIds&) const = default;
};

/// The quads by which two states of a store differ; both lists are sorted.
struct QuadDifference {
  std::vector<QuadIds> added, removed;
};

/// The bound positions of a pattern; absent ones are wildcards.
struct QuadPattern {
  std::optional<TermId> s, p, o, g;
};

/// The sort orders of the indexes; the letters give the positions from most to least significant. The index Ospg lacks
/// quads whose object is a literal. Those whose object is a number are in Psog only, the others in Posg only. Readers
/// collect what an index lacks from the others.
enum class QuadOrder : std::uint8_t { Spog, Posg, Ospg, Gspo, Psog };
inline constexpr std::array<QuadOrder, 5> kQuadOrders = {QuadOrder::Spog, QuadOrder::Posg, QuadOrder::Ospg,
                                                         QuadOrder::Gspo, QuadOrder::Psog};

/// An index entry as stored: four big-endian ids in the order of the index, so that bytewise order is sort order.
/// Entries are read in place from the mapped file and may be unaligned.
struct QuadKey {
  std::array<std::uint8_t, 16> bytes;

  /// The id at `position` (0 to 3) of the index's order.
  TermId at(std::size_t position) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + 4 * position, sizeof value);
    return __builtin_bswap32(value);
  }
};
static_assert(sizeof(QuadKey) == 16 && alignof(QuadKey) == 1);

/// The permutation from index order to s, p, o, g: Posg gives 1, 2, 0, 3.
constexpr std::array<std::uint8_t, 4> placesOf(QuadOrder order) {
  switch (order) {
    case QuadOrder::Posg:
      return {1, 2, 0, 3};
    case QuadOrder::Ospg:
      return {2, 0, 1, 3};
    case QuadOrder::Gspo:
      return {3, 0, 1, 2};
    case QuadOrder::Psog:
      return {1, 0, 2, 3};
    case QuadOrder::Spog:
      break;
  }
  return {0, 1, 2, 3};
}

inline QuadIds toQuad(const QuadKey& key, QuadOrder order) {
  std::array<TermId, 4> ids{};
  const std::array<std::uint8_t, 4> places = placesOf(order);
  for (std::size_t i = 0; i < 4; ++i) ids[places[i]] = key.at(i);
  return {ids[0], ids[1], ids[2], ids[3]};
}

/// A zero-copy view of a term in the mapped file. Valid until the transaction ends and, in a write transaction, until
/// the next flush.
struct TermView {
  TermKind kind = TermKind::Iri;
  std::string_view text;      ///< as in Term
  std::string_view datatype;  ///< as in Term
  std::string_view language;  ///< as in Term

  Term toTerm() const { return {kind, std::string(text), std::string(datatype), std::string(language)}; }
  static TermView of(const Term& term) { return {term.kind, term.text, term.datatype, term.language}; }
};

/// The value of a literal, decoded when the term was added to the dictionary.
struct DecodedValue {
  enum class Type : std::uint8_t {
    None,     ///< not a literal, of a datatype that is not decoded, ill-formed, an integer beyond 64 bits, or a
              ///< DateTime or Date without a time zone (its order against others is not determined)
    Integer,  ///< xsd:integer and its derived types, if the value fits 64 bits
    Decimal,
    Float,
    Double,
    Boolean,
    String,
    LangString,
    DateTime,
    Date
  };
  static constexpr std::uint8_t kNoScale = 255;
  Type type = Type::None;
  TermKind kind = TermKind::Iri;
  std::uint8_t scale = kNoScale;  ///< of a Decimal that equals integer * 10^-scale; else kNoScale
  TermId datatype = kNoTerm;      ///< id of the datatype; kNoTerm for xsd:string, rdf:langString and non-literals
  std::int64_t integer =
      0;  ///< Integer, Boolean; Decimal: see scale; DateTime and Date: microseconds since 1970-01-01T00:00:00Z
  double number = 0;  ///< the value as a double (exact for Integer below 2^53, Float, Double)
};

/// Iterates over a sorted range of one index. Blocks are zero-copy views of the mapped file.
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
  /// Fills `out` and returns the number of quads; fewer than out.size() only at the end.
  std::size_t next(std::span<QuadIds> out);
  /// Seeks forward to the first quad not less than `quad` in the cursor's order, without reading the quads between.
  void seek(const QuadIds& quad);
  /// The remaining entries of the current page, then one page per call; at most 255 entries, none at the end. Entries
  /// match the pattern's bound prefix only: if filtered() is true, the caller must test the other positions.
  std::span<const QuadKey> nextBlock();
  bool filtered() const;  ///< a bound position is not in the prefix of the order
  QuadOrder order() const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Repeated prefix lookups in one index, as in an index nested loop join. Keeps its position, so that ascending
/// prefixes are cheaper than random ones. Cost: about 0.1 us each when warm; some 10 us for a literal in Ospg. The
/// first lookup of a number in Posg, or of a predicate that has some, orders all quads of the predicate.
class PrefixLookup {
 public:
  struct Impl;
  PrefixLookup();
  explicit PrefixLookup(std::unique_ptr<Impl> impl);
  PrefixLookup(PrefixLookup&&) noexcept;
  PrefixLookup& operator=(PrefixLookup&&) noexcept;
  ~PrefixLookup();

  /// Announces the next lookups in order, as consecutive groups of `length` (1 to 4) ids. Searching for them together
  /// overlaps their cache misses. A hint only: the actual lookups may differ.
  void expect(std::span<const TermId> prefixes, std::size_t length);
  /// The entries with `prefix` (1 to 4 ids in index order) on the first page that has any; empty when there are none.
  std::span<const QuadKey> find(std::span<const TermId> prefix);
  /// The entries with the same prefix on the next page; empty at the end.
  std::span<const QuadKey> more();

 private:
  std::unique_ptr<Impl> impl_;
};

class GeometryIndex;

/// Read access to the quads of one commit, for one thread at a time; the readers of a commit share its caches. Within a
/// write transaction it sees flushed changes, and a flush invalidates its cursors, blocks and views.
class QuadReader {
 public:
  struct Impl;
  explicit QuadReader(ReadTransaction transaction);
  ~QuadReader();
  QuadReader(QuadReader&&) noexcept;
  QuadReader& operator=(QuadReader&&) noexcept;

  std::optional<TermId> idOf(const Term& term) const;
  Term termOf(TermId id) const;  ///< id 0, the unnamed default graph, is an IRI with empty text
  TermView viewOf(TermId id) const;
  bool isLiteral(TermId id) const;               ///< false for unknown terms
  const DecodedValue& valueOf(TermId id) const;  ///< O(1); the reference lives as long as the reader
  /// Prefetches decoded values that are needed soon. A hint only; unknown ids are ignored.
  void expectValues(std::span<const TermId> ids) const;
  /// The matching quads in the order of the index `order`. Bound positions that form a prefix of the order limit the
  /// range; the others are filtered.
  QuadCursor scan(const QuadPattern& pattern, QuadOrder order) const;
  /// As above, in the order that costs least.
  QuadCursor scan(const QuadPattern& pattern) const;
  /// The index with the longest prefix bound by the pattern, not Psog.
  static QuadOrder bestOrder(const QuadPattern& pattern);
  /// The order in which a scan costs least: as above, or Psog for a predicate that has numbers only.
  QuadOrder scanOrder(const QuadPattern& pattern) const;
  bool hasOnlyNumbers(TermId predicate) const;  ///< so that Psog holds all of its quads
  PrefixLookup lookup(QuadOrder order) const;   ///< not for Psog
  bool contains(const QuadIds& quad) const;
  /// The number of matching quads: exact up to some thousands, above that an estimate within a factor of 2. Cost O(log
  /// n). Of a number among more than 100 thousand quads it is a guess.
  std::uint64_t estimate(const QuadPattern& pattern) const;
  /// The exact number of matching quads. Cost: one step per page of 255 quads if the bound positions form a prefix of
  /// an index, else one per quad in the best prefix range.
  std::uint64_t count(const QuadPattern& pattern) const;
  std::uint64_t size() const;  ///< the exact number of quads
  std::uint64_t termCount() const;
  /// The ids of non-empty graphs, ascending; 0 is the unnamed default graph. Cost: one seek per graph.
  std::vector<TermId> graphs() const;
  /// The ids of all predicates, ascending. Cost: one seek per predicate.
  std::vector<TermId> predicates() const;
  /// The numbers of distinct subjects and objects of a predicate, for join estimates; cached per snapshot. Exact for up
  /// to some thousands of quads, sampled above.
  struct PredicateStatistics {
    std::uint64_t quads = 0, subjects = 0, objects = 0;
  };
  PredicateStatistics statistics(TermId predicate) const;
  /// The spatial index (geometry_index.hpp) of this commit; opened on first use.
  std::shared_ptr<const GeometryIndex> geometries() const;
  /// A cache slot of this commit for the layers above, by name; null when it is empty. Thread-safe among the readers of
  /// a commit.
  std::shared_ptr<const void> kept(const std::string& name) const;
  void keep(const std::string& name, std::shared_ptr<const void> made) const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Write access within a transaction; at most one writer may have unflushed changes. Changes are buffered until flush()
/// and lost if the writer is destroyed before. Call flush() before committing the transaction. Cheap to construct.
class QuadWriter {
 public:
  struct Impl;
  explicit QuadWriter(WriteTransaction& transaction);
  ~QuadWriter();
  QuadWriter(const QuadWriter&) = delete;
  QuadWriter& operator=(const QuadWriter&) = delete;

  TermId intern(const Term& term);
  void add(const QuadIds& quad);  ///< no effect when it exists
  void add(const Quad& quad);
  void remove(const QuadIds& quad);  ///< no effect when it does not exist
  /// Flushes, and makes the changes at once: faster than one call a quad. Both lists are ascending, without duplicates,
  /// and disjoint.
  void change(const QuadDifference& difference);
  void clearGraph(TermId graph);
  void flush();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::rdf
