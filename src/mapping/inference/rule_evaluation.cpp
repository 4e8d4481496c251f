// SPDX-License-Identifier: Apache-2.0
// Rows of ids become facts as a CONSTRUCT makes them: without those that RDF does not allow.
#include "mapping/inference/rule_evaluation.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "base/content_hash.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/values/value.hpp"

namespace cluxel::mapping {

namespace {

/// Collects rows, and the terms that a query has computed.
class RowSink : public sparql::ResultSink {
 public:
  void beginSolutions(std::span<const std::string> variables, const sparql::TermLookup& terms) override {
    width_ = variables.size();
    terms_ = &terms;
  }
  void rows(std::span<const sparql::ResultId> cells, std::size_t) override {
    cells_.insert(cells_.end(), cells.begin(), cells.end());
    for (const sparql::ResultId id : cells)
      if (id >= sparql::kFirstComputed && !computed_.contains(id)) computed_.emplace(id, terms_->view(id).toTerm());
  }
  void boolean(bool) override {}
  void beginGraph() override {}
  void triple(const rdf::TermView&, const rdf::TermView&, const rdf::TermView&) override {}
  void end() override {}

  std::size_t width() const { return width_; }
  std::vector<sparql::ResultId>& cells() { return cells_; }
  /// Gives computed terms ids of the store.
  void intern(rdf::QuadWriter& writer) {
    std::unordered_map<sparql::ResultId, rdf::TermId> ids;
    for (const auto& [id, term] : computed_) ids.emplace(id, writer.intern(term));
    for (sparql::ResultId& cell : cells_)
      if (cell >= sparql::kFirstComputed) cell = ids.at(cell);
    writer.flush();
  }
  std::size_t bytes() const {
    constexpr std::size_t kBytesOfTerm = 200;
    return cells_.size() * sizeof(sparql::ResultId) + computed_.size() * kBytesOfTerm;
  }

 private:
  std::size_t width_ = 0;
  const sparql::TermLookup* terms_ = nullptr;
  std::vector<sparql::ResultId> cells_;
  std::unordered_map<sparql::ResultId, Term> computed_;
};

/// Where the parts of a triple stand in a row, or their constant terms.
struct TripleCells {
  static constexpr std::size_t kConstant = static_cast<std::size_t>(-1);
  std::array<std::size_t, 3> column{};
  rdf::Triple constant;

  rdf::Triple in(std::span<const sparql::ResultId> row) const {
    const auto part = [&](std::size_t i, rdf::TermId id) { return column.at(i) == kConstant ? id : row[column.at(i)]; };
    return {part(0, constant.s), part(1, constant.p), part(2, constant.o)};
  }
};

class RowFacts {
 public:
  RowFacts(const ast::Query& query, rdf::QuadWriter& writer) : query_(query), writer_(writer) {}

  TripleCells cellsOf(const ast::TriplePattern& triple) {
    TripleCells cells;
    place(triple.subject, cells.column[0], cells.constant.s);
    place(triple.predicate, cells.column[1], cells.constant.p);
    place(triple.object, cells.column[2], cells.constant.o);
    return cells;
  }

 private:
  void place(const ast::PatternTerm& part, std::size_t& column, rdf::TermId& constant) {
    column = TripleCells::kConstant;
    if (!part.isVariable()) {
      constant = writer_.intern(part.term());
      return;
    }
    const auto& columns = query_.select.projection;
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].variable == part.variable()) column = i;
  }

  const ast::Query& query_;
  rdf::QuadWriter& writer_;
};

bool isFact(const rdf::QuadReader& reader, const rdf::Triple& fact) {
  return fact.s != rdf::kNoTerm && fact.p != rdf::kNoTerm && fact.o != rdf::kNoTerm &&
         reader.viewOf(fact.s).kind != TermKind::Literal && reader.viewOf(fact.p).kind == TermKind::Iri;
}

}  // namespace

sparql::QueryOptions ruleOptions(const NamedText& rule, const rdf::InferenceCheck& check) {
  sparql::QueryOptions options;
  options.refuse_volatile = true;
  options.source_name = rule.name;
  if (check) {
    options.budget.poll = [check] { check(0); };
    options.budget.max_memory_bytes = check.max_memory_bytes;
    options.budget.is_of_update = true;
  }
  return options;
}

std::vector<RuleOutput> evaluateRule(rdf::WriteTransaction& transaction, const RuleShape& shape,
                                     const rdf::InferenceCheck& check, const std::optional<ValuesOf>& keys,
                                     const IsSeen& is_seen) {
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction)};
  rdf::QuadWriter writer(transaction);
  const ast::Query query = solutionsOf(shape, keys, static_cast<bool>(is_seen));
  RowSink sink;
  sparql::PreparedQuery(reader, query, ruleOptions(shape.rule, check)).run(sink);
  if (check) check(sink.bytes());
  RowFacts cells(query, writer);
  std::vector<TripleCells> made, read;
  for (const ast::TriplePattern& triple : shape.query.construct_template) made.push_back(cells.cellsOf(triple));
  if (is_seen)
    for (const ReadPattern& pattern : shape.reads) read.push_back(cells.cellsOf(pattern.triple));
  sink.intern(writer);
  const bool is_keyed = shape.following == RuleShape::Following::ByKey;
  std::vector<RuleOutput> outputs;
  for (std::size_t at = 0; sink.width() > 0 && at < sink.cells().size(); at += sink.width()) {
    const auto row = std::span<const sparql::ResultId>(sink.cells()).subspan(at, sink.width());
    if (!std::all_of(read.begin(), read.end(), [&](const TripleCells& triple) { return is_seen(triple.in(row)); }))
      continue;
    for (const TripleCells& triple : made) {
      const rdf::Triple fact = triple.in(row);
      if (isFact(reader, fact)) outputs.push_back({is_keyed ? row[0] : rdf::kNoTerm, fact});
    }
  }
  std::sort(outputs.begin(), outputs.end());
  outputs.erase(std::unique(outputs.begin(), outputs.end()), outputs.end());
  return outputs;
}

std::vector<rdf::Triple> replaceOutputs(std::vector<RuleOutput>& outputs,
                                        const std::optional<std::vector<rdf::TermId>>& keys,
                                        const std::vector<RuleOutput>& now) {
  const auto is_replaced = [&](const RuleOutput& output) {
    return !keys || std::binary_search(keys->begin(), keys->end(), output.key);
  };
  std::vector<rdf::Triple> facts;
  std::vector<RuleOutput> kept;
  for (const RuleOutput& output : outputs)
    if (is_replaced(output))
      facts.push_back(output.fact);
    else
      kept.push_back(output);
  for (const RuleOutput& output : now) facts.push_back(output.fact);
  outputs.clear();
  std::merge(kept.begin(), kept.end(), now.begin(), now.end(), std::back_inserter(outputs));
  return facts;
}

std::vector<rdf::TermId> affectedKeys(const rdf::QuadReader& reader, const RuleShape& shape, const ValuesOf& values,
                                      const rdf::InferenceCheck& check) {
  RowSink sink;
  sparql::PreparedQuery(reader, keysOf(shape, values), ruleOptions(shape.rule, check)).run(sink);
  return sink.cells();
}

std::vector<std::string> propertiesOfDerivations() {
  namespace words = rdf::vocabulary;
  return {words::rdf("type"), words::rdf("subject"), words::rdf("predicate"), words::rdf("object"), words::clx("rule")};
}

namespace {

/// A blank node for a fact about blank nodes: canonical exports name these by what is said of them, and an IRI would
/// follow from their stored labels.
Term nameOfDerivation(const std::array<Term, 3>& fact, const std::string& rule_name) {
  ContentHasher hasher;
  hasher.addText(rule_name);
  for (const Term& part : fact) hasher.addText(toNTriples(part));
  const std::string iri = rdf::iriOfDerivation(hasher.finish());
  const bool is_blank =
      std::any_of(fact.begin(), fact.end(), [](const Term& part) { return part.kind == TermKind::BlankNode; });
  return is_blank ? Term::blank(std::string(kBlankDerivation) + iri.substr(iri.rfind('/') + 1)) : Term::iri(iri);
}

}  // namespace

bool isDerivation(const rdf::TermView& term) {
  static const std::string some = rdf::iriOfDerivation({});
  return term.text.starts_with(
      term.kind == TermKind::BlankNode ? kBlankDerivation : std::string_view(some).substr(0, some.rfind('/') + 1));
}

std::vector<rdf::Triple> derivationOf(const rdf::QuadReader& reader, rdf::QuadWriter& writer, const rdf::Triple& fact,
                                      const NamedText& rule) {
  const std::string name = ruleFileName(rule);
  const rdf::TermId node =
      writer.intern(nameOfDerivation({reader.termOf(fact.s), reader.termOf(fact.p), reader.termOf(fact.o)}, name));
  const auto word = [&](const std::string& iri) { return writer.intern(Term::iri(iri)); };
  const auto properties = propertiesOfDerivations();
  return {{node, word(properties[0]), word(rdf::vocabulary::clx("Derivation"))},
          {node, word(properties[1]), fact.s},
          {node, word(properties[2]), fact.p},
          {node, word(properties[3]), fact.o},
          {node, word(properties[4]), writer.intern(Term::literal(name))}};
}

}  // namespace cluxel::mapping
