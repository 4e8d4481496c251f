// SPDX-License-Identifier: Apache-2.0
// Names in a query that the store does not know, with what was probably meant.
#include <algorithm>
#include <map>

#include "cluxel/base/nearest_name.hpp"
#include "cluxel/base/shown_line.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "sparql/prepared_query.hpp"

namespace cluxel {
namespace {

using sparql::Node;
using sparql::NodePtr;

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

/// Where the local part of an IRI begins.
std::size_t localPart(std::string_view iri) {
  const std::size_t end = iri.find_last_of("#/");
  return end == std::string_view::npos ? 0 : end + 1;
}

/// Names differ at their end mostly: within the namespace the local parts are compared. Else the namespace is wrong:
/// the same local part in another, or the nearest whole name.
std::string hintFor(const std::string& name, const std::vector<std::string>& known) {
  const std::size_t cut = localPart(name);
  std::vector<std::string> locals, elsewhere;
  for (const std::string& iri : known) {
    if (localPart(iri) == cut && iri.starts_with(std::string_view(name).substr(0, cut)))
      locals.push_back(iri.substr(cut));
    if (iri.substr(localPart(iri)) == name.substr(cut)) elsewhere.push_back(iri);
  }
  if (!locals.empty()) return suggestion(std::string_view(name).substr(cut), locals);
  const auto nearest = elsewhere.empty() ? nearestName(name, known) : std::optional<std::string>(elsewhere.front());
  return nearest ? "did you mean <" + *nearest + ">?" : "";
}

class NameCheck {
 public:
  explicit NameCheck(PreparedQuery::Impl& query) : query_(query) {}

  std::vector<Diagnostic> run() {
    for (const auto* graphs : {&query_.query.dataset.default_graphs, &query_.query.dataset.named_graphs}) {
      for (const Term& graph : *graphs) checkFrom(graph);
    }
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
  /// FROM reads graphs of the store only.
  void checkFrom(const Term& graph) {
    if (!query_.reader.idOf(graph)) warn("graph", query_.terms.intern(graph), query_.query.dataset.at, storedGraphs());
  }
  std::vector<std::string> storedGraphs() const {
    std::vector<std::string> names;
    for (const TermId graph : query_.reader.graphs()) {
      if (graph != kNoTerm) names.push_back(query_.reader.termOf(graph).text);
    }
    std::sort(names.begin(), names.end());
    return names;
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
      warn("graph", triple.graph.constant, triple.at, storedGraphs());
    }
    const bool is_type =
        !triple.path && !triple.predicate.isSlot() && textOf(triple.predicate.constant) == vocabulary::rdf("type");
    if (is_type && !triple.object.isSlot() && triple.object.constant >= sparql::kFirstComputed) {
      warn("class", triple.object.constant, triple.at, knownClasses(query_.reader));
    }
  }
  void warnPredicate(sparql::ValueId id, ast::SourceOffset at) {
    if (id >= sparql::kFirstComputed) warn("property", id, at, knownPredicates(query_.reader));
  }
  std::string textOf(sparql::ValueId id) const { return query_.terms.termOf(id).text; }
  void warn(const std::string& what, sparql::ValueId id, ast::SourceOffset at, const std::vector<std::string>& known) {
    const std::string name = textOf(id);
    if (!warned_.emplace(name, true).second) return;
    Diagnostic diagnostic;
    diagnostic.severity = Severity::Warning;
    diagnostic.location = locate(query_.options.source_name, query_.query.text, at);
    diagnostic.message = "the map has no " + what + " <" + name + ">";
    diagnostic.hint = hintFor(name, known);
    diagnostic.source_line = shownLine(query_.query.text, diagnostic.location.line);
    found_.push_back(std::move(diagnostic));
  }

  PreparedQuery::Impl& query_;
  std::vector<Diagnostic> found_;
  std::map<std::string, bool> warned_;
};

}  // namespace

std::vector<Diagnostic> checkQuery(const QuadReader& reader, std::string_view text, const QueryOptions& options) {
  PreparedQuery::Impl query(reader, text, options, {});
  return NameCheck(query).run();
}

}  // namespace cluxel
