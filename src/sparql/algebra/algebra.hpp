// SPDX-License-Identifier: Apache-2.0
// The SPARQL algebra (SPARQL 1.1 section 18) over numbered slots instead of variable names.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sparql/functions/functions.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::sparql {

/// The column of a variable in solutions. Variables of equal name in different scopes have different slots.
using Slot = std::uint32_t;
inline constexpr Slot kNoSlot = static_cast<Slot>(-1);

/// A set of slots as a bit set.
class SlotSet {
 public:
  bool has(Slot slot) const { return slot / 64 < words_.size() && (words_[slot / 64] >> (slot % 64) & 1) != 0; }
  void add(Slot slot);
  void add(const SlotSet& other);
  void remove(Slot slot);
  bool intersects(const SlotSet& other) const;
  bool contains(const SlotSet& other) const;
  bool empty() const;
  SlotSet operator&(const SlotSet& other) const;
  SlotSet operator-(const SlotSet& other) const;
  std::vector<Slot> list() const;  ///< ascending

 private:
  std::vector<std::uint64_t> words_;
};

struct Node;
using NodePtr = std::shared_ptr<Node>;

/// An expression over slots.
struct Expr {
  enum class Kind : std::uint8_t {
    Slot,
    Constant,
    Unbound /* a variable that cannot be bound here */,
    Or,
    And,
    Not,
    Equal,
    NotEqual,
    Less,
    Greater,
    LessEqual,
    GreaterEqual,
    In,
    NotIn,
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    Plus,
    Bound,
    Coalesce,
    If,
    Call,
    Exists,
    NotExists
  };
  Kind kind = Kind::Constant;
  Slot slot = kNoSlot;
  ast::SourceOffset at = 0;
  Value constant;
  const FunctionEntry* function = nullptr;
  std::vector<Expr> arguments;
  NodePtr pattern;           ///< of Exists
  std::uint32_t exists = 0;  ///< index of the Exists within its query

  SlotSet slots() const;  ///< all mentioned slots, including those in Exists patterns
  bool isVolatile() const;
};

/// One position of a triple pattern.
struct PatternPlace {
  Slot slot = kNoSlot;  ///< kNoSlot: constant
  ValueId constant = kUnbound;
  bool isSlot() const { return slot != kNoSlot; }
};

/// The graph that a pattern reads.
struct GraphPlace {
  enum class Kind : std::uint8_t { Default, Constant, Slot } kind = Kind::Default;
  Slot slot = kNoSlot;
  ValueId constant = kUnbound;
};

/// A property path after top-level sequences, alternatives and inverses have been rewritten to patterns.
struct CompiledPath {
  ast::Path::Kind kind = ast::Path::Kind::Link;
  ValueId iri = kUnbound;
  std::vector<CompiledPath> parts;
  std::vector<ValueId> forward, backward;  ///< of a negated set
  bool has_backward = false, has_forward = false;
  ast::SourceOffset at = 0;
};

struct TripleNode {
  PatternPlace subject, predicate, object;
  GraphPlace graph;
  std::shared_ptr<const CompiledPath> path;  ///< if null, `predicate` is used
  std::vector<ValueId> not_predicates;       ///< excluded predicates (negated property sets)
  ast::SourceOffset at = 0;
  ast::SourceOffset predicate_at = 0, object_at = 0;  ///< of names, for warnings about them
};

struct AggregateSpec {
  ast::AggregateFunction function = ast::AggregateFunction::Count;
  bool distinct = false;
  std::optional<Expr> argument;  ///< absent for COUNT(*)
  std::vector<Slot> row_slots;   ///< for COUNT(DISTINCT *): the variables of the solutions
  std::string separator;
  Slot result = kNoSlot;
};

struct SortKey {
  Expr expression;
  bool descending = false;
};

/// Rows of ids, one after the other.
struct IdRows {
  std::size_t count = 0;
  std::vector<ValueId> cells;  ///< row by row, one for each column; a table without columns may have rows

  void add(std::span<const ValueId> row) {
    cells.insert(cells.end(), row.begin(), row.end());
    ++count;
  }
};

struct Node {
  enum class Kind : std::uint8_t {
    Unit,        ///< one empty solution
    Nothing,     ///< no solution
    Triple,      ///< one triple or path pattern
    GraphNames,  ///< binds graph.slot to each named graph (or tests graph.constant)
    Join,        ///< children
    LeftJoin,    ///< children[0], children[1], condition
    Filter,      ///< children[0], conditions
    Union,       ///< children
    Minus,       ///< children[0], children[1]
    Extend,      ///< children[0], slot, expression
    Values,      ///< slots, rows
    Group,       ///< children[0], keys (slots), aggregates
    OrderBy,     ///< children[0], sort_keys
    Project,     ///< children[0], slots
    Distinct,    ///< children[0] (after Project)
    Slice,       ///< children[0], offset, limit
    GraphLoop    ///< children[0] once per named graph, with triple.graph.slot bound to it
  };
  Kind kind = Kind::Unit;
  ast::SourceOffset at = 0;
  std::vector<NodePtr> children;
  TripleNode triple;
  GraphPlace graph;
  std::vector<Expr> conditions;  ///< conjuncts of a Filter or a LeftJoin condition
  Slot slot = kNoSlot;
  std::optional<Expr> expression;
  std::vector<Slot> slots;
  IdRows rows;
  std::string note;  ///< Values: origin of the rows, shown in plans; empty for rows of the query text
  std::vector<AggregateSpec> aggregates;
  bool grouped_by_keys = false;  ///< explicit GROUP BY: empty input gives no group
  std::vector<SortKey> sort_keys;
  std::uint64_t offset = 0;
  std::optional<std::uint64_t> limit;
  Slot minus_ignores = kNoSlot;  ///< the variable of the surrounding GRAPH, which Minus ignores

  // Set by annotate().
  SlotSet possible, certain;  ///< bound in some solution, in every solution

  void annotate();            ///< the children must be annotated first
  SlotSet mentioned() const;  ///< in patterns and expressions of the whole subtree
};

NodePtr makeNode(Node::Kind kind, ast::SourceOffset at = 0);

/// Something in an expression that makes it an error for every solution.
struct ExpressionWarning {
  ast::SourceOffset at = 0;
  std::string message, hint;
};

struct AlgebraQuery {
  NodePtr root;
  std::vector<ExpressionWarning> warnings;  ///< in the order of the text, each message once
  std::vector<std::string> slot_names;      ///< by slot; names of internal slots begin with a dot
  std::vector<Slot> slot_of_variable;       ///< of the outermost scope, by VariableIndex
  std::vector<Slot> projection;             ///< columns of the result
  std::vector<Slot> parameters;             ///< slots bound from the start of a run
  std::uint32_t exists_count = 0;
  bool wants_one = false;    ///< ASK: stop at the first solution
  bool is_volatile = false;  ///< uses the clock, random numbers or fresh blank nodes
};

class Guard;

struct AlgebraOptions {
  std::vector<std::string> parameters = {};
  bool refuse_volatile = false;  ///< as in QueryOptions; unknown functions are errors, too
  std::string source_name = "query";
  std::map<std::string, const rdf::QuadReader*> services = {};  ///< as in QueryOptions
  Guard* guard = nullptr;  ///< accounts for the resources used by SERVICE; not null when there are services
};

/// Throws InputError for wrong argument counts, refused SERVICE and volatile functions.
AlgebraQuery buildAlgebra(const ast::Query& query, QueryTerms& terms, const AlgebraOptions& options);
/// As above, for the WHERE clause of an update.
AlgebraQuery buildAlgebra(const ast::GroupPattern& where, const ast::VariableTable& variables, const std::string& text,
                          QueryTerms& terms, const AlgebraOptions& options);

/// The text of an expression or pattern in query plans.
std::string describe(const Expr& expression, const AlgebraQuery& query, const QueryTerms& terms);
std::string describe(const TripleNode& triple, const AlgebraQuery& query, const QueryTerms& terms);

}  // namespace cluxel::sparql
