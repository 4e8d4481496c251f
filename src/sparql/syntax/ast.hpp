// SPDX-License-Identifier: Apache-2.0
// The syntax tree of SPARQL 1.1 Query and Update. The parser has resolved IRIs, expanded prefixes and checked the notes
// of the grammar.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sparql/syntax/ast_expression.hpp"

namespace cluxel::sparql::ast {

/// subject predicate object, or subject path object. A path of a single IRI is stored as a predicate.
struct TriplePattern {
  PatternTerm subject;
  PatternTerm predicate;             ///< not used when there is a path
  std::shared_ptr<const Path> path;  ///< null for a plain triple pattern
  PatternTerm object;

  bool isPath() const { return path != nullptr; }
};

struct PatternElement;

/// { … }: the elements in textual order. A filter applies to the whole group, wherever it occurs.
struct GroupPattern {
  std::vector<PatternElement> elements;
  SourceOffset at = 0;
};

/// A basic graph pattern. FILTER does not end it; filters between its triples follow the block.
struct TriplesBlock {
  std::vector<TriplePattern> triples;
};
struct OptionalPattern {
  GroupPattern group;
};
struct UnionPattern {
  std::vector<GroupPattern> branches;
};  ///< two or more
struct MinusPattern {
  GroupPattern group;
};
struct GraphPattern {
  PatternTerm graph;
  GroupPattern group;
};
struct ServicePattern {
  PatternTerm endpoint;
  GroupPattern group;
  bool silent = false;
};
struct Filter {
  Expression condition;
};
struct Bind {
  Expression expression;
  VariableIndex variable = 0;
};

/// VALUES, with all rows in one list, because there may be a million.
struct InlineData {
  std::vector<VariableIndex> variables;
  std::size_t row_count = 0;
  std::vector<std::optional<Term>> cells;  ///< row by row, one for each variable; an absent one is UNDEF
};

struct Select;
struct SubSelect {
  std::shared_ptr<const Select> select;
};

struct PatternElement {
  std::variant<TriplesBlock, GroupPattern, OptionalPattern, UnionPattern, MinusPattern, GraphPattern, ServicePattern,
               Filter, Bind, InlineData, SubSelect>
      value;
  SourceOffset at = 0;
};

/// One column: a variable, or (expression AS ?variable).
struct Projection {
  VariableIndex variable = 0;
  std::optional<Expression> expression;
  SourceOffset at = 0;
};

/// GROUP BY expression, or (expression AS ?as).
struct GroupCondition {
  Expression expression;
  std::optional<VariableIndex> as;
};

struct OrderCondition {
  Expression expression;
  bool descending = false;
};

struct SolutionModifiers {
  std::vector<GroupCondition> group_by;
  std::vector<Expression> having;
  std::vector<OrderCondition> order_by;
  std::optional<std::uint64_t> limit, offset;
};

enum class Duplicates : std::uint8_t { Keep, Distinct, Reduced };

/// The common part of queries and sub-selects.
struct Select {
  Duplicates duplicates = Duplicates::Keep;
  bool all = false;                    ///< SELECT *; the projection lists the visible variables in order of appearance
  std::vector<Projection> projection;  ///< empty for ASK, CONSTRUCT, DESCRIBE
  GroupPattern where;                  ///< empty for DESCRIBE without WHERE
  SolutionModifiers modifiers;
  std::optional<InlineData> values;  ///< the VALUES clause at the end
  bool grouped = false;              ///< has GROUP BY, HAVING or an aggregate
};

/// FROM and FROM NAMED, or USING and USING NAMED. Both empty: the store's own dataset.
struct DatasetClause {
  std::vector<Term> default_graphs = {}, named_graphs = {};
  SourceOffset at = 0;
  bool empty() const { return default_graphs.empty() && named_graphs.empty(); }
};

enum class QueryForm : std::uint8_t { Select, Construct, Describe, Ask };

struct Query {
  QueryForm form = QueryForm::Select;
  std::string text;      ///< the request with decoded \\u escapes; offsets refer to it
  std::string base_iri;  ///< from BASE or the caller; IRI("…") resolves against it
  VariableTable variables;
  DatasetClause dataset;
  Select select;                                  ///< where, modifiers and values of every form
  std::vector<TriplePattern> construct_template;  ///< no paths; CONSTRUCT WHERE has its pattern here too
  std::vector<PatternTerm> describe;              ///< the resources to describe
  bool describe_all = false;                      ///< DESCRIBE *; `describe` then lists the visible variables
};

/// A graph or group of graphs named by CLEAR, DROP, COPY …
struct GraphTarget {
  enum class Kind : std::uint8_t { Graph, Default, Named, All };
  Kind kind = Kind::Default;
  Term graph;  ///< for Graph
};

struct Load {
  bool silent = false;
  Term source;
  std::optional<Term> into;
};
struct Clear {
  bool silent = false;
  GraphTarget target;
};
struct Drop {
  bool silent = false;
  GraphTarget target;
};
struct Create {
  bool silent = false;
  Term graph;
};

/// ADD, MOVE and COPY: kinds Graph or Default only.
struct Transfer {
  enum class Kind : std::uint8_t { Add, Move, Copy };
  Kind kind = Kind::Add;
  bool silent = false;
  GraphTarget from, to;
};

/// INSERT DATA or DELETE DATA. Blank nodes (INSERT DATA only) are fresh; equal labels within the operation denote one
/// node. The default graph is a graph term with an empty IRI.
struct DataUpdate {
  bool insert = true;
  std::vector<Quad> quads;
};

/// A quad of a template; without a graph it refers to the default graph, or to the graph of WITH.
struct QuadTemplate {
  PatternTerm subject, predicate, object;
  std::optional<PatternTerm> graph;
};

/// [WITH] DELETE {…} INSERT {…} [USING…] WHERE {…}; DELETE WHERE stores its pattern in both fields.
struct Modify {
  std::optional<Term> with;  ///< for templates, and for `where` when `using_clause` is empty
  std::vector<QuadTemplate> remove, insert;
  DatasetClause using_clause;
  GroupPattern where;
};

struct UpdateOperation {
  std::variant<Load, Clear, Drop, Create, Transfer, DataUpdate, Modify> value;
  VariableTable variables;
  std::string base_iri;  ///< BASE in force at the operation
  SourceOffset at = 0;
};

struct Update {
  std::string text;
  std::vector<UpdateOperation> operations;  ///< executed in this order, in one transaction
};

}  // namespace cluxel::sparql::ast
