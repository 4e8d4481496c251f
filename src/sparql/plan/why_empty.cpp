// SPDX-License-Identifier: Apache-2.0
// Explains an empty result: finds the smallest part of the pattern without a solution.
#include <algorithm>

#include "sparql/exec/prepared_query.hpp"
#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

/// Searches for the smallest part of a pattern that has no solution on its own.
class EmptinessSearch {
 public:
  explicit EmptinessSearch(PreparedQuery::Impl& query) : query_(query) {}

  std::string explain(const NodePtr& node) {
    if (!isEmpty(*node)) return {};
    return blame(node);
  }

 private:
  bool isEmpty(const Node& node) {
    const auto plan = Planner(query_.algebra, query_.terms, query_.dataset).planAlone(node);
    Runtime runtime(query_.reader, query_.terms, query_.functions, query_.dataset, query_.algebra.slot_names.size(),
                    query_.algebra.exists_count);
    runtime.guard.start(query_.options.budget);
    std::copy(query_.runtime->parameters.begin(), query_.runtime->parameters.end(), runtime.parameters.begin());
    plan->open(runtime, true);
    Batch batch(runtime.slot_count);
    return !plan->next(batch);
  }

  std::string place(ast::SourceOffset at) const {
    const SourceLocation location = locate(query_.options.source_name, query_.query.text, at);
    return " (line " + std::to_string(location.line) + ")";
  }

  /// Precondition: `node` has no solution.
  std::string blame(const NodePtr& node) {
    switch (node->kind) {
      case Node::Kind::Triple:
        return "nothing in the map fits the pattern  " + describe(node->triple, query_.algebra, query_.terms) +
               place(node->triple.at) + unknownNames(*node);
      case Node::Kind::Filter:
        return blameFilter(node);
      case Node::Kind::Join:
        return blameJoin(node);
      case Node::Kind::Minus:
        if (isEmpty(*node->children[0])) return blame(node->children[0]);
        return "MINUS removes every solution" + place(node->children[1]->at);
      case Node::Kind::Union:
        return "no branch of the UNION has a solution; the first: " + blame(node->children[0]);
      case Node::Kind::GraphNames:
        return "no such named graph";
      case Node::Kind::Values:
        return "VALUES has no row";
      case Node::Kind::Slice:
        if (!isEmpty(*node->children[0])) return "OFFSET or LIMIT leaves nothing";
        return blame(node->children[0]);
      case Node::Kind::Unit:
      case Node::Kind::Nothing:
        return "the pattern has no solution";
      default:
        break;
    }
    return node->children.empty() ? "the pattern has no solution" : blame(node->children[0]);
  }

  std::string blameFilter(const NodePtr& node) {
    if (isEmpty(*node->children[0])) return blame(node->children[0]);
    Node part = *node;
    part.conditions.clear();
    for (const Expr& condition : node->conditions) {
      part.conditions.push_back(condition);
      if (isEmpty(part)) {
        return "no solution passes FILTER  " + describe(condition, query_.algebra, query_.terms) + place(condition.at);
      }
    }
    return "no solution passes the FILTERs together";
  }

  /// Adds the parts in textual order and reports the first that makes the result empty.
  std::string blameJoin(const NodePtr& node) {
    for (const NodePtr& child : node->children) {
      if (isEmpty(*child)) return blame(child);
    }
    Node part = *node;
    part.children.clear();
    for (const NodePtr& child : node->children) {
      part.children.push_back(child);
      part.annotate();
      if (part.children.size() > 1 && isEmpty(part)) {
        const std::string what = child->kind == Node::Kind::Triple
                                     ? describe(child->triple, query_.algebra, query_.terms) + place(child->triple.at)
                                     : "the part" + place(child->at);
        return "each pattern has matches, but none is left when the patterns before are joined with  " + what;
      }
    }
    return "the patterns have no solution together";
  }

  std::string unknownNames(const Node& node) const {
    std::string text;
    for (const PatternPlace* at : {&node.triple.subject, &node.triple.predicate, &node.triple.object}) {
      if (at->isSlot() || at->constant < kFirstComputed || at->constant == kUnbound) continue;
      text += "; the map does not know " + toNTriples(query_.terms.termOf(at->constant));
    }
    return text;
  }

  PreparedQuery::Impl& query_;
};

}  // namespace

std::string whyEmpty(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options,
                     const std::vector<Binding>& bindings) {
  std::vector<std::string> names;
  for (const Binding& binding : bindings) names.push_back(binding.first);
  PreparedQuery::Impl query(reader, text, options, names);
  query.setParameters(bindings);
  return EmptinessSearch(query).explain(query.algebra.root);
}

}  // namespace cluxel::sparql
