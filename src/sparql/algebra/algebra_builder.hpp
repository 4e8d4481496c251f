// SPDX-License-Identifier: Apache-2.0
// Translates the syntax tree to algebra.
#pragma once

#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "sparql/algebra/algebra.hpp"

namespace cluxel::sparql {

/// Maps variables to slots within one scope.
struct Scope {
  std::vector<Slot> slot_of;  ///< by VariableIndex; kNoSlot if not seen yet
  SlotSet substituted;        ///< bound by the solution outside an EXISTS; visible in every filter inside
  GraphPlace graph;
  bool fresh_slots = false;  ///< in a sub-select: new variables get new slots
};

class AlgebraBuilder {
 public:
  AlgebraBuilder(const ast::VariableTable& variables, std::string_view text, QueryTerms& terms,
                 const AlgebraOptions& options);

  NodePtr select(const ast::Select& select, Scope& scope, bool outermost);
  NodePtr group(const ast::GroupPattern& pattern, Scope& scope);
  /// Unbound where it can have no value; expression() also warns of it.
  Expr variable(const ast::Expression& written, Scope& scope, const SlotSet& visible);
  Expr expression(const ast::Expression& written, Scope& scope, const SlotSet& visible);
  Slot slotOf(ast::VariableIndex variable, Scope& scope);
  Scope outermostScope();
  AlgebraQuery finish(NodePtr root, const Scope& scope);

 private:
  struct GroupParts;
  struct SelectParts;
  /// Collects the aggregates in the expressions of a grouped SELECT.
  struct Aggregation {
    std::vector<AggregateSpec>* found = nullptr;
    const SlotSet* inner_visible = nullptr;
    Scope* scope = nullptr;
  };

  GroupParts groupParts(const ast::GroupPattern& pattern, Scope& scope);
  NodePtr filtered(NodePtr node, const std::vector<const ast::Expression*>& filters, Scope& scope);
  NodePtr element(const ast::PatternElement& element, Scope& scope);
  NodePtr triples(const ast::TriplesBlock& block, Scope& scope);
  NodePtr triple(const PatternPlace& subject, const PatternPlace& predicate, const PatternPlace& object, Scope& scope,
                 ast::SourceOffset at);
  NodePtr path(const PatternPlace& subject, const ast::Path& path, const PatternPlace& object, Scope& scope);
  NodePtr negatedSet(const PatternPlace& subject, const ast::Path& path, const PatternPlace& object, Scope& scope);
  CompiledPath compile(const ast::Path& path);
  NodePtr graphPattern(const ast::GraphPattern& pattern, Scope& scope);
  NodePtr values(const ast::InlineData& data, Scope& scope);
  NodePtr subSelect(const ast::SubSelect& sub, Scope& scope);
  NodePtr service(const ast::ServicePattern& service, ast::SourceOffset at, Scope& scope);
  NodePtr answered(const ast::ServicePattern& service, const rdf::QuadReader& reader, ast::SourceOffset at,
                   Scope& scope);
  void addGroupKeys(const ast::Select& select, Scope& scope, SlotSet& visible, SlotSet& inner_visible);
  SelectParts selectParts(const ast::Select& select, Scope& scope, const SlotSet& bound);
  NodePtr modified(NodePtr node, const ast::Select& select, std::vector<SortKey> sort_keys, Scope& scope,
                   bool outermost);
  void requireOneCut(const ast::Select& select, bool outermost) const;
  static NodePtr above(Node::Kind kind, NodePtr child, ast::SourceOffset at);
  NodePtr grouped(NodePtr node, const ast::Select& select, Scope& scope, std::vector<AggregateSpec>& aggregates);
  NodePtr unit(const Scope& scope);
  NodePtr join(NodePtr a, NodePtr b, const Scope& scope);
  NodePtr leftJoin(NodePtr node, const ast::GroupPattern& pattern, Scope& scope);
  NodePtr extend(NodePtr node, Slot slot, Expr expression, ast::SourceOffset at);
  Expr call(const ast::Expression& written, Scope& scope, const SlotSet& visible);
  Expr exists(const ast::Expression& written, Scope& scope, const SlotSet& visible);
  Expr aggregate(const ast::Expression& written);
  Expr unknownFunction(const ast::Expression& written, Scope& scope, const SlotSet& visible);
  void checkCall(const ast::Expression& written, const FunctionEntry& function);
  void checkRegex(const ast::Expression& written);
  void warn(ast::SourceOffset at, std::string message, std::string hint);
  PatternPlace place(const ast::PatternTerm& term, Scope& scope);
  Slot freshSlot(std::string name);
  bool isParameter(Slot slot) const { return parameters_.has(slot); }
  void countPart(ast::SourceOffset at);
  [[noreturn]] void fail(ast::SourceOffset at, std::string message, std::string hint = {},
                         Remedy remedy = Remedy::None) const;

  const ast::VariableTable& variables_;
  std::string_view text_;
  QueryTerms& terms_;
  const AlgebraOptions& options_;
  std::vector<std::string> slot_names_;
  SlotSet parameters_;
  std::vector<Slot> parameter_list_;
  std::size_t parts_ = 0;
  std::uint32_t exists_count_ = 0, service_count_ = 0;
  bool is_volatile_ = false;
  Aggregation aggregation_;
  std::vector<ExpressionWarning> warnings_;
};

}  // namespace cluxel::sparql
