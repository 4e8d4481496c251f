// SPDX-License-Identifier: Apache-2.0
// What a query does, why it found nothing, and names that the store does not know.
#include <algorithm>
#include <cmath>
#include <map>

#include "cluxel/base/nearest_name.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "sparql/planner.hpp"
#include "sparql/prepared_query.hpp"

namespace cluxel {
namespace {

using sparql::Node;
using sparql::NodePtr;
using sparql::Operator;
using sparql::PatternPlace;

std::string rounded(double rows) { return std::to_string(static_cast<long long>(std::llround(std::min(rows, 1e18)))); }

void printPlan(const Operator& plan, const sparql::PlanNames& names, bool has_run, std::size_t depth, std::string& out) {
  std::string line = std::string(depth * 2, ' ') + plan.label(names);
  constexpr std::size_t kColumn = 72;
  line += std::string(line.size() + 2 < kColumn ? kColumn - line.size() : 2, ' ');
  line += "estimated " + rounded(plan.estimated_rows);
  if (has_run) line += ", actual " + std::to_string(plan.actualRows());
  out += line + "\n";
  for (const Operator* input : plan.inputs()) printPlan(*input, names, has_run, depth + 1, out);
}

/// Finds the smallest part of a pattern that has no solution by itself.
class EmptinessSearch {
 public:
  explicit EmptinessSearch(PreparedQuery::Impl& query) : query_(query) {}

  std::string explain(const NodePtr& node) {
    if (!isEmpty(*node)) return {};
    return blame(node);
  }

 private:
  bool isEmpty(const Node& node) {
    const auto plan = sparql::Planner(query_.algebra, query_.reader, query_.dataset).planAlone(node);
    sparql::Runtime runtime(query_.reader, query_.terms, query_.functions, query_.dataset, query_.algebra.slot_names.size(),
                            query_.algebra.exists_count);
    runtime.guard.start(query_.options.budget);
    plan->open(runtime, true);
    sparql::Batch batch(runtime.slot_count);
    return !plan->next(batch);
  }

  std::string place(ast::SourceOffset at) const {
    const SourceLocation location = locate(query_.options.source_name, query_.query.text, at);
    return " (line " + std::to_string(location.line) + ")";
  }

  /// `node` is known to be empty.
  std::string blame(const NodePtr& node) {
    switch (node->kind) {
      case Node::Kind::Triple:
        return "nothing in the map fits the pattern  " + sparql::describe(node->triple, query_.algebra, query_.terms) +
               place(node->triple.at) + unknownNames(*node);
      case Node::Kind::Filter: return blameFilter(node);
      case Node::Kind::Join: return blameJoin(node);
      case Node::Kind::Minus:
        if (isEmpty(*node->children[0])) return blame(node->children[0]);
        return "MINUS removes every solution" + place(node->children[1]->at);
      case Node::Kind::Union: return "no branch of the UNION has a solution; the first: " + blame(node->children[0]);
      case Node::Kind::GraphNames: return "no such named graph";
      case Node::Kind::Values: return "VALUES has no row";
      case Node::Kind::Slice:
        if (!isEmpty(*node->children[0])) return "OFFSET or LIMIT leaves nothing";
        return blame(node->children[0]);
      case Node::Kind::Unit:
      case Node::Kind::Nothing: return "the pattern has no solution";
      default: break;
    }
    return node->children.empty() ? "the pattern has no solution" : blame(node->children[0]);
  }

  std::string blameFilter(const NodePtr& node) {
    if (isEmpty(*node->children[0])) return blame(node->children[0]);
    Node part = *node;
    part.conditions.clear();
    for (const sparql::Expr& condition : node->conditions) {
      part.conditions.push_back(condition);
      if (isEmpty(part)) {
        return "no solution passes FILTER  " + sparql::describe(condition, query_.algebra, query_.terms) + place(condition.at);
      }
    }
    return "no solution passes the FILTERs together";
  }

  /// Adds the parts one by one, in the order written: the first that leaves nothing is named.
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
                                     ? sparql::describe(child->triple, query_.algebra, query_.terms) + place(child->triple.at)
                                     : "the part" + place(child->at);
        return "each pattern has matches, but none is left when the patterns before are joined with  " + what;
      }
    }
    return "the patterns have no solution together";
  }

  std::string unknownNames(const Node& node) const {
    std::string text;
    for (const PatternPlace* at : {&node.triple.subject, &node.triple.predicate, &node.triple.object}) {
      if (at->isSlot() || at->constant < sparql::kFirstComputed || at->constant == sparql::kUnbound) continue;
      text += "; the map does not know " + toNTriples(query_.terms.termOf(at->constant));
    }
    return text;
  }

  PreparedQuery::Impl& query_;
};

/// IRIs of one kind that the store knows, looked for when one is unknown.
std::vector<std::string> knownPredicates(const QuadReader& reader) {
  std::vector<std::string> names;
  for (const TermId id : reader.predicates()) names.push_back(reader.termOf(id).text);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> knownClasses(const QuadReader& reader) {
  std::vector<TermId> ids;
  const auto collect = [&](const std::string& predicate, std::optional<std::string> object) {
    QuadPattern pattern;
    pattern.p = reader.idOf(Term::iri(predicate));
    if (object) pattern.o = reader.idOf(Term::iri(*object));
    if (!pattern.p || (object && !pattern.o)) return;
    QuadCursor cursor = reader.scan(pattern, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);) {
      const TermId id = object ? quad.s : quad.o;
      if (ids.empty() || ids.back() != id) ids.push_back(id);
    }
  };
  collect(vocabulary::rdf("type"), std::nullopt);
  collect(vocabulary::rdf("type"), std::string(vocabulary::kOwl) + "Class");
  std::vector<std::string> names;
  for (const TermId id : ids) {
    const Term term = reader.termOf(id);
    if (term.kind == TermKind::Iri) names.push_back(term.text);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

class NameCheck {
 public:
  explicit NameCheck(PreparedQuery::Impl& query) : query_(query) {}

  std::vector<Diagnostic> run() {
    visit(*query_.algebra.root);
    return std::move(found_);
  }

 private:
  void visit(const Node& node) {
    if (node.kind == Node::Kind::Triple) visitTriple(node.triple);
    for (const NodePtr& child : node.children) visit(*child);
    for (const sparql::Expr& condition : node.conditions) visit(condition);
    if (node.expression) visit(*node.expression);
  }
  void visit(const sparql::Expr& expression) {
    if (expression.pattern) visit(*expression.pattern);
    for (const sparql::Expr& argument : expression.arguments) visit(argument);
  }
  void visit(const sparql::CompiledPath& path, ast::SourceOffset at) {
    warnPredicate(path.iri, at);
    for (const auto& part : path.parts) visit(part, at);
  }
  void visitTriple(const sparql::TripleNode& triple) {
    if (triple.path) visit(*triple.path, triple.at);
    if (!triple.path && !triple.predicate.isSlot()) warnPredicate(triple.predicate.constant, triple.at);
    if (triple.graph.kind == sparql::GraphPlace::Kind::Constant && triple.graph.constant >= sparql::kFirstComputed) {
      warn("graph", triple.graph.constant, triple.at, graphNames());
    }
    const bool is_type = !triple.path && !triple.predicate.isSlot() &&
                         textOf(triple.predicate.constant) == vocabulary::rdf("type");
    if (is_type && !triple.object.isSlot() && triple.object.constant >= sparql::kFirstComputed) {
      warn("class", triple.object.constant, triple.at, knownClasses(query_.reader));
    }
  }
  void warnPredicate(sparql::ValueId id, ast::SourceOffset at) {
    if (id >= sparql::kFirstComputed) warn("property", id, at, knownPredicates(query_.reader));
  }
  std::string textOf(sparql::ValueId id) const { return query_.terms.termOf(id).text; }
  std::vector<std::string> graphNames() const {
    std::vector<std::string> names;
    for (const TermId graph : query_.dataset.named) names.push_back(query_.reader.termOf(graph).text);
    std::sort(names.begin(), names.end());
    return names;
  }
  void warn(const std::string& what, sparql::ValueId id, ast::SourceOffset at, const std::vector<std::string>& known) {
    const std::string name = textOf(id);
    if (!warned_.emplace(name, true).second) return;
    // Names differ at their end: the namespaces are compared by the whole, the suggestion by the local part.
    const std::size_t cut = name.find_last_of("#/") == std::string::npos ? 0 : name.find_last_of("#/") + 1;
    std::vector<std::string> locals;
    for (const std::string& iri : known) {
      if (iri.starts_with(std::string_view(name).substr(0, cut))) locals.push_back(iri.substr(cut));
    }
    Diagnostic diagnostic;
    diagnostic.severity = Severity::Warning;
    diagnostic.location = locate(query_.options.source_name, query_.query.text, at);
    diagnostic.message = "the map has no " + what + " <" + name + ">";
    diagnostic.hint = suggestion(std::string_view(name).substr(cut), locals);
    diagnostic.source_line = std::string(lineOf(query_.query.text, diagnostic.location.line));
    found_.push_back(std::move(diagnostic));
  }

  PreparedQuery::Impl& query_;
  std::vector<Diagnostic> found_;
  std::map<std::string, bool> warned_;
};

/// Takes an answer and forgets it.
class NoSink : public ResultSink {
 public:
  void beginSolutions(std::span<const std::string>, const TermLookup&) override {}
  void rows(std::span<const ResultId>, std::size_t) override {}
  void boolean(bool) override {}
  void beginGraph() override {}
  void triple(const TermView&, const TermView&, const TermView&) override {}
  void end() override {}
};

}  // namespace

std::string PreparedQuery::explain() const {
  std::string out;
  printPlan(*impl_->plan, {impl_->algebra, impl_->terms}, impl_->has_run, 0, out);
  return out;
}

std::string explainQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options) {
  PreparedQuery query(reader, text, options);
  NoSink sink;
  query.run(sink);
  return query.explain();
}

std::string whyEmpty(const QuadReader& reader, std::string_view text, const QueryOptions& options) {
  PreparedQuery::Impl query(reader, text, options, {});
  return EmptinessSearch(query).explain(query.algebra.root);
}

std::vector<Diagnostic> checkQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options) {
  PreparedQuery::Impl query(reader, text, options, {});
  return NameCheck(query).run();
}

}  // namespace cluxel
