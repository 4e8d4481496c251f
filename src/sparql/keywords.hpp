// SPDX-License-Identifier: Apache-2.0
// The words of SPARQL and how to find them, whatever their case.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "cluxel/sparql/ast_expression.hpp"

namespace cluxel {

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
  FirstBuiltin,  ///< as ast::Builtin is ordered
  LastBuiltin = FirstBuiltin + static_cast<int>(ast::Builtin::Count_) - 1,
  FirstAggregate,  ///< as ast::AggregateFunction is ordered
  LastAggregate = FirstAggregate + 6
};

/// None when `word` is no keyword. `a` is one in lower case only. Cost: one hash.
Keyword keywordOf(std::string_view word);

/// The keyword in capitals, as it is usually written.
std::string_view nameOf(Keyword keyword);

std::optional<ast::Builtin> builtinOf(Keyword keyword);
std::optional<ast::AggregateFunction> aggregateOf(Keyword keyword);

}  // namespace cluxel
