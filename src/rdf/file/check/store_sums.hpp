// SPDX-License-Identifier: Apache-2.0
// Counts and hashes of all quads, of the index of terms, and of each group of 64 terms. They reveal damage, and an
// insertion or removal updates them at the cost of one hash.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/file/table.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/terms/term_record.hpp"

namespace cluxel::rdf {

/// A folded product of both halves: any changed bit changes about half of the result.
inline std::uint64_t hashOfKey(Key128 key) {
  const std::uint64_t high = static_cast<std::uint64_t>(key >> 64U) ^ 0x9E3779B97F4A7C15U;
  const std::uint64_t low = static_cast<std::uint64_t>(key) ^ 0xD1B54A32D192ED03U;
  const Key128 product = static_cast<Key128>(high) * low;
  return static_cast<std::uint64_t>(product >> 64U) ^ static_cast<std::uint64_t>(product) ^ (high + (low << 1U));
}

/// Independent of the order of keys; hashes add up modulo 2^64.
struct EntrySum {
  std::uint64_t count = 0, hash = 0;
  bool operator==(const EntrySum&) const = default;
  void add(Key128 key) {
    ++count;
    hash += hashOfKey(key);
  }
  void remove(Key128 key) {
    --count;
    hash -= hashOfKey(key);
  }
  EntrySum operator-(const EntrySum& part) const { return {count - part.count, hash - part.hash}; }
};

/// A key of an index as it counts in sums: a quad in the order s, p, o, g, so that all indexes have one sum.
template <Table kIndex>
Key128 keyInSum(Key128 key) {
  const auto id = [key](unsigned place) { return Key128{static_cast<TermId>(key >> (32 * (3 - place)))}; };
  const auto joined = [](Key128 s, Key128 p, Key128 o, Key128 g) { return s << 96U | p << 64U | o << 32U | g; };
  if constexpr (kIndex == Table::Posg) return joined(id(2), id(0), id(1), id(3));
  if constexpr (kIndex == Table::Ospg) return joined(id(1), id(2), id(0), id(3));
  if constexpr (kIndex == Table::Gspo) return joined(id(1), id(2), id(3), id(0));
  if constexpr (kIndex == Table::Psog) return joined(id(1), id(0), id(2), id(3));
  return key;
}

/// Calls `work` with the function that turns keys of the index into those of its sum.
template <typename Work>
auto withKeysOfSum(Table index, const Work& work) {
  switch (index) {
    case Table::Posg:
      return work([](Key128 key) { return keyInSum<Table::Posg>(key); });
    case Table::Ospg:
      return work([](Key128 key) { return keyInSum<Table::Ospg>(key); });
    case Table::Gspo:
      return work([](Key128 key) { return keyInSum<Table::Gspo>(key); });
    case Table::Psog:
      return work([](Key128 key) { return keyInSum<Table::Psog>(key); });
    default:
      return work([](Key128 key) { return keyInSum<Table::Spog>(key); });
  }
}

inline Key128 keyInSumOf(Table index, Key128 key) {
  return withKeysOfSum(index, [key](const auto& key_in_sum) { return key_in_sum(key); });
}

/// The record of a commit in the main database.
struct StoreSums {
  std::uint64_t transaction = 0;  ///< the commit that wrote it
  EntrySum quads;                 ///< of spog and gspo, keys in the order s, p, o, g; so are those of the parts below
  EntrySum term_hashes;
  EntrySum links;    ///< of ospg, which may lack quads with literals
  EntrySum numbers;  ///< of psog; posg has the other quads
  bool operator==(const StoreSums&) const = default;
  /// Of the terms, or of an index.
  EntrySum of(Table table) const {
    switch (table) {
      case Table::Terms:
      case Table::TermHashes:
        return term_hashes;
      case Table::Ospg:
        return links;
      case Table::Psog:
        return numbers;
      case Table::Posg:
        return quads - numbers;
      default:
        return quads;
    }
  }
};

/// None in a map of format 1. Throws Error (StoreUnavailable) when the record is damaged or of another commit than
/// `commit`.
std::optional<StoreSums> storedSums(const ReadTransaction::Impl& transaction, std::uint64_t commit);
void storeSums(const ReadTransaction::Impl& transaction, const StoreSums& sums);

/// The sum of an index, with the keys of quads in the order s, p, o, g. Throws Error (StoreUnavailable) when keys are
/// out of order. Cost: 2 ns a key.
EntrySum sumOf(const PageDirectory& directory, Table index, const std::filesystem::path& file);

/// The key of a term in its sum.
inline Key128 keyOfTerm(const TermHash& hash, TermId id) {
  return (Key128{hash.high} << 64U) | (Key128{hash.low} << 32U) | id;
}

inline constexpr TermId kTermsOfSum = 64;

/// Sums of terms of a write transaction, for terms whose ids ascend.
class TermSumWriter {
 public:
  explicit TermSumWriter(WriteTransaction& transaction) : transaction_(transaction) {}
  void add(const TermHash& hash, TermId id);
  void store();

 private:
  WriteTransaction& transaction_;
  std::map<TermId, std::uint64_t> sums_;  ///< of new terms, by group of 64
};

/// The stored sums of all terms up to `terms`. Throws Error (StoreUnavailable) when some are missing.
std::vector<std::uint64_t> storedTermSums(ReadTransaction::Impl& transaction, std::uint64_t terms);

}  // namespace cluxel::rdf
