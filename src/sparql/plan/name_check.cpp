// SPDX-License-Identifier: Apache-2.0
// Reports IRIs in a query that the store does not contain, with suggestions.
#include <algorithm>
#include <map>

#include "base/nearest_name.hpp"
#include "base/shown_line.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/exec/prepared_query.hpp"
#include "sparql/syntax/source_text.hpp"

namespace cluxel::sparql {
namespace {

/// The IRIs of one kind in the store; collected when the first unknown one is found.
std::vector<std::string> knownPredicates(const rdf::QuadReader& reader) {
  std::vector<std::string> names;
  for (const rdf::TermId id : reader.predicates()) names.push_back(reader.termOf(id).text);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> knownClasses(const rdf::QuadReader& reader) {
  std::vector<rdf::TermId> ids;
  const auto collect = [&](const std::string& predicate, std::optional<std::string> object) {
    rdf::QuadPattern pattern;
    pattern.p = reader.idOf(Term::iri(predicate));
    if (object) pattern.o = reader.idOf(Term::iri(*object));
    if (!pattern.p || (object && !pattern.o)) return;
    rdf::QuadCursor cursor = reader.scan(pattern, rdf::QuadOrder::Posg);
    for (rdf::QuadIds quad; cursor.next(quad);) {
      const rdf::TermId id = object ? quad.s : quad.o;
      if (ids.empty() || ids.back() != id) ids.push_back(id);
    }
  };
  collect(rdf::vocabulary::rdf("type"), std::nullopt);
  collect(rdf::vocabulary::rdf("type"), std::string(rdf::vocabulary::kOwl) + "Class");
  std::vector<std::string> names;
  for (const rdf::TermId id : ids) {
    const Term term = reader.termOf(id);
    if (term.kind == TermKind::Iri) names.push_back(term.text);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

/// The offset of the local name of an IRI.
std::size_t localPart(std::string_view iri) {
  const std::size_t end = iri.find_last_of("#/");
  return end == std::string_view::npos ? 0 : end + 1;
}

/// Suggests the nearest local name in the same namespace; else the same local name in another namespace, or the nearest
/// IRI.
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
    for (const auto* graphs : {&query_.query.dataset.default_graphs, &query_.query.dataset.named_graphs})
      for (const Term& graph : *graphs) checkFrom(graph.text);
    for (const auto* graphs : {&query_.options.default_graphs, &query_.options.named_graphs})
      for (const std::string& graph : *graphs) checkFrom(graph);
    visit(*query_.algebra.root);
    for (const ExpressionWarning& warning : query_.algebra.warnings)
      found_.push_back(
          warningAt(query_.options.source_name, query_.query.text, warning.at, warning.message, warning.hint));
    return std::move(found_);
  }

 private:
  void visit(const Node& node) {
    if (node.kind == Node::Kind::Triple) visitTriple(node.triple);
    for (const NodePtr& child : node.children) visit(*child);
    for (const Expr& condition : node.conditions) visit(condition);
    if (node.expression) visit(*node.expression);
  }
  /// Checks FROM and FROM NAMED, and what a request gives in their place. They refer to graphs of the store only.
  void checkFrom(const std::string& iri) {
    const Term graph = Term::iri(iri);
    if (!query_.reader.idOf(graph)) warn("graph", query_.terms.intern(graph), query_.query.dataset.at);
  }
  std::vector<std::string> storedGraphs() const {
    std::vector<std::string> names;
    for (const rdf::TermId graph : query_.reader.graphs()) {
      if (graph != rdf::kNoTerm) names.push_back(query_.reader.termOf(graph).text);
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  void visit(const Expr& expression) {
    if (expression.pattern) visit(*expression.pattern);
    for (const Expr& argument : expression.arguments) visit(argument);
  }
  void visit(const CompiledPath& path) {
    warnPredicate(path.iri, path.at);
    for (const auto& part : path.parts) visit(part);
  }
  void visitTriple(const TripleNode& triple) {
    if (triple.path) visit(*triple.path);
    if (!triple.path && !triple.predicate.isSlot()) warnPredicate(triple.predicate.constant, triple.predicate_at);
    if (triple.graph.kind == GraphPlace::Kind::Constant && triple.graph.constant >= kFirstComputed) {
      warn("graph", triple.graph.constant, triple.at);
    }
    const bool is_type =
        !triple.path && !triple.predicate.isSlot() && textOf(triple.predicate.constant) == rdf::vocabulary::rdf("type");
    if (is_type && !triple.object.isSlot() && triple.object.constant >= kFirstComputed) {
      warn("class", triple.object.constant, triple.object_at);
    }
  }
  void warnPredicate(ValueId id, ast::SourceOffset at) {
    if (id >= kFirstComputed) warn("property", id, at);
  }
  std::string textOf(ValueId id) const { return query_.terms.termOf(id).text; }
  /// Read at most once: a query may hold any number of unknown names.
  const std::vector<std::string>& known(const std::string& what) {
    const auto [entry, is_new] = known_.try_emplace(what);
    if (is_new)
      entry->second = what == "graph"   ? storedGraphs()
                      : what == "class" ? knownClasses(query_.reader)
                                        : knownPredicates(query_.reader);
    return entry->second;
  }
  void warn(const std::string& what, ValueId id, ast::SourceOffset at) {
    const std::string name = textOf(id);
    if (found_.size() >= kMaxFaults || !warned_.emplace(name, true).second) return;
    found_.push_back(warningAt(query_.options.source_name, query_.query.text, at,
                               "the map has no " + what + " <" + name + ">", hintFor(name, known(what))));
  }

  PreparedQuery::Impl& query_;
  std::vector<Diagnostic> found_;
  std::map<std::string, bool> warned_;
  std::map<std::string, std::vector<std::string>> known_;
};

}  // namespace

std::vector<Diagnostic> PreparedQuery::warnings() const {
  return NameCheck(*impl_).run();
}

std::vector<Diagnostic> checkQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options) {
  return PreparedQuery(reader, text, options).warnings();
}

}  // namespace cluxel::sparql
