// SPDX-License-Identifier: Apache-2.0
// Reads SPARQL 1.1 Query Results JSON.
#include <nlohmann/json.hpp>

#include "cluxel/base/diagnostic.hpp"
#include "sparql/result_table_builder.hpp"
#include "sparql/results_format_readers.hpp"

namespace cluxel {

namespace {

using nlohmann::json;

Term termOf(const json& value) {
  const std::string type = value.at("type");
  const std::string text = value.at("value");
  if (type == "uri") return Term::iri(text);
  if (type == "bnode") return Term::blank(text);
  if (type != "literal" && type != "typed-literal") throw std::invalid_argument("unknown type of term '" + type + "'");
  if (value.contains("xml:lang")) return Term::langLiteral(text, value["xml:lang"].get<std::string>());
  if (value.contains("datatype")) return Term::literal(text, value["datatype"].get<std::string>());
  return Term::literal(text);
}

QueryResult resultOf(const json& document) {
  QueryResult result;
  if (document.contains("boolean")) {
    result.kind = QueryResult::Kind::Boolean;
    result.boolean = document["boolean"];
    return result;
  }
  result.table.variables = document.at("head").at("vars").get<std::vector<std::string>>();
  ResultTableBuilder builder(result.table);
  for (const json& row : document.at("results").at("bindings")) {
    builder.beginRow();
    for (const auto& [variable, value] : row.items()) {
      const std::size_t column = builder.columnOf(variable);
      if (column == std::string::npos) throw std::invalid_argument("the head does not name '" + variable + "'");
      builder.set(column, termOf(value));
    }
  }
  return result;
}

}  // namespace

QueryResult readJsonResults(std::string_view text, const std::string& file) {
  try {
    return resultOf(json::parse(text));
  } catch (const std::exception& fault) {
    throw InputError({.file = file}, std::string("no SPARQL results in JSON: ") + fault.what());
  }
}

}  // namespace cluxel
