// SPDX-License-Identifier: Apache-2.0
// The functions of SPARQL on values: a function gets evaluated arguments, none of them an error, and gives a value or
// an error (a Value of type None).
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/sparql/ast_expression.hpp"
#include "sparql/query_terms.hpp"

namespace cluxel::sparql {

class RegexCache;
class GeometryCache;

/// What functions need beside their arguments; one per run of a query.
struct FunctionContext {
  explicit FunctionContext(QueryTerms& query_terms);
  ~FunctionContext();

  QueryTerms& terms;
  std::string base_iri = {};
  std::int64_t now_us = 0;
  std::mt19937_64 random;
  /// The number of the solution at hand and the labels that BNODE("x") gave for it.
  std::uint64_t solution = 0;
  std::map<std::string, std::string> solution_labels;
  std::uint64_t labels_of_solution = 0;
  std::uint64_t fresh_labels = 0;
  std::string label_prefix = {};  ///< makes fresh blank nodes differ from stored ones
  std::unique_ptr<RegexCache> regexes;
  std::unique_ptr<GeometryCache> geometries;

  std::string freshLabel();
};

using Arguments = std::span<const Value>;
using FunctionBody = Value (*)(Arguments arguments, FunctionContext& context);

struct FunctionEntry {
  std::string_view name;  ///< keyword of a built-in, or IRI
  std::size_t least_arguments = 1, most_arguments = 1;
  FunctionBody body = nullptr;
  bool is_volatile = false;  ///< not a function of its arguments alone
};

inline constexpr std::size_t kAnyNumber = static_cast<std::size_t>(-1);

/// Null for BOUND, COALESCE and IF, which need their arguments unevaluated.
const FunctionEntry* findBuiltin(ast::Builtin builtin);
/// Null for an unknown IRI.
const FunctionEntry* findFunction(std::string_view iri);
/// The IRIs of all functions, for suggestions.
std::vector<std::string> functionIris();

// Arithmetic of the operators: the type promotion of XPath; an error for what is not a number (or a time and a
// duration).
Value addValues(const Value& a, const Value& b, const QueryTerms& terms);
Value subtractValues(const Value& a, const Value& b, const QueryTerms& terms);
Value multiplyValues(const Value& a, const Value& b, const QueryTerms& terms);
Value divideValues(const Value& a, const Value& b, const QueryTerms& terms);
Value negateValue(const Value& value, const QueryTerms& terms);

/// xsd:string(value) and the like, by the local name of the target type.
Value castValue(std::string_view xsd_local, const Value& value, FunctionContext& context);

}  // namespace cluxel::sparql
