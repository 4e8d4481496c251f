// SPDX-License-Identifier: Apache-2.0
// Walks the syntax tree of a query once, group by group.
#include "mapping/facts/query_names.hpp"

#include <algorithm>
#include <set>

#include "base/nearest_name.hpp"
#include "base/yaml/fault_list.hpp"
#include "rdf/iri.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::mapping {

namespace {

namespace ast = sparql::ast;
using Variables = std::set<ast::VariableIndex>;

class QueryNameCheck {
 public:
  QueryNameCheck(const ast::Query& query, const rdf::OntologyView& ontology, std::span<const std::string> bound)
      : query_(query), ontology_(ontology) {
    for (const rdf::OntologyProperty& property : ontology.properties) properties_.push_back(property.iri);
    for (ast::VariableIndex i = 0; i < query.variables.size(); ++i)
      if (std::find(bound.begin(), bound.end(), query.variables[i].name) != bound.end()) bound_.insert(i);
  }

  const std::optional<QueryNameFault>& history() const { return history_; }
  const std::set<std::string>& classes() const { return classes_; }

  std::vector<QueryNameFault> run() {
    for (const ast::TriplePattern& triple : query_.construct_template) names(triple);
    group(query_.select.where, bound_);
    const std::vector<Term>& merged = query_.dataset.default_graphs;
    const std::vector<Term>& named = query_.dataset.named_graphs;
    for (const std::vector<Term>* graphs : {&merged, &named})
      if (std::any_of(graphs->begin(), graphs->end(), isHistory)) addHistory(query_.dataset.at);
    std::sort(faults_.begin(), faults_.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    return std::move(faults_);
  }

 private:
  static bool isOwn(const ast::PatternTerm& term) {
    return !term.isVariable() && term.term().kind == TermKind::Iri &&
           term.term().text.starts_with(rdf::vocabulary::kClx);
  }

  void lookUp(const ast::PatternTerm& term, const std::vector<std::string>& known, const char* what) {
    if (!isOwn(term) || std::find(known.begin(), known.end(), term.term().text) != known.end()) return;
    std::vector<std::string> names;
    for (const std::string& iri : known)
      if (iri.starts_with(rdf::vocabulary::kClx)) names.push_back(rdf::localName(iri));
    const std::string hint = suggestion(rdf::localName(term.term().text), names);
    faults_.push_back({term.at, "the ontology knows no " + std::string(what) +
                                    " clx:" + rdf::localName(term.term().text) +
                                    (hint.empty() || names.size() > 400 ? "" : "; " + hint)});
  }

  /// What a template makes is new: its classes and properties must be known all the same.
  void names(const ast::TriplePattern& triple) {
    if (triple.isPath()) return pathNames(*triple.path);
    lookUp(triple.predicate, properties_, "property");
    const bool is_type = !triple.predicate.isVariable() && triple.predicate.term().text == rdf::vocabulary::rdf("type");
    if (!is_type) return;
    lookUp(triple.object, ontology_.classNames(), "class");
    if (!triple.object.isVariable()) classes_.insert(triple.object.term().text);
  }

  void pathNames(const ast::Path& path) {
    if (path.kind == ast::Path::Kind::Link) {
      ast::PatternTerm term;
      term.value = path.iri;
      term.at = path.at;
      lookUp(term, properties_, "property");
    }
    for (const ast::Path& part : path.parts) pathNames(part);
  }

  static void addIfVariable(const ast::PatternTerm& term, Variables& into) {
    if (term.isVariable()) into.insert(term.variable());
  }

  void triples(const ast::TriplesBlock& block, Variables& into) {
    for (const ast::TriplePattern& triple : block.triples) {
      names(triple);
      addIfVariable(triple.subject, into);
      if (!triple.isPath()) addIfVariable(triple.predicate, into);
      addIfVariable(triple.object, into);
    }
  }

  /// Returns what the group binds. Filters see that, and what is bound around it when it is an EXISTS.
  Variables group(const ast::GroupPattern& pattern, const Variables& outer) {
    Variables bound = outer;
    std::vector<const ast::Expression*> filters;
    for (const ast::PatternElement& element : pattern.elements) element_(element, bound, filters);
    for (const ast::Expression* filter : filters) check(*filter, bound);
    return bound;
  }

  void merge(const ast::GroupPattern& pattern, const Variables& outer, Variables& into) {
    const Variables more = group(pattern, outer);
    into.insert(more.begin(), more.end());
  }

  void element_(const ast::PatternElement& element, Variables& bound, std::vector<const ast::Expression*>& filters) {
    if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value)) triples(*block, bound);
    if (const auto* inner = std::get_if<ast::GroupPattern>(&element.value)) merge(*inner, bound_, bound);
    // A filter of an OPTIONAL sees what stands before it.
    if (const auto* optional = std::get_if<ast::OptionalPattern>(&element.value)) merge(optional->group, bound, bound);
    if (const auto* either = std::get_if<ast::UnionPattern>(&element.value))
      for (const ast::GroupPattern& branch : either->branches) merge(branch, bound_, bound);
    if (const auto* minus = std::get_if<ast::MinusPattern>(&element.value)) group(minus->group, bound_);
    if (const auto* named = std::get_if<ast::GraphPattern>(&element.value)) {
      addIfVariable(named->graph, bound);
      if (!named->graph.isVariable() && isHistory(named->graph.term())) addHistory(named->graph.at);
      merge(named->group, bound_, bound);
    }
    if (const auto* service = std::get_if<ast::ServicePattern>(&element.value)) merge(service->group, bound_, bound);
    if (const auto* filter = std::get_if<ast::Filter>(&element.value)) filters.push_back(&filter->condition);
    if (const auto* bind = std::get_if<ast::Bind>(&element.value)) bound.insert(bind->variable);
    if (const auto* data = std::get_if<ast::InlineData>(&element.value))
      bound.insert(data->variables.begin(), data->variables.end());
    if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) {
      group(inner->select->where, bound_);
      for (const ast::Projection& column : inner->select->projection) bound.insert(column.variable);
    }
  }

  static bool isHistory(const Term& graph) { return graph.text == rdf::vocabulary::kGraphHistory; }

  void addHistory(ast::SourceOffset at) {
    faults_.push_back({at, "rules see no history: it would make the map depend on how it was built"});
    if (!history_) history_ = faults_.back();
  }

  void check(const ast::Expression& expression, const Variables& bound) {
    if (expression.kind == ast::Expression::Kind::Variable && !bound.contains(expression.variable))
      faults_.push_back({expression.at, "nothing binds ?" + query_.variables[expression.variable].name +
                                            " where the FILTER looks at it, so the FILTER never holds"});
    const bool asks_bound = expression.kind == ast::Expression::Kind::Call && expression.builtin == ast::Builtin::Bound;
    if (!asks_bound)
      for (const ast::Expression& argument : expression.arguments) check(argument, bound);
    if (expression.pattern) group(*expression.pattern, bound);
  }

  const ast::Query& query_;
  const rdf::OntologyView& ontology_;
  std::vector<std::string> properties_;
  Variables bound_;
  std::vector<QueryNameFault> faults_;
  std::optional<QueryNameFault> history_;
  std::set<std::string> classes_;
};

}  // namespace

std::vector<QueryNameFault> faultsOfNames(const ast::Query& query, const rdf::OntologyView& ontology,
                                          std::span<const std::string> bound) {
  return QueryNameCheck(query, ontology, bound).run();
}

std::vector<std::string> classesAskedFor(const ast::Query& query) {
  const rdf::OntologyView none;
  QueryNameCheck check(query, none, {});
  check.run();
  return {check.classes().begin(), check.classes().end()};
}

std::optional<QueryNameFault> historyNamedIn(const ast::Query& query) {
  const rdf::OntologyView none;
  QueryNameCheck check(query, none, {});
  check.run();
  return check.history();
}

SourceLocation locationIn(const ast::Query& query, const std::string& name, ast::SourceOffset at) {
  return locate(name, query.text, at);
}

std::vector<Diagnostic> checkRuleNames(const std::string& name, const std::string& text,
                                       const rdf::OntologyView& ontology) {
  sparql::SparqlParseOptions options;
  options.file = name;
  const ast::Query query = sparql::parseQuery(text, options);
  FaultList faults(name, text);
  for (const QueryNameFault& fault : faultsOfNames(query, ontology))
    faults.error(locationIn(query, name, fault.at), fault.message);
  return faults.sorted();
}

}  // namespace cluxel::mapping
