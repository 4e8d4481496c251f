// SPDX-License-Identifier: Apache-2.0
// The keywords of SPARQL and their case-insensitive lookup.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "sparql/syntax/ast_expression.hpp"

namespace cluxel::sparql {

enum class Keyword : std::uint8_t {
  None,
  A,
  Add,
  All,
  As,
  Asc,
  Ask,
  Base,
  Bind,
  By,
  Clear,
  Construct,
  Copy,
  Create,
  Data,
  Default,
  Delete,
  Desc,
  Describe,
  Distinct,
  Drop,
  Exists,
  False,
  Filter,
  From,
  Graph,
  Group,
  Having,
  In,
  Insert,
  Into,
  Limit,
  Load,
  Minus,
  Move,
  Named,
  Not,
  Offset,
  Optional,
  Order,
  Prefix,
  Reduced,
  Select,
  Separator,
  Service,
  Silent,
  To,
  True,
  Undef,
  Union,
  Using,
  Values,
  Where,
  With,
  FirstBuiltin,  ///< in the order of ast::Builtin
  LastBuiltin = FirstBuiltin + static_cast<int>(ast::Builtin::Count_) - 1,
  FirstAggregate,  ///< in the order of ast::AggregateFunction
  LastAggregate = FirstAggregate + 6
};

/// None when `word` is not a keyword. `a` is matched in lower case only. Cost: one hash lookup.
Keyword keywordOf(std::string_view word);

/// The keyword in upper case.
std::string_view nameOf(Keyword keyword);

std::optional<ast::Builtin> builtinOf(Keyword keyword);
std::optional<ast::AggregateFunction> aggregateOf(Keyword keyword);

}  // namespace cluxel::sparql
