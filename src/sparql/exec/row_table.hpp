// SPDX-License-Identifier: Apache-2.0
// Materialised rows, and hash indexes over some of their columns.
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

inline constexpr unsigned kRowHashShift = 16;  ///< the upper bits of a hash select the bucket

inline std::uint64_t mixHash(std::uint64_t hash, ValueId id) {
  hash = (hash ^ id) * 0x9E3779B97F4A7C15ull;
  return hash ^ (hash >> 29);
}

/// The hash of the last id of a key: keeps runs of 256 ids adjacent for cache locality, because probes often have
/// nearby ids, and distributes the runs evenly.
inline std::uint64_t runHash(std::uint64_t hash, ValueId id) {
  return mixHash(hash, id >> 8) + (std::uint64_t{id & 255} << kRowHashShift);
}

/// Rows over a fixed list of slots, in row-major order.
class RowTable {
 public:
  RowTable() = default;
  explicit RowTable(std::vector<Slot> slots) : slots_(std::move(slots)) {}

  const std::vector<Slot>& slots() const { return slots_; }
  std::size_t rows() const { return rows_; }
  const ValueId* row(std::size_t index) const { return cells_.data() + index * slots_.size(); }
  std::size_t bytes() const { return cells_.capacity() * sizeof(ValueId); }

  /// Charges its growth to the guard.
  void append(const Batch& batch, Guard& guard) {
    const std::size_t before = cells_.size();
    requireGrowth(batch.rows, guard);
    cells_.resize(before + batch.rows * slots_.size());
    guard.charge((cells_.size() - before) * sizeof(ValueId));
    for (std::size_t column = 0; column < slots_.size(); ++column) {
      const auto& source = batch.columns[slots_[column]];
      ValueId* target = cells_.data() + before + column;
      for (std::size_t row = 0; row < batch.rows; ++row, target += slots_.size()) {
        *target = source.empty() ? kUnbound : source[row];
      }
    }
    rows_ += batch.rows;
  }
  /// Appends the rows `picks` of the batch.
  void append(const Batch& batch, const std::vector<std::uint32_t>& picks, Guard& guard) {
    guard.charge(picks.size() * slots_.size() * sizeof(ValueId));
    requireGrowth(picks.size(), guard);
    for (const std::uint32_t row : picks) {
      for (const Slot slot : slots_) cells_.push_back(batch.at(slot, row));
    }
    rows_ += picks.size();
  }
  void clear(Guard& guard) {
    guard.release(cells_.size() * sizeof(ValueId));
    cells_.clear();
    rows_ = 0;
  }
  std::vector<ValueId>& cells() { return cells_; }
  void setRows(std::size_t rows) { rows_ = rows; }

 private:
  /// While a full array moves to a larger one, its cells are held twice.
  void requireGrowth(std::size_t rows, const Guard& guard) const {
    if (cells_.size() + rows * slots_.size() > cells_.capacity()) guard.requireRoomFor(cells_.size() * sizeof(ValueId));
  }

  std::vector<Slot> slots_;
  std::vector<ValueId> cells_;
  std::size_t rows_ = 0;
};

/// The hash of a key of `size` ids.
template <typename IdAt>
std::uint64_t hashOfKey(std::size_t size, const IdAt& id_at) {
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i + 1 < size; ++i) hash = mixHash(hash, id_at(i));
  return size == 0 ? hash : runHash(hash, id_at(size - 1));
}

/// A chained hash index from key columns to row numbers.
class RowIndex {
 public:
  static constexpr std::uint32_t kEnd = 0xFFFF'FFFFu;

  /// `columns` are positions in the table's slot list.
  void build(const RowTable& table, std::vector<std::size_t> columns, Guard& guard) {
    columns_ = std::move(columns);
    std::size_t buckets = 16;
    while (buckets < table.rows() * 2) buckets *= 2;
    clear(guard);
    guard.charge((buckets + table.rows()) * sizeof(std::uint32_t));
    heads_.assign(buckets, kEnd);
    next_.resize(table.rows());
    for (std::size_t i = table.rows(); i-- > 0;) {
      std::uint32_t& head = heads_[bucketOf(hashOf(table.row(i)))];
      next_[i] = head;
      head = static_cast<std::uint32_t>(i);
    }
  }
  void clear(Guard& guard) {
    guard.release((heads_.size() + next_.size()) * sizeof(std::uint32_t));
    heads_.clear();
    next_.clear();
  }
  std::uint32_t first(std::uint64_t hash) const { return heads_[bucketOf(hash)]; }
  std::uint32_t next(std::uint32_t row) const { return next_[row]; }
  std::uint64_t hashOf(const ValueId* row) const {
    return hashOfKey(columns_.size(), [&](std::size_t i) { return row[columns_[i]]; });
  }

 private:
  std::size_t bucketOf(std::uint64_t hash) const { return (hash >> kRowHashShift) & (heads_.size() - 1); }

  std::vector<std::size_t> columns_;
  std::vector<std::uint32_t> heads_, next_;
};

}  // namespace cluxel::sparql
