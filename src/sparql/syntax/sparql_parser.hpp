// SPDX-License-Identifier: Apache-2.0
// The recursive descent parser of parseQuery() and parseUpdate(): about one method per grammar rule.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "sparql/syntax/lexer.hpp"
#include "sparql/syntax/parser.hpp"
#include "sparql/syntax/source_text.hpp"

namespace cluxel::sparql {

/// A set of variables in insertion order.
class VariableSet {
 public:
  void add(ast::VariableIndex variable);
  void addAll(const VariableSet& others);
  bool contains(ast::VariableIndex variable) const;
  const std::vector<ast::VariableIndex>& items() const { return items_; }

 private:
  std::vector<ast::VariableIndex> items_;
  std::unordered_set<ast::VariableIndex> index_;  ///< used for large sets only
};

class SparqlParser {
 public:
  SparqlParser(std::string_view text, const SparqlParseOptions& options);
  ast::Query query();
  ast::Update update();

 private:
  using Kind = TokenKind;
  using Triples = std::vector<ast::TriplePattern>;

  /// The kind of triples being parsed, which determines their permitted terms and the treatment of blank nodes.
  enum class NodeMode : std::uint8_t { Pattern, Template, DeleteTemplate, InsertData, DeleteData, DeleteWhere };
  enum class AggregateUse : std::uint8_t { Refused, Allowed, Inside };

  /// Counts the nesting depth in its scope.
  class Nested {
   public:
    explicit Nested(SparqlParser& parser);
    ~Nested() { --parser_.depth_; }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;

   private:
    SparqlParser& parser_;
  };

  // sparql_parser.cpp: tokens and errors
  void advance();
  Token peek() const { return lexer_.tokenAt(token_.end); }
  bool is(Kind kind) const { return token_.kind == kind; }
  bool is(Keyword keyword) const { return token_.kind == Kind::Word && token_.keyword == keyword; }
  bool take(Kind kind);
  bool take(Keyword keyword);
  void expect(Kind kind, std::string_view what);
  void expect(Keyword keyword);
  std::string_view slice(const Token& token) const {
    return source_.text().substr(token.begin, token.end - token.begin);
  }
  ast::SourceOffset here() const { return token_.begin; }
  [[noreturn]] void fail(std::uint32_t offset, std::string message, std::string hint = {}) const;
  [[noreturn]] void unexpected(std::string_view expected, std::initializer_list<Keyword> keywords = {}) const;
  std::string foundText() const;
  std::string hintFor(std::initializer_list<Keyword> keywords) const;

  // parse_terms.cpp: names, literals, variables, blank nodes
  void prologue();
  void baseDeclaration();
  void prefixDeclaration();
  bool isIri() const { return is(Kind::IriRef) || is(Kind::PrefixedName); }
  bool isTermStart() const;
  bool isNumberStart() const;
  std::string iriText();
  Term iri(std::string_view expected = "an IRI");
  std::string resolved(const Token& iri_ref) const;
  std::string expanded(const Token& name) const;
  [[noreturn]] void unknownPrefix(const Token& name, std::string_view prefix) const;
  Term literal();
  Term number();
  Term boolean();
  std::string stringValue();
  std::string unescaped(std::string_view body, std::uint32_t offset) const;
  ast::VariableIndex variable(std::string_view expected = "a variable");
  ast::VariableIndex variableNamed(std::string_view name);
  ast::VariableIndex hiddenVariable(std::string name);
  ast::PatternTerm blankNode(const Token& token);
  ast::PatternTerm freshBlankNode(std::uint32_t at);
  void requireBlankNodesAllowed(std::uint32_t at) const;
  ast::PatternTerm varOrTerm();
  ast::PatternTerm varOrIri(std::string_view expected);
  Term graphTerm();

  // parse_triples.cpp: triples, lists, property paths
  void triples(Triples& out);
  void triplesSameSubject(Triples& out);
  void propertyList(Triples& out, const ast::PatternTerm& subject);
  void objectList(Triples& out, const ast::TriplePattern& begun);
  bool isVerb() const;
  void verb(ast::TriplePattern& triple);
  bool isNodeStart() const;
  ast::PatternTerm graphNode(Triples& out, std::string_view expected);
  ast::PatternTerm collection(Triples& out);
  ast::PatternTerm blankNodePropertyList(Triples& out);
  ast::Path path();
  ast::Path pathSequence();
  ast::Path pathElementOrInverse();
  ast::Path pathElement();
  ast::Path pathPrimary();
  ast::Path negatedSet();
  void negatedSetMember(ast::Path& set);

  // parse_expression.cpp
  ast::Expression expression();
  ast::Expression binary(int min_rank);
  ast::Expression joined(ast::Expression::Kind kind, ast::Expression left, ast::Expression right);
  void addArgument(ast::Expression& parent, ast::Expression argument) const;
  ast::Expression unary();
  ast::Expression primary();
  ast::Expression bracketted();
  ast::Expression constraint(std::string_view expected);
  bool isConstraintStart() const;
  bool isCallStart() const;
  ast::Expression call();
  ast::Expression builtinCall(ast::Builtin builtin);
  ast::Expression aggregateCall(ast::AggregateFunction aggregate);
  void aggregateArguments(ast::Expression& aggregate);
  void separator(ast::Expression& aggregate);
  ast::Expression existsCall();
  ast::Expression iriOrFunction();
  void expressionList(ast::Expression& parent);
  ast::Expression membership(ast::Expression value, bool negated, ast::SourceOffset at);
  void requireAggregateAllowed(ast::SourceOffset at) const;

  // parse_pattern.cpp
  ast::GroupPattern group(VariableSet& visible);
  void groupElements(ast::GroupPattern& group, VariableSet& visible);
  void groupTriples(ast::TriplesBlock& block, VariableSet& visible);
  ast::PatternElement element(VariableSet& visible);
  ast::PatternElement groupOrUnion(VariableSet& visible);
  ast::PatternElement graph(VariableSet& visible);
  ast::PatternElement service(VariableSet& visible);
  ast::PatternElement minus();
  ast::PatternElement filter();
  ast::PatternElement bind(VariableSet& visible);
  ast::InlineData inlineData();
  std::vector<ast::VariableIndex> inlineVariables();
  void inlineRow(ast::InlineData& data);
  std::optional<Term> inlineValue();
  void addVisible(const ast::InlineData& data, VariableSet& visible) const;
  void addVisible(const ast::PatternTerm& term, VariableSet& visible) const;

  // parse_query.cpp
  void selectQuery(ast::Query& query);
  void constructQuery(ast::Query& query);
  Triples constructTemplate();
  void describeQuery(ast::Query& query);
  void askQuery(ast::Query& query);
  ast::DatasetClause datasetClause(Keyword keyword);
  void whereClause(ast::Select& select, VariableSet& visible);
  void solutionModifiers(ast::Select& select, const VariableSet& visible);
  void groupClause(ast::Select& select, const VariableSet& visible);
  ast::GroupCondition groupCondition(const VariableSet& visible);
  void orderClause(ast::Select& select);
  ast::OrderCondition orderCondition();
  void limitOffset(ast::SolutionModifiers& modifiers);
  std::uint64_t count(std::string_view expected);
  void selectClause(ast::Select& select);
  void selectItem(ast::Select& select);
  void finishSelect(ast::Select& select, const VariableSet& visible);
  void checkProjection(const ast::Select& select, const VariableSet& visible) const;
  void checkGrouping(const ast::Select& select) const;
  void requireGrouped(const ast::Expression& expression, const VariableSet& known) const;
  ast::PatternElement subSelect(VariableSet& visible);

  // parse_update.cpp
  ast::UpdateOperation updateOperation();
  ast::Load load();
  ast::GraphTarget graphRefAll();
  ast::GraphTarget graphOrDefault();
  Term graphRef();
  ast::Transfer transfer(ast::Transfer::Kind kind);
  ast::DataUpdate dataUpdate(bool insert);
  ast::Modify deleteWhere();
  ast::Modify modify();
  std::vector<ast::QuadTemplate> quadBlock(NodeMode mode);
  void quadTriples(std::vector<ast::QuadTemplate>& out, const std::optional<ast::PatternTerm>& graph);
  Quad groundQuad(ast::QuadTemplate quad) const;

  struct BlankNodeUse {
    std::uint32_t block;
    ast::VariableIndex variable;
  };

  const SparqlParseOptions& options_;
  SourceText source_;
  Lexer lexer_;
  Token token_;
  std::size_t depth_ = 0;

  std::string base_iri_;
  std::map<std::string, std::string, std::less<>> prefixes_;
  std::size_t tokens_ = 0;  ///< read so far
  ast::VariableTable variables_;
  std::unordered_map<std::string_view, ast::VariableIndex> variable_of_name_;

  NodeMode mode_ = NodeMode::Pattern;
  std::unordered_map<std::string_view, BlankNodeUse> blank_nodes_;  ///< of patterns, by label
  std::unordered_set<std::string_view> data_labels_;                ///< of earlier INSERT DATA of the request
  std::unordered_set<std::string_view> operation_labels_;           ///< of this INSERT DATA
  std::uint32_t block_ = 0;                                         ///< index of the current basic graph pattern
  std::uint32_t last_block_ = 0;
  std::uint32_t fresh_count_ = 0;
  AggregateUse aggregate_use_ = AggregateUse::Refused;
  bool saw_aggregate_ = false;
};

}  // namespace cluxel::sparql
