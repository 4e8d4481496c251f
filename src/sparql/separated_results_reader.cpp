// SPDX-License-Identifier: Apache-2.0
// Reads CSV and TSV results.
#include "cluxel/base/diagnostic.hpp"
#include "sparql/result_table_builder.hpp"
#include "sparql/results_format_readers.hpp"
#include "sparql/sparql_parser.hpp"

namespace cluxel {

namespace {

/// Cuts CSV (RFC 4180) or, without quoting, TSV into records.
std::vector<std::vector<std::string>> recordsOf(std::string_view text, char separator, bool quoting) {
  std::vector<std::vector<std::string>> records;
  for (std::size_t i = 0; i < text.size();) {
    std::vector<std::string>& record = records.emplace_back(1);
    bool quoted = false;
    for (; i < text.size() && (quoted || text[i] != '\n'); ++i) {
      const char c = text[i];
      const bool doubled = quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"';
      if (doubled)
        record.back() += text[++i];
      else if (quoting && c == '"')
        quoted = !quoted;
      else if (c == separator && !quoted)
        record.emplace_back();
      else if (c != '\r' || quoted)
        record.back() += c;
    }
    ++i;
  }
  return records;
}

using CellReader = Term (*)(const std::string& cell, const std::string& file);

QueryResult resultOf(const std::vector<std::vector<std::string>>& records, const std::string& file, CellReader read) {
  if (records.empty()) throw InputError({.file = file}, "there is no line with the variables' names");
  QueryResult result;
  const bool boolean =
      records.size() == 1 && records[0].size() == 1 && (records[0][0] == "true" || records[0][0] == "false");
  if (boolean) {
    result.kind = QueryResult::Kind::Boolean;
    result.boolean = records[0][0] == "true";
    return result;
  }
  if (records[0].size() > 1 || !records[0][0].empty())
    for (const std::string& name : records[0])
      result.table.variables.push_back(name.starts_with('?') ? name.substr(1) : name);
  ResultTableBuilder builder(result.table);
  const std::size_t width = std::max<std::size_t>(result.table.variables.size(), 1);
  for (std::size_t row = 1; row < records.size(); ++row) {
    if (records[row].size() != width)
      throw InputError({.file = file, .line = row + 1}, "this row has " + std::to_string(records[row].size()) +
                                                            " cells for " + std::to_string(width) + " columns");
    builder.beginRow();
    for (std::size_t column = 0; column < result.table.variables.size(); ++column)
      if (!records[row][column].empty()) builder.set(column, read(records[row][column], file));
  }
  return result;
}

Term csvTerm(const std::string& cell, const std::string&) {
  return cell.starts_with("_:") ? Term::blank(cell.substr(2)) : Term::literal(cell);
}

Term tsvTerm(const std::string& cell, const std::string& file) {
  SparqlParseOptions options;
  options.file = file;
  return SparqlParser(cell, options).singleTerm();
}

}  // namespace

QueryResult readCsvResults(std::string_view text, const std::string& file) {
  return resultOf(recordsOf(text, ',', true), file, &csvTerm);
}

QueryResult readTsvResults(std::string_view text, const std::string& file) {
  return resultOf(recordsOf(text, '\t', false), file, &tsvTerm);
}

}  // namespace cluxel
