// SPDX-License-Identifier: Apache-2.0
// Keyword lookup in a hash table built at compile time.
#include "sparql/syntax/keywords.hpp"

#include <array>

namespace cluxel::sparql {

namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(Keyword::FirstBuiltin)> kStructureNames{
    "",         "A",        "ADD",       "ALL",    "AS",     "ASC",     "ASK",     "BASE",      "BIND",
    "BY",       "CLEAR",    "CONSTRUCT", "COPY",   "CREATE", "DATA",    "DEFAULT", "DELETE",    "DESC",
    "DESCRIBE", "DISTINCT", "DROP",      "EXISTS", "FALSE",  "FILTER",  "FROM",    "GRAPH",     "GROUP",
    "HAVING",   "IN",       "INSERT",    "INTO",   "LIMIT",  "LOAD",    "MINUS",   "MOVE",      "NAMED",
    "NOT",      "OFFSET",   "OPTIONAL",  "ORDER",  "PREFIX", "REDUCED", "SELECT",  "SEPARATOR", "SERVICE",
    "SILENT",   "TO",       "TRUE",      "UNDEF",  "UNION",  "USING",   "VALUES",  "WHERE",     "WITH"};
static_assert(kStructureNames.back() == "WITH");

constexpr std::array<std::string_view, static_cast<std::size_t>(ast::Builtin::Count_)> kBuiltinNames{
    "STR",       "LANG",      "LANGMATCHES", "DATATYPE", "BOUND",   "IRI",     "BNODE",    "RAND",           "ABS",
    "CEIL",      "FLOOR",     "ROUND",       "CONCAT",   "STRLEN",  "UCASE",   "LCASE",    "ENCODE_FOR_URI", "CONTAINS",
    "STRSTARTS", "STRENDS",   "STRBEFORE",   "STRAFTER", "YEAR",    "MONTH",   "DAY",      "HOURS",          "MINUTES",
    "SECONDS",   "TIMEZONE",  "TZ",          "NOW",      "UUID",    "STRUUID", "MD5",      "SHA1",           "SHA256",
    "SHA384",    "SHA512",    "COALESCE",    "IF",       "STRLANG", "STRDT",   "SAMETERM", "ISIRI",          "ISBLANK",
    "ISLITERAL", "ISNUMERIC", "REGEX",       "SUBSTR",   "REPLACE"};
constexpr std::array<std::string_view, 7> kAggregateNames{"COUNT", "SUM",    "MIN",         "MAX",
                                                          "AVG",   "SAMPLE", "GROUP_CONCAT"};

constexpr std::string_view nameOfNumber(std::size_t number) {
  constexpr std::size_t first_builtin = static_cast<std::size_t>(Keyword::FirstBuiltin);
  constexpr std::size_t first_aggregate = static_cast<std::size_t>(Keyword::FirstAggregate);
  if (number < kStructureNames.size()) return kStructureNames[number];
  if (number < first_aggregate) return kBuiltinNames[number - first_builtin];
  return kAggregateNames[number - first_aggregate];
}

constexpr std::size_t kTableSize = 512;

constexpr char upper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

constexpr std::size_t hashOf(std::string_view word) {
  std::uint32_t hash = 2166136261U;
  for (const char c : word) hash = (hash ^ static_cast<unsigned char>(upper(c))) * 16777619U;
  return (hash ^ (hash >> 15U)) % kTableSize;
}

struct Slot {
  std::string_view name;
  Keyword keyword = Keyword::None;
};

constexpr void insert(std::array<Slot, kTableSize>& table, std::string_view name, Keyword keyword) {
  std::size_t place = hashOf(name);
  while (table[place].keyword != Keyword::None) place = (place + 1) % kTableSize;
  table[place] = {name, keyword};
}

constexpr Keyword keywordOfBuiltin(ast::Builtin builtin) {
  return static_cast<Keyword>(static_cast<int>(Keyword::FirstBuiltin) + static_cast<int>(builtin));
}

constexpr std::array<Slot, kTableSize> makeTable() {
  std::array<Slot, kTableSize> table{};
  for (std::size_t i = 1; i <= static_cast<std::size_t>(Keyword::LastAggregate); ++i)
    insert(table, nameOfNumber(i), static_cast<Keyword>(i));
  insert(table, "URI", keywordOfBuiltin(ast::Builtin::Iri));
  insert(table, "ISURI", keywordOfBuiltin(ast::Builtin::IsIri));
  return table;
}

constexpr std::array<Slot, kTableSize> kTable = makeTable();

bool equalIgnoringCase(std::string_view word, std::string_view name) {
  if (word.size() != name.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (upper(word[i]) != name[i]) return false;
  return true;
}

}  // namespace

Keyword keywordOf(std::string_view word) {
  constexpr std::size_t kMaxLength = 14;
  if (word.size() > kMaxLength) return Keyword::None;
  for (std::size_t place = hashOf(word); kTable[place].keyword != Keyword::None; place = (place + 1) % kTableSize)
    if (equalIgnoringCase(word, kTable[place].name)) return word == "A" ? Keyword::None : kTable[place].keyword;
  return Keyword::None;
}

std::string_view nameOf(Keyword keyword) {
  return nameOfNumber(static_cast<std::size_t>(keyword));
}

std::optional<ast::Builtin> builtinOf(Keyword keyword) {
  if (keyword < Keyword::FirstBuiltin || keyword > Keyword::LastBuiltin) return std::nullopt;
  return static_cast<ast::Builtin>(static_cast<int>(keyword) - static_cast<int>(Keyword::FirstBuiltin));
}

std::optional<ast::AggregateFunction> aggregateOf(Keyword keyword) {
  if (keyword < Keyword::FirstAggregate || keyword > Keyword::LastAggregate) return std::nullopt;
  return static_cast<ast::AggregateFunction>(static_cast<int>(keyword) - static_cast<int>(Keyword::FirstAggregate));
}

std::string_view ast::nameOf(Builtin builtin) {
  return kBuiltinNames[static_cast<std::size_t>(builtin)];
}
std::string_view ast::nameOf(AggregateFunction aggregate) {
  return kAggregateNames[static_cast<std::size_t>(aggregate)];
}

}  // namespace cluxel::sparql
