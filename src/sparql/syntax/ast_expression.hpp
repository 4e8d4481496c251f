// SPDX-License-Identifier: Apache-2.0
// Leaf parts of the syntax tree: variables, pattern terms, property paths and expressions.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::sparql::ast {

/// A byte offset in the request's text; `locate()` converts it to line and column.
using SourceOffset = std::uint32_t;

/// The index of a variable in the VariableTable of its query or update operation.
using VariableIndex = std::uint32_t;

struct Variable {
  std::string name;  ///< without ? or $; for a hidden variable a name that cannot be written ("_:label")
  /// True for a variable that replaces a blank node of a pattern or was created by the parser. Hidden variables do not
  /// appear in results or SELECT *.
  bool hidden = false;
};

/// All variables of one query or update operation. Sub-selects share the table: equal names have equal indices, even if
/// they are different variables by scope.
using VariableTable = std::vector<Variable>;

/// A variable or a term. Blank nodes of patterns are hidden variables; in templates of CONSTRUCT and INSERT, a blank
/// node is instantiated once per solution and label.
struct PatternTerm {
  std::variant<VariableIndex, Term> value;
  SourceOffset at = 0;

  bool isVariable() const { return value.index() == 0; }
  VariableIndex variable() const { return std::get<VariableIndex>(value); }
  const Term& term() const { return std::get<Term>(value); }
};

struct Path {
  enum class Kind : std::uint8_t {
    Link,         ///< iri
    Inverse,      ///< ^parts[0]
    Sequence,     ///< parts[0] / parts[1] / …
    Alternative,  ///< parts[0] | parts[1] | …
    ZeroOrMore,   ///< parts[0]*
    OneOrMore,    ///< parts[0]+
    ZeroOrOne,    ///< parts[0]?
    NegatedSet    ///< !(forward… | ^backward…); either list may be empty
  };
  Kind kind = Kind::Link;
  Term iri;
  std::vector<Path> parts;
  std::vector<Term> forward, backward;
  SourceOffset at = 0;
};

/// The built-in functions, without operators and aggregates. URI is Iri.
enum class Builtin : std::uint8_t {
  Str,
  Lang,
  LangMatches,
  Datatype,
  Bound,
  Iri,
  Bnode,
  Rand,
  Abs,
  Ceil,
  Floor,
  Round,
  Concat,
  Strlen,
  Ucase,
  Lcase,
  EncodeForUri,
  Contains,
  StrStarts,
  StrEnds,
  StrBefore,
  StrAfter,
  Year,
  Month,
  Day,
  Hours,
  Minutes,
  Seconds,
  Timezone,
  Tz,
  Now,
  Uuid,
  StrUuid,
  Md5,
  Sha1,
  Sha256,
  Sha384,
  Sha512,
  Coalesce,
  If,
  StrLang,
  StrDt,
  SameTerm,
  IsIri,
  IsBlank,
  IsLiteral,
  IsNumeric,
  Regex,
  Substr,
  Replace,
  Count_
};

enum class AggregateFunction : std::uint8_t { Count, Sum, Min, Max, Avg, Sample, GroupConcat };

struct GroupPattern;

struct Expression {
  enum class Kind : std::uint8_t {
    Variable,  ///< variable
    Constant,  ///< term: an IRI or a literal
    Or,
    And,  ///< two or more arguments
    Not,
    Equal,
    NotEqual,
    Less,
    Greater,
    LessEqual,
    GreaterEqual,
    In,
    NotIn,  ///< arguments[0] IN (arguments[1…])
    Add,
    Subtract,
    Multiply,
    Divide,  ///< two arguments
    Negate,
    Plus,
    Call,       ///< builtin(arguments…)
    Function,   ///< term is the function's IRI: a cast, a GeoSPARQL or extension function; `distinct` may be set
    Aggregate,  ///< aggregate([distinct] arguments[0]); COUNT(*) has no argument
    Exists,
    NotExists  ///< pattern
  };
  Kind kind = Kind::Constant;
  Builtin builtin = Builtin::Count_;
  AggregateFunction aggregate = AggregateFunction::Count;
  bool distinct = false;
  std::uint32_t height = 1;  ///< 1 + maximum height of the arguments; limited by the parser
  VariableIndex variable = 0;
  SourceOffset at = 0;
  Term term;
  std::vector<Expression> arguments;
  std::string separator = {};  ///< GROUP_CONCAT; " " when the query names none
  std::shared_ptr<const GroupPattern> pattern = {};
};

/// True when the expression contains an aggregate outside EXISTS.
bool hasAggregate(const Expression& expression);

/// The keyword of a built-in ("STRLEN") or aggregate ("GROUP_CONCAT").
std::string_view nameOf(Builtin builtin);
std::string_view nameOf(AggregateFunction aggregate);

}  // namespace cluxel::sparql::ast
