// SPDX-License-Identifier: Apache-2.0
// Prepares and executes queries.
#include "sparql/exec/prepared_query.hpp"

#include <algorithm>
#include <chrono>
#include <random>

#include "rdf/vocabulary.hpp"
#include "sparql/exec/graph_results.hpp"
#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

Guard started(const QueryBudget& budget) {
  Guard guard;
  guard.start(budget);
  return guard;
}

ast::Query parsed(std::string_view text, const QueryOptions& options, Guard& guard) {
  SparqlParseOptions parse_options;
  parse_options.file = options.source_name;
  parse_options.base_iri = options.base_iri;
  parse_options.prefixes = options.prefixes;
  parse_options.count = [&guard](std::size_t tokens) { guard.chargeForTokens(tokens); };
  return parseQuery(text, parse_options);
}

std::int64_t clockMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PreparedQuery::Impl::Impl(const rdf::QuadReader& quad_reader, const Parse& parse, const QueryOptions& query_options,
                          const std::vector<std::string>& parameters)
    : reader(quad_reader),
      options(query_options),
      preparing(started(query_options.budget)),
      terms(quad_reader),
      query(parse(preparing)),
      dataset(datasetOf(query.dataset, options, reader)),
      functions(terms) {
  AlgebraOptions algebra_options;
  algebra_options.parameters = parameters;
  algebra_options.refuse_volatile = options.refuse_volatile;
  algebra_options.source_name = options.source_name;
  algebra_options.services = options.services;
  algebra_options.guard = &preparing;
  algebra = buildAlgebra(query, terms, algebra_options);
  preparing.checkTime();
  plan = Planner(algebra, terms, dataset, options.spatial_plans).plan();
  preparing.checkTime();
  for (const ast::Projection& column : query.select.projection)
    variables.push_back(query.variables[column.variable].name);
  for (ast::VariableIndex i = 0; i < query.variables.size(); ++i) {
    const Slot slot = algebra.slot_of_variable[i];
    const auto& bound = algebra.parameters;
    if (std::find(bound.begin(), bound.end(), slot) != bound.end())
      parameter_slots.emplace_back(query.variables[i].name, slot);
  }
  runtime =
      std::make_unique<Runtime>(reader, terms, functions, dataset, algebra.slot_names.size(), algebra.exists_count);
  functions.base_iri = query.base_iri;
  mark = terms.mark();
  used_before = preparing.usage();
}

PreparedQuery::Impl::Impl(const rdf::QuadReader& quad_reader, std::string_view text, const QueryOptions& query_options,
                          const std::vector<std::string>& parameters)
    : Impl(
          quad_reader, [&](Guard& guard) { return parsed(text, query_options, guard); }, query_options, parameters) {}

void PreparedQuery::Impl::setParameters(const std::vector<Binding>& bindings) {
  for (const auto& parameter : parameter_slots) {
    const auto binding =
        std::find_if(bindings.begin(), bindings.end(), [&](const Binding& b) { return b.first == parameter.first; });
    if (binding == bindings.end())
      throw Error(ErrorKind::InvalidArgument,
                  options.source_name + ": the parameter ?" + parameter.first + " has no value");
    runtime->parameters[parameter.second] = terms.intern(binding->second);
  }
}

void PreparedQuery::Impl::begin(const std::vector<Binding>& bindings) {
  terms.rewind(mark);
  functions.notes.clear();
  setParameters(bindings);
  if (algebra.is_volatile || !query.construct_template.empty()) {
    functions.random.seed(options.seed ? *options.seed : std::random_device{}());
    functions.label_prefix = std::to_string(functions.random() % 1'000'000'000'000) + "x";
    functions.fresh_labels = 0;
    functions.now_us = options.now_us ? *options.now_us : clockMicroseconds();
  }
  // Opening releases the memory that the operators hold from the last run.
  plan->open(*runtime, true);
  runtime->guard.start(options.budget, used_before);
  if (options.services.empty()) used_before.time = {};
  runtime->charged_for_terms = terms.computedBytes();
  has_run = true;
}

bool PreparedQuery::Impl::hasSolution() {
  Batch batch(runtime->slot_count);
  return plan->next(batch);
}

void PreparedQuery::Impl::runSelect(ResultSink& sink) {
  // Kept as separate batches: a single growing array would be copied repeatedly.
  std::vector<std::vector<ResultId>> pieces;
  std::vector<std::size_t> row_counts;  // rows may have no columns
  std::size_t rows = 0;
  Batch batch(runtime->slot_count);
  const auto& columns = algebra.projection;
  while (plan->next(batch)) {
    rows += batch.rows;
    runtime->guard.answerRows(rows);
    runtime->guard.charge(batch.rows * columns.size() * sizeof(ResultId));
    std::vector<ResultId>& cells = pieces.emplace_back(batch.rows * columns.size());
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const auto& source = batch.columns[columns[column]];
      ResultId* out = cells.data() + column;
      for (std::size_t row = 0; row < batch.rows; ++row, out += columns.size()) {
        *out = source.empty() ? kUnbound : source[row];
      }
    }
    row_counts.push_back(batch.rows);
  }
  sink.beginSolutions(variables, terms);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    runtime->guard.checkTime();
    sink.rows(pieces[i], row_counts[i]);
  }
  sink.end();
}

void PreparedQuery::Impl::runGraph(ResultSink& sink) {
  GraphResult graph(*runtime, query, algebra);
  Batch batch(runtime->slot_count);
  while (plan->next(batch)) {
    if (query.form == ast::QueryForm::Construct) {
      graph.construct(batch);
    } else {
      graph.describe(batch);
    }
  }
  graph.finish();
  sink.beginGraph();
  graph.write(sink);
  sink.end();
}

const std::vector<std::pair<std::string, std::string>>& mapPrefixes() {
  using namespace rdf::vocabulary;
  static const std::vector<std::pair<std::string, std::string>> prefixes = {
      {"clx", std::string(kClx)},   {"geo", std::string(kGeo)},   {"geof", std::string(kGeof)},
      {"sosa", std::string(kSosa)}, {"prov", std::string(kProv)}, {"rdf", std::string(kRdf)},
      {"rdfs", std::string(kRdfs)}, {"owl", std::string(kOwl)},   {"xsd", std::string(kXsd)},
      {"skos", std::string(kSkos)}};
  return prefixes;
}

PreparedQuery::PreparedQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options,
                             const std::vector<std::string>& parameters)
    : impl_(std::make_unique<Impl>(reader, text, options, parameters)) {}
PreparedQuery::PreparedQuery(const rdf::QuadReader& reader, ast::Query query, const QueryOptions& options)
    : impl_(std::make_unique<Impl>(
          reader, [&](Guard&) { return std::move(query); }, options, std::vector<std::string>())) {}
PreparedQuery::PreparedQuery(PreparedQuery&&) noexcept = default;
PreparedQuery& PreparedQuery::operator=(PreparedQuery&&) noexcept = default;
PreparedQuery::~PreparedQuery() = default;

ast::QueryForm PreparedQuery::form() const {
  return impl_->query.form;
}
const std::vector<std::string>& PreparedQuery::variables() const {
  return impl_->variables;
}

std::vector<Diagnostic> PreparedQuery::notes() const {
  std::vector<Diagnostic> notes;
  for (const std::string& text : impl_->functions.notes)
    notes.push_back({Severity::Warning, {.file = impl_->options.source_name}, text, {}, {}});
  return notes;
}

void PreparedQuery::run(ResultSink& sink, const std::vector<Binding>& bindings) {
  impl_->begin(bindings);
  switch (impl_->query.form) {
    case ast::QueryForm::Select:
      return impl_->runSelect(sink);
    case ast::QueryForm::Construct:
    case ast::QueryForm::Describe:
      return impl_->runGraph(sink);
    case ast::QueryForm::Ask:
      break;
  }
  sink.boolean(impl_->hasSolution());
}

QueryResult PreparedQuery::evaluate(const std::vector<Binding>& bindings) {
  ResultCollector collector;
  run(collector, bindings);
  return collector.take();
}

bool PreparedQuery::ask(const std::vector<Binding>& bindings) {
  impl_->begin(bindings);
  return impl_->hasSolution();
}

void runQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options, ResultSink& sink) {
  PreparedQuery(reader, text, options).run(sink);
}

QueryResult evaluateQuery(const rdf::QuadReader& reader, std::string_view text, const QueryOptions& options) {
  return PreparedQuery(reader, text, options).evaluate();
}

}  // namespace cluxel::sparql
