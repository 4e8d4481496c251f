// SPDX-License-Identifier: Apache-2.0
// Open-addressing hash sets of ids and rows, for DISTINCT and GROUP BY.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sparql/exec/row_table.hpp"

namespace cluxel::sparql {

/// A set of ids other than 0.
class IdSet {
 public:
  /// Returns true when the id is new.
  bool insert(ValueId id) {
    if ((size_ + 1) * 2 > cells_.size()) grow();
    std::size_t at = place(id);
    while (cells_[at] != 0) {
      if (cells_[at] == id) return false;
      at = (at + 1) & (cells_.size() - 1);
    }
    cells_[at] = id;
    ++size_;
    return true;
  }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return cells_.size() * sizeof(ValueId); }
  void clear() {
    cells_.clear();
    size_ = 0;
  }

 private:
  std::size_t place(ValueId id) const { return (mixHash(0, id) >> 20) & (cells_.size() - 1); }
  void grow() {
    std::vector<ValueId> old(std::max<std::size_t>(16, cells_.size() * 2), 0);
    old.swap(cells_);
    for (const ValueId id : old) {
      if (id == 0) continue;
      std::size_t at = place(id);
      while (cells_[at] != 0) at = (at + 1) & (cells_.size() - 1);
      cells_[at] = id;
    }
  }
  std::vector<ValueId> cells_;
  std::size_t size_ = 0;
};

/// A set of rows of equal width, numbered in order of first insertion.
class RowSet {
 public:
  explicit RowSet(std::size_t width = 0) : width_(width) {}

  /// The number of the row, and true when it is new.
  std::pair<std::uint32_t, bool> insert(const ValueId* row) {
    if ((rows_ + 1) * 2 > places_.size()) grow();
    std::uint64_t hash = 0;
    for (std::size_t i = 0; i < width_; ++i) hash = mixHash(hash, row[i]);
    std::size_t at = (hash >> 20) & (places_.size() - 1);
    while (places_[at] != 0) {
      const std::uint32_t found = places_[at] - 1;
      if (std::equal(row, row + width_, cells_.data() + found * width_)) return {found, false};
      at = (at + 1) & (places_.size() - 1);
    }
    places_[at] = static_cast<std::uint32_t>(++rows_);
    cells_.insert(cells_.end(), row, row + width_);
    return {static_cast<std::uint32_t>(rows_ - 1), true};
  }
  const ValueId* row(std::size_t number) const { return cells_.data() + number * width_; }
  std::size_t size() const { return rows_; }
  std::size_t bytes() const { return cells_.capacity() * sizeof(ValueId) + places_.size() * sizeof(std::uint32_t); }
  /// The bytes that the set may grow by when `rows` more come.
  std::size_t growthFor(std::size_t rows) const {
    const bool more_cells = cells_.size() + rows * width_ > cells_.capacity();
    const bool more_places = (rows_ + rows) * 2 > places_.size();
    return (more_cells ? 2 * cells_.capacity() * sizeof(ValueId) : 0) +
           (more_places ? 2 * places_.size() * sizeof(std::uint32_t) : 0);
  }
  void clear() {
    cells_ = {};
    places_ = {};
    rows_ = 0;
  }

 private:
  void grow() {
    places_.assign(std::max<std::size_t>(32, places_.size() * 2), 0);
    for (std::size_t number = 0; number < rows_; ++number) {
      std::uint64_t hash = 0;
      for (std::size_t i = 0; i < width_; ++i) hash = mixHash(hash, cells_[number * width_ + i]);
      std::size_t at = (hash >> 20) & (places_.size() - 1);
      while (places_[at] != 0) at = (at + 1) & (places_.size() - 1);
      places_[at] = static_cast<std::uint32_t>(number + 1);
    }
  }

  std::size_t width_;
  std::size_t rows_ = 0;
  std::vector<ValueId> cells_;
  std::vector<std::uint32_t> places_;
};

}  // namespace cluxel::sparql
