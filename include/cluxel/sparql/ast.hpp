// SPDX-License-Identifier: Apache-2.0
// Syntax tree of SPARQL 1.1 Query and Update as plain values, with IRIs resolved, prefixes expanded and all notes of
// the grammar checked by the parser. It says what was written; the algebra says what it means.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cluxel/sparql/ast_expression.hpp"

namespace cluxel::ast {

/// subject predicate object, or subject path object. A path that is a single IRI is written as a predicate.
struct TriplePattern {
  PatternTerm subject;
  PatternTerm predicate;             ///< not used when there is a path
  std::shared_ptr<const Path> path;  ///< null for a plain triple pattern
  PatternTerm object;

  bool isPath() const { return path != nullptr; }
};

struct PatternElement;

/// { … }: the elements in the order written; filters stay where they stand and hold for the whole group.
struct GroupPattern {
  std::vector<PatternElement> elements;
  SourceOffset at = 0;
};

/// Triple patterns with nothing but FILTERs between them are one block (FILTER does not end a basic graph pattern; the
/// filters follow the block).
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

/// VALUES: every row has as many entries as there are variables; an absent entry is UNDEF.
struct InlineData {
  std::vector<VariableIndex> variables;
  std::vector<std::vector<std::optional<Term>>> rows;
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

/// The body that queries and sub-selects share.
struct Select {
  Duplicates duplicates = Duplicates::Keep;
  bool all = false;                    ///< SELECT *; the projection then lists the visible variables, by appearance
  std::vector<Projection> projection;  ///< empty for ASK, CONSTRUCT, DESCRIBE
  GroupPattern where;                  ///< empty for DESCRIBE without WHERE
  SolutionModifiers modifiers;
  std::optional<InlineData> values;  ///< the VALUES clause at the end
  bool grouped = false;              ///< GROUP BY, HAVING or an aggregate is there
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
  std::string text;      ///< the request with \\u code points decoded: what offsets count in
  std::string base_iri;  ///< BASE or the caller's; IRI("…") resolves against it
  VariableTable variables;
  DatasetClause dataset;
  Select select;                                  ///< where, modifiers and values of every form
  std::vector<TriplePattern> construct_template;  ///< no paths; CONSTRUCT WHERE has its pattern here too
  std::vector<PatternTerm> describe;              ///< what to describe
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

/// INSERT DATA or DELETE DATA. Blank nodes (INSERT DATA only) are fresh ones, the same label the same one in the
/// operation; the default graph is a graph term with an empty IRI.
struct DataUpdate {
  bool insert = true;
  std::vector<Quad> quads;
};

/// A quad of a template; without graph it goes to the default graph, or to the graph of WITH.
struct QuadTemplate {
  PatternTerm subject, predicate, object;
  std::optional<PatternTerm> graph;
};

/// [WITH] DELETE {…} INSERT {…} [USING…] WHERE {…}; DELETE WHERE has its pattern in both places.
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
  std::vector<UpdateOperation> operations;  ///< to be done in this order, as one transaction
};

}  // namespace cluxel::ast
