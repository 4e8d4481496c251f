// SPDX-License-Identifier: Apache-2.0
// SERVICE: evaluated on the local store that the caller has assigned to the endpoint, else refused.
#include "cluxel/error.hpp"
#include "sparql/algebra/algebra_builder.hpp"
#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

/// Relabels blank nodes: those of another store never equal ours.
Term foreign(Term term, std::uint32_t service) {
  if (term.kind == TermKind::BlankNode) term.text = "service" + std::to_string(service) + "x" + term.text;
  return term;
}

}  // namespace

NodePtr AlgebraBuilder::service(const ast::ServicePattern& service, ast::SourceOffset at, Scope& scope) {
  if (service.endpoint.isVariable()) {
    fail(at, "SERVICE with a variable is refused", "name the endpoint by its IRI");
  }
  const std::string& iri = service.endpoint.term().text;
  const auto allowed = options_.services.find(iri);
  if (allowed == options_.services.end()) {
    fail(at, "SERVICE <" + iri + "> is refused: no store is named for it, and nothing is asked over the network",
         "name a map or an RDF file that answers for it", Remedy::NameService);
  }
  return answered(service, *allowed->second, at, scope);
}

/// Evaluates the group on the other store and returns its solutions as VALUES.
NodePtr AlgebraBuilder::answered(const ast::ServicePattern& service, const rdf::QuadReader& reader,
                                 ast::SourceOffset at, Scope& scope) {
  std::size_t held = options_.guard->usage().bytes;
  QueryTerms terms(reader);
  AlgebraQuery algebra = buildAlgebra(service.group, variables_, std::string(text_), terms, options_);
  if (algebra.is_volatile) fail(at, "RAND, NOW, UUID and BNODE do not work within SERVICE", "use them outside of it");
  for (ExpressionWarning& warning : algebra.warnings) warn(warning.at, warning.message, warning.hint);
  const SlotSet used = algebra.root->mentioned();
  for (const Slot slot : algebra.parameters) {
    if (!used.has(slot)) continue;
    fail(at, "the parameter ?" + algebra.slot_names[slot] + " does not work within SERVICE",
         "what SERVICE gives is computed before parameters have values: join or filter outside of it");
  }
  const Dataset dataset = datasetOf({}, {}, reader);
  const OperatorPtr plan = Planner(algebra, terms, dataset).plan();
  FunctionContext functions(terms);
  Runtime runtime(reader, terms, functions, dataset, algebra.slot_names.size(), algebra.exists_count);
  runtime.guard = *options_.guard;
  NodePtr node = makeNode(Node::Kind::Values, at);
  node->note = "SERVICE <" + service.endpoint.term().text + ">";
  std::vector<Slot> theirs;
  for (ast::VariableIndex i = 0; i < variables_.size(); ++i) {
    const Slot slot = algebra.slot_of_variable[i];
    if (variables_[i].hidden || !algebra.root->possible.has(slot)) continue;
    theirs.push_back(slot);
    node->slots.push_back(slotOf(i, scope));
  }
  const std::uint32_t number = service_count_++;
  Batch batch(runtime.slot_count);
  for (plan->open(runtime, true); plan->next(batch);) {
    const std::size_t kept = batch.rows * theirs.size() * sizeof(ValueId);
    runtime.guard.charge(kept);
    held += kept;
    for (std::size_t row = 0; row < batch.rows; ++row) {
      ++node->rows.count;
      for (const Slot slot : theirs) {
        const ValueId id = batch.at(slot, row);
        node->rows.cells.push_back(id == kUnbound ? kUnbound : terms_.intern(foreign(terms.termOf(id), number)));
      }
    }
  }
  // The plan and its memory are released here; only the rows are kept.
  *options_.guard = runtime.guard;
  options_.guard->holdOnly(held);
  node->annotate();
  return node;
}

}  // namespace cluxel::sparql
