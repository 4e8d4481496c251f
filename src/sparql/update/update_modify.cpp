// SPDX-License-Identifier: Apache-2.0
// Evaluates the WHERE of an update and instantiates its templates.
#include "sparql/update/update_modify.hpp"

#include <chrono>

#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

/// With the texts that do not fit into their strings.
std::size_t bytesOf(const ChangedQuad& change) {
  constexpr std::size_t kBytesOfBlock = 24;
  std::size_t bytes = sizeof(ChangedQuad);
  for (const Term* term : {&change.quad.subject, &change.quad.predicate, &change.quad.object, &change.quad.graph})
    bytes += term->text.size() + term->datatype.size() + kBytesOfBlock;
  return bytes;
}

}  // namespace

ModifyRun::ModifyRun(const rdf::QuadReader& reader, const ast::Update& update, const ast::UpdateOperation& operation,
                     const ast::Modify& modify, const UpdateOptions& options)
    : reader_(reader), update_(update), operation_(operation), modify_(modify), options_(options), terms_(reader) {}

/// WITH gives the default graph of the pattern unless there is USING.
Dataset ModifyRun::dataset() const {
  Dataset dataset = datasetOf(modify_.using_clause, options_.query, reader_);
  if (!modify_.with || !modify_.using_clause.empty()) return dataset;
  const auto id = reader_.idOf(*modify_.with);
  dataset.default_graph = {};
  dataset.default_graph.kind = id ? GraphFilter::Kind::One : GraphFilter::Kind::AnyOf;
  dataset.default_graph.graph = id.value_or(rdf::kNoTerm);
  dataset.default_graph.may_repeat = false;
  return dataset;
}

AlgebraQuery ModifyRun::algebra(Guard& guard) {
  AlgebraOptions algebra_options;
  algebra_options.source_name = options_.query.source_name;
  algebra_options.refuse_volatile = options_.query.refuse_volatile;
  algebra_options.services = options_.query.services;
  algebra_options.guard = &guard;
  return buildAlgebra(modify_.where, operation_.variables, update_.text, terms_, algebra_options);
}

void ModifyRun::prepare(FunctionContext& functions) const {
  using namespace std::chrono;
  functions.base_iri = operation_.base_iri;
  functions.random.seed(seed);
  functions.label_prefix = label_prefix;
  functions.now_us = options_.query.now_us
                         ? *options_.query.now_us
                         : duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

Changes ModifyRun::changes() {
  const Dataset data = dataset();
  Guard guard;
  guard.start(options_.query.budget, used);
  AlgebraQuery query = algebra(guard);
  slot_of_variable_ = query.slot_of_variable;
  warnings_ = query.warnings;
  const OperatorPtr plan = Planner(query, terms_, data).plan();
  FunctionContext functions(terms_);
  prepare(functions);
  Runtime runtime(reader_, terms_, functions, data, query.slot_names.size(), query.exists_count);
  runtime.guard = guard;
  Changes changes;
  Batch batch(runtime.slot_count);
  for (plan->open(runtime, true); plan->next(batch);) {
    for (std::size_t row = 0; row < batch.rows; ++row) {
      Blanks blanks;
      instantiate(modify_.remove, batch, row, blanks, runtime.guard, changes.removed);
      instantiate(modify_.insert, batch, row, blanks, runtime.guard, changes.inserted);
    }
  }
  used_after_ = runtime.guard.usage();
  for (const std::string& note : functions.notes) warnings_.push_back({operation_.at, note, {}});
  return changes;
}

std::optional<Term> ModifyRun::filled(const ast::PatternTerm& place, const Batch& batch, std::size_t row,
                                      Blanks& blanks) {
  if (place.isVariable()) {
    const ValueId id = batch.at(slot_of_variable_[place.variable()], row);
    return id == kUnbound ? std::nullopt : std::optional<Term>(terms_.termOf(id));
  }
  if (place.term().kind != TermKind::BlankNode) return place.term();
  Term& blank = blanks[place.term().text];
  if (blank.text.empty()) blank = Term::blank(fresh_label());
  return blank;
}

/// Skips quads with an unbound position or a term kind that RDF does not allow there.
void ModifyRun::instantiate(const std::vector<ast::QuadTemplate>& templates, const Batch& batch, std::size_t row,
                            Blanks& blanks, Guard& guard, std::vector<ChangedQuad>& out) {
  for (const ast::QuadTemplate& quad : templates) {
    auto s = filled(quad.subject, batch, row, blanks), p = filled(quad.predicate, batch, row, blanks);
    auto o = filled(quad.object, batch, row, blanks);
    auto g = quad.graph ? filled(*quad.graph, batch, row, blanks) : std::optional<Term>(default_graph);
    if (!s || !p || !o || !g || s->kind == TermKind::Literal || p->kind != TermKind::Iri || g->kind != TermKind::Iri)
      continue;
    if (out.size() == out.capacity()) guard.requireRoomFor(out.size() * sizeof(ChangedQuad));
    out.push_back({{std::move(*s), std::move(*p), std::move(*o), std::move(*g)}, quad.graph || modify_.with});
    guard.work(1);
    guard.charge(bytesOf(out.back()));
  }
}

}  // namespace cluxel::sparql
