// SPDX-License-Identifier: Apache-2.0
// Fills a ResultTable row by row, with each term kept once.
#pragma once

#include <map>
#include <string>

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

class ResultTableBuilder {
 public:
  explicit ResultTableBuilder(ResultTable& table) : table_(table) {}

  /// The column of a variable, npos when it was not announced.
  std::size_t columnOf(std::string_view variable) const {
    for (std::size_t i = 0; i < table_.variables.size(); ++i)
      if (table_.variables[i] == variable) return i;
    return std::string::npos;
  }
  void beginRow() {
    table_.cells.resize(table_.cells.size() + table_.variables.size(), 0);
    ++table_.row_count;
  }
  /// In the row begun last.
  void set(std::size_t column, const Term& term) {
    const auto [place, is_new] = cell_of_.try_emplace(term, static_cast<std::uint32_t>(table_.terms.size() + 1));
    if (is_new) table_.terms.push_back(term);
    table_.cells[table_.cells.size() - table_.variables.size() + column] = place->second;
  }

 private:
  ResultTable& table_;
  std::map<Term, std::uint32_t> cell_of_;
};

}  // namespace cluxel
