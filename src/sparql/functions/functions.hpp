// SPDX-License-Identifier: Apache-2.0
// SPARQL functions on values. Arguments are evaluated and not errors; the result is a value or an error (a Value of
// type None).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"
#include "sparql/exec/query_terms.hpp"
#include "sparql/syntax/ast_expression.hpp"

namespace cluxel::sparql {

/// The size limit of computed strings: repeated doubling would exhaust memory.
inline constexpr std::size_t kMaxTextBytes = std::size_t{64} << 20;

/// Throws Error (BudgetExceeded) above kMaxTextBytes.
inline void requireTextSize(std::size_t bytes) {
  if (bytes > kMaxTextBytes) throw Error(ErrorKind::BudgetExceeded, "query: a string exceeds 64 MiB");
}

class RegexCache;
class GeometryCache;

/// The context of function calls; one per run of a query.
struct FunctionContext {
  explicit FunctionContext(QueryTerms& query_terms);
  ~FunctionContext();

  QueryTerms& terms;
  std::string base_iri = {};
  std::int64_t now_us = 0;
  std::mt19937_64 random;
  /// The number of the current solution, and its blank node labels of BNODE("x").
  std::uint64_t solution = 0;
  std::map<std::string, std::string> solution_labels;
  std::uint64_t labels_of_solution = 0;
  std::uint64_t fresh_labels = 0;
  std::string label_prefix = {};  ///< distinguishes fresh blank nodes from stored ones
  std::unique_ptr<RegexCache> regexes;
  std::unique_ptr<GeometryCache> geometries;

  std::set<std::string> notes = {};  ///< what a person should know about the values of this run

  std::string freshLabel();
  void note(std::string_view text);
};

using Arguments = std::span<const Value>;
using FunctionBody = Value (*)(Arguments arguments, FunctionContext& context);

struct FunctionEntry {
  std::string_view name;  ///< keyword of a built-in, or IRI
  std::size_t min_arguments = 1, max_arguments = 1;
  FunctionBody body = nullptr;
  bool is_volatile = false;  ///< not a pure function of its arguments
};

inline constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);

/// Null for BOUND, COALESCE and IF, which need their arguments unevaluated.
const FunctionEntry* findBuiltin(ast::Builtin builtin);
/// Null for an unknown IRI.
const FunctionEntry* findFunction(std::string_view iri);
/// The IRIs of all functions, for suggestions in messages.
std::vector<std::string> functionIris();

// Arithmetic operators with XPath type promotion; an error for operands other than numbers, or times and durations.
Value addValues(const Value& a, const Value& b, const QueryTerms& terms);
Value subtractValues(const Value& a, const Value& b, const QueryTerms& terms);
Value multiplyValues(const Value& a, const Value& b, const QueryTerms& terms);
Value divideValues(const Value& a, const Value& b, const QueryTerms& terms);
Value negateValue(const Value& value, const QueryTerms& terms);

/// Casts such as xsd:string(value), by the local name of the target type.
Value castValue(std::string_view xsd_local, const Value& value, FunctionContext& context);

}  // namespace cluxel::sparql
