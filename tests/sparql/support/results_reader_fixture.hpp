// SPDX-License-Identifier: Apache-2.0
// Reads results in the W3C formats, to compare engines and to test that written results read back the same.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "sparql/results/result_table.hpp"
#include "sparql/results/result_writer.hpp"

namespace cluxel::test {

/// Fills a result table row by row and stores each distinct term once.
class ResultTableBuilder {
 public:
  explicit ResultTableBuilder(sparql::ResultTable& table) : table_(table) {}

  /// The column of a variable; npos when the head does not name it.
  std::size_t columnOf(std::string_view variable) const {
    for (std::size_t i = 0; i < table_.variables.size(); ++i)
      if (table_.variables[i] == variable) return i;
    return std::string::npos;
  }
  void beginRow() {
    table_.cells.resize(table_.cells.size() + table_.variables.size(), 0);
    ++table_.row_count;
  }
  /// Sets a cell of the last row.
  void set(std::size_t column, const Term& term) {
    const auto [place, is_new] = cell_of_.try_emplace(term, static_cast<std::uint32_t>(table_.terms.size() + 1));
    if (is_new) table_.terms.push_back(term);
    table_.cells[table_.cells.size() - table_.variables.size() + column] = place->second;
  }

 private:
  sparql::ResultTable& table_;
  std::map<Term, std::uint32_t> cell_of_;
};

/// The text of a collected result.
std::string writtenResult(const sparql::QueryResult& result, sparql::ResultFormat format,
                          const sparql::WriterOptions& options = {});

/// Reads JSON, XML, CSV or TSV. CSV loses the kind of term: a cell becomes a blank node (`_:x`) or a plain literal, an
/// empty cell is unbound. Throws InputError with the location of the fault, Error (InvalidArgument) for other formats.
sparql::QueryResult readResults(std::string_view text, sparql::ResultFormat format,
                                const std::string& file = "results");

/// Reads results in the result set vocabulary of the W3C test suites (rs:ResultSet, rs:solution, …). Throws InputError
/// when `graph` contains no result set.
sparql::QueryResult resultsFromGraph(const std::vector<Quad>& graph, const std::string& file = "results");

}  // namespace cluxel::test
