// SPDX-License-Identifier: Apache-2.0
// `cluxel query`: questions in SPARQL.
#include <algorithm>
#include <cmath>

#include "app/command.hpp"
#include "app/console/spool.hpp"
#include "app/map_condition.hpp"
#include "app/named_sources.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "mapping/map_state.hpp"
#include "sparql/results/result_writer.hpp"
#include "sparql/syntax/parser.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::app {

namespace {

struct QueryArguments {
  fs::path source, file;
  std::string text, format, base_iri;
  std::vector<std::string> params, services;
  BudgetOptions budget;
  std::uint64_t max_rows = 0;
  bool explain = false, why_empty = false, strict = false, no_prefixes = false, check = false, allow_unfinished = false;
};

/// Counts the rows that go to the writer.
class CountingSink : public sparql::ResultSink {
 public:
  explicit CountingSink(sparql::ResultSink& next) : next_(next) {}
  void beginSolutions(std::span<const std::string> variables, const sparql::TermLookup& terms) override {
    next_.beginSolutions(variables, terms);
  }
  void rows(std::span<const sparql::ResultId> cells, std::size_t count) override {
    rows_ += count;
    next_.rows(cells, count);
  }
  void boolean(bool value) override {
    is_false_ = !value;
    rows_ = 1;
    next_.boolean(value);
  }
  void beginGraph() override { next_.beginGraph(); }
  void triple(const rdf::TermView& s, const rdf::TermView& p, const rdf::TermView& o) override {
    ++rows_;
    next_.triple(s, p, o);
  }
  void end() override { next_.end(); }
  ExitCode exitCode() const {
    if (is_false_) return ExitCode::NegativeFinding;
    return rows_ == 0 ? ExitCode::NoRows : ExitCode::Done;
  }

 private:
  sparql::ResultSink& next_;
  std::uint64_t rows_ = 0;
  bool is_false_ = false;
};

sparql::QueryOptions optionsOf(const QueryArguments& arguments, const tasks::QuerySource& source,
                               const std::string& name) {
  sparql::QueryOptions options;
  options.default_graph = arguments.strict ? sparql::DefaultGraph::Unnamed : source.default_graph;
  options.source_name = name;
  options.base_iri = arguments.base_iri;
  if (!arguments.no_prefixes) options.prefixes = sparql::mapPrefixes();
  arguments.budget.applyTo(options.budget);
  options.budget.max_rows = arguments.max_rows;
  return options;
}

sparql::ResultFormat formatOf(const QueryArguments& arguments, const Session& session, sparql::ast::QueryForm form) {
  const bool is_graph = form == sparql::ast::QueryForm::Construct || form == sparql::ast::QueryForm::Describe;
  if (arguments.format.empty()) {
    if (is_graph) return sparql::ResultFormat::Turtle;
    return session.json ? sparql::ResultFormat::Json : sparql::ResultFormat::Table;
  }
  const auto format = sparql::resultFormatOf(arguments.format);
  if (!format)
    throw Error(
        ErrorKind::InvalidArgument,
        "--format " + arguments.format + ": known are table, json, xml, csv, tsv, and for graphs turtle, ntriples");
  return *format;
}

void warn(const std::vector<Diagnostic>& warnings) {
  for (const Diagnostic& warning : warnings) std::fprintf(stderr, "%s\n", format(warning).c_str());
}

ExitCode checkSyntax(const QueryArguments& arguments, const tasks::Question& question) {
  sparql::SparqlParseOptions options;
  options.file = question.file.string();
  options.base_iri = arguments.base_iri;
  if (!arguments.no_prefixes) options.prefixes = sparql::mapPrefixes();
  parseQuery(question.text, options);
  return ExitCode::Done;
}

ExitCode query(const QueryArguments& arguments, Session& session) {
  const tasks::Question question = questionFrom(arguments.file, arguments.text, session);
  if (arguments.check) return checkSyntax(arguments, question);
  const tasks::QuerySource source = tasks::openQuerySource(arguments.source);
  noteUnfinished(arguments.source, !mapping::hasUnfinishedBuild(source.environment->read()), arguments.allow_unfinished,
                 session);
  const rdf::QuadReader reader = source.reader();
  sparql::QueryOptions options = optionsOf(arguments, source, question.file.string());
  const NamedSources services("--service", arguments.services);
  options.services = services.readers();
  const std::vector<sparql::Binding> bindings = bindingsFor(question, arguments.params);
  std::vector<std::string> names;
  names.reserve(bindings.size());
  for (const sparql::Binding& binding : bindings) names.push_back(binding.first);
  sparql::PreparedQuery prepared(reader, question.text, options, names);
  for (const Diagnostic& warning : prepared.warnings()) std::fprintf(stderr, "%s\n", format(warning).c_str());
  Spool spool(options.budget.deadline.has_value());
  const auto writer = makeResultWriter(formatOf(arguments, session, prepared.form()),
                                       [&spool](std::string_view piece) { spool.write(piece); });
  CountingSink counter(*writer);
  prepared.run(counter, bindings);
  spool.finish();
  warn(prepared.notes());
  if (arguments.explain)
    std::fprintf(stderr, "%s\n", (session.json ? prepared.explainJson() : prepared.explain()).c_str());
  if (arguments.why_empty && counter.exitCode() == ExitCode::NoRows)
    std::fprintf(stderr, "%s\n", whyEmpty(reader, question.text, options, bindings).c_str());
  return counter.exitCode();
}

}  // namespace

void addQuery(CLI::App& app, Session& session) {
  auto options = std::make_shared<QueryArguments>();
  CLI::App* command = app.add_subcommand("query", "query a map or an RDF file in SPARQL");
  command->add_option("source", options->source, "a map, or an RDF file (.ttl .nt .nq .trig .rdf)")->required();
  command->add_option("query", options->file, "a query file, by path or by name in queries/");
  command->add_option("-e,--text", options->text, "the query itself");
  command->add_option("--param", options->params, "NAME=VALUE for a parameter of the question");
  command->add_option("--service", options->services,
                      "IRI=SOURCE: a map or RDF file that answers SERVICE <IRI>; others are refused");
  command->add_option("--format", options->format, "table, json, xml, csv, tsv; for graphs turtle, ntriples");
  addBudget(*command, options->budget);
  command->add_option("--max-rows", options->max_rows, "rows above which the query fails with exit code 6")
      ->check(wholeAbove0());
  command->add_flag("--explain", options->explain,
                    "print the plan with estimated and actual rows on stderr; with --json as JSON in one line");
  command->add_flag("--why-empty", options->why_empty,
                    "when the answer has no row, name the pattern that removed the last one");
  command->add_flag("--strict", options->strict, "the default graph is the unnamed graph, not the union");
  command->add_flag("--no-prefixes", options->no_prefixes, "know only the prefixes that the query declares");
  command->add_option("--base", options->base_iri, "base IRI of relative IRIs");
  command->add_flag("--check", options->check, "only check the syntax");
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return query(*options, session); });
}

}  // namespace cluxel::app
