// SPDX-License-Identifier: Apache-2.0
// Reads the queries of `ask:`: adds prefixes, finds the bound names used as variables, and checks the syntax.
#include "rules/language/rule_reading.hpp"

#include "base/ascii.hpp"

namespace cluxel::rules {

namespace {

bool mentions(const std::string& query, const std::string& name) {
  auto isWordCharacter = [](char c) { return isAsciiAlphanumeric(c) || c == '_'; };
  for (std::size_t at = query.find(name); at != std::string::npos; at = query.find(name, at + 1)) {
    const bool variable = at > 0 && (query[at - 1] == '?' || query[at - 1] == '$');
    const std::size_t end = at + name.size();
    if (variable && (end == query.size() || !isWordCharacter(query[end]))) return true;
  }
  return false;
}

}  // namespace

void readQuery(const YamlNode& node, const NameScope& scope, RuleReading& reading, Condition& condition) {
  reading.asks_map = true;
  const auto text = readText(node, "a SPARQL ASK query", reading.faults);
  if (!text) return;
  for (const auto& [prefix, base] : reading.prefixes) condition.query += "PREFIX " + prefix + ": <" + base + ">\n";
  const std::size_t prologue = condition.query.size();
  condition.query += *text;
  for (const std::string& name : scope.names)
    if (mentions(*text, name)) condition.query_names.push_back(name);
  if (condition.query_names.empty())
    reading.faults.error(node.at, "the query asks about nothing that is bound here",
                         "use a bound name as a variable: ?" + condition.of);
  if (!reading.options.check_query) return;
  if (const auto fault = reading.options.check_query(condition.query, condition.query_names))
    reading.faults.error(node.at, "the query is faulty: " + fault->message,
                         fault->offset >= prologue ? "at '" + condition.query.substr(fault->offset, 20) + "'" : "");
  else if (reading.options.query_classes)
    condition.query_classes = reading.options.query_classes(condition.query);
}

}  // namespace cluxel::rules
