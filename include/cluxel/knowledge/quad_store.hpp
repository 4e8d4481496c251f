// SPDX-License-Identifier: Apache-2.0
// The quad store over an environment: a term dictionary and sorted indexes of 16-byte quads.
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

/// One entry of an index as it is stored: four big-endian ids in the index's order, so that byte order is sort order.
/// Entries are read in place from the mapped file and may lie at any address.
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

/// For each position of the order, the place of that id in s, p, o, g: Posg gives 1, 2, 0, 3.
constexpr std::array<std::uint8_t, 4> placesOf(QuadOrder order) {
  switch (order) {
    case QuadOrder::Posg:
      return {1, 2, 0, 3};
    case QuadOrder::Ospg:
      return {2, 0, 1, 3};
    case QuadOrder::Gspo:
      return {3, 0, 1, 2};
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

/// A term as it lies in the mapped file: no copies. Valid while the transaction lives and, in a write transaction,
/// until the next flush.
struct TermView {
  TermKind kind = TermKind::Iri;
  std::string_view text;      ///< as in Term
  std::string_view datatype;  ///< as in Term
  std::string_view language;  ///< as in Term

  Term toTerm() const { return {kind, std::string(text), std::string(datatype), std::string(language)}; }
  static TermView of(const Term& term) { return {term.kind, term.text, term.datatype, term.language}; }
};

/// A value decoded when its term entered the dictionary.
struct DecodedValue {
  enum class Type : std::uint8_t {
    None,     ///< not a literal, of a datatype that is not decoded, ill-formed, an integer beyond 64 bits, or a
              ///< DateTime or Date without a time zone (its order against others is not determined)
    Integer,  ///< xsd:integer and its derived types, when it fits 64 bits
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
  std::uint8_t scale = kNoScale;  ///< of a Decimal that is exactly integer * 10^-scale; else kNoScale
  TermId datatype = kNoTerm;      ///< the datatype's own id; kNoTerm for no literal, xsd:string and rdf:langString
  std::int64_t integer =
      0;  ///< Integer, Boolean; Decimal: see scale; DateTime and Date: microseconds since 1970-01-01T00:00:00Z
  double number = 0;  ///< the value as a double (exact for Integer below 2^53, Float, Double)
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
  /// Fills `out` from the front and gives how many there were; fewer than out.size() only at the end.
  std::size_t next(std::span<QuadIds> out);
  /// Moves forward to the first quad not before `quad` in the cursor's order, without reading what lies between.
  void seek(const QuadIds& quad);
  /// The rest of the current page's quads within the range, then page by page; empty at the end. At most 255 entries.
  /// Only the pattern's leading bound positions hold for them: where filtered() is true, the caller tests the rest.
  std::span<const QuadKey> nextBlock();
  bool filtered() const;  ///< some bound position is not in the prefix of the order
  QuadOrder order() const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Very many lookups by prefix in one index, as an index nested loop makes them: remembers where it was, so that
/// ascending prefixes cost less than random ones. Some 0.1 us each when warm.
class PrefixLookup {
 public:
  struct Impl;
  PrefixLookup();
  explicit PrefixLookup(std::unique_ptr<Impl> impl);
  PrefixLookup(PrefixLookup&&) noexcept;
  PrefixLookup& operator=(PrefixLookup&&) noexcept;
  ~PrefixLookup();

  /// Lookups that will be made next, in this order: ids one after another, `length` (1 to 4) for each. Searching for
  /// all of them at once lets their waits for the memory overlap. Changes no answer; lookups may also differ or not
  /// come.
  void expect(std::span<const TermId> prefixes, std::size_t length);
  /// The entries that begin with `prefix` (1 to 4 ids in the index's order) on the first page that has any; empty when
  /// there is none.
  std::span<const QuadKey> find(std::span<const TermId> prefix);
  /// The entries of the same prefix on the next page; empty at the end.
  std::span<const QuadKey> more();

 private:
  std::unique_ptr<Impl> impl_;
};

/// Read access to the quads at one commit. One thread at a time; several readers share what one commit has cached.
/// Over a write transaction it sees what has been flushed; a flush ends the validity of its cursors, blocks and views.
class QuadReader {
 public:
  struct Impl;
  explicit QuadReader(ReadTransaction transaction);
  ~QuadReader();
  QuadReader(QuadReader&&) noexcept;
  QuadReader& operator=(QuadReader&&) noexcept;

  std::optional<TermId> idOf(const Term& term) const;
  Term termOf(TermId id) const;  ///< the unnamed default graph (0) is an IRI without text
  TermView viewOf(TermId id) const;
  const DecodedValue& valueOf(TermId id) const;  ///< O(1); the reference lives as long as the reader
  /// Terms whose views, or values, will be asked for soon: reads them from the memory together. Changes no answer; ids
  /// that the store does not have are passed over.
  void expectViews(std::span<const TermId> ids) const;
  void expectValues(std::span<const TermId> ids) const;
  /// The quads that match, in the order of the index `order`; bound positions that are a prefix of that order bound the
  /// range, the others are filtered.
  QuadCursor scan(const QuadPattern& pattern, QuadOrder order) const;
  /// The same, in the order of the index that answers the pattern from the longest prefix.
  QuadCursor scan(const QuadPattern& pattern) const;
  /// The index whose order has the longest prefix bound by the pattern.
  static QuadOrder bestOrder(const QuadPattern& pattern);
  PrefixLookup lookup(QuadOrder order) const;
  bool contains(const QuadIds& quad) const;
  /// How many quads match: exact up to some thousands, an estimate within a factor 2 above. Cost O(log n).
  std::uint64_t estimate(const QuadPattern& pattern) const;
  /// How many quads match, exactly. Cost: one step per page of 255 when the bound positions are a prefix of an index,
  /// else one per quad of the best prefix.
  std::uint64_t count(const QuadPattern& pattern) const;
  std::uint64_t size() const;  ///< the number of quads, exact
  std::uint64_t termCount() const;
  /// The graphs that hold quads, 0 among them when the unnamed default graph does; ascending ids. Cost: a seek each.
  std::vector<TermId> graphs() const;
  /// The predicates in use, ascending ids. Cost: a seek each.
  std::vector<TermId> predicates() const;
  /// How many different subjects/objects a predicate has, for join estimates; cached per snapshot. Exact for predicates
  /// of up to some thousands of quads, sampled above.
  struct PredicateStatistics {
    std::uint64_t quads = 0, subjects = 0, objects = 0;
  };
  PredicateStatistics statistics(TermId predicate) const;
  /// What a layer above has made from this commit and keeps for its other readers, by a name of its own; null when
  /// there is none. Thread-safe among the readers of a commit.
  std::shared_ptr<const void> kept(const std::string& name) const;
  void keep(const std::string& name, std::shared_ptr<const void> made) const;

 private:
  std::unique_ptr<Impl> impl_;
};

/// Write access within a transaction; of several writers only one may hold unflushed changes. Cheap to construct; holds
/// a write-back cache that flush() empties: what was not flushed is lost with the writer. Commit through the
/// transaction after flush().
class QuadWriter {
 public:
  struct Impl;
  explicit QuadWriter(WriteTransaction& transaction);
  ~QuadWriter();
  QuadWriter(const QuadWriter&) = delete;
  QuadWriter& operator=(const QuadWriter&) = delete;

  TermId intern(const Term& term);
  void add(const QuadIds& quad);  ///< no effect when it is there
  void add(const Quad& quad);
  void remove(const QuadIds& quad);  ///< no effect when it is not there
  void clearGraph(TermId graph);
  void flush();

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel
