// SPDX-License-Identifier: Apache-2.0
// `cluxel query`, `cluxel update` and `cluxel tasks`: questions in SPARQL.
#include "app/command.hpp"
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/sparql/result_writer.hpp"
#include "cluxel/sparql/update_engine.hpp"
#include "cluxel/tasks/query_source.hpp"

namespace cluxel::app {

namespace {

struct QueryArguments {
  fs::path source, file;
  std::string text, format;
  std::vector<std::string> params;
  double deadline_s = 0;
  std::uint64_t max_rows = 0, max_memory_mib = 0;
  bool explain = false, why_empty = false, strict = false;
};

/// Counts the rows that go to the writer.
class CountingSink : public ResultSink {
 public:
  explicit CountingSink(ResultSink& next) : next_(next) {}
  void beginSolutions(std::span<const std::string> variables, const TermLookup& terms) override {
    next_.beginSolutions(variables, terms);
  }
  void rows(std::span<const ResultId> cells, std::size_t count) override {
    rows_ += count;
    next_.rows(cells, count);
  }
  void boolean(bool value) override {
    is_false_ = !value;
    rows_ = 1;
    next_.boolean(value);
  }
  void beginGraph() override { next_.beginGraph(); }
  void triple(const TermView& s, const TermView& p, const TermView& o) override {
    ++rows_;
    next_.triple(s, p, o);
  }
  void end() override { next_.end(); }
  ExitCode exitCode() const {
    if (is_false_) return ExitCode::NegativeFinding;
    return rows_ == 0 ? ExitCode::NoRows : ExitCode::Done;
  }

 private:
  ResultSink& next_;
  std::uint64_t rows_ = 0;
  bool is_false_ = false;
};

QueryOptions optionsOf(const QueryArguments& arguments, const QuerySource& source, const std::string& name) {
  QueryOptions options;
  options.default_graph = arguments.strict ? DefaultGraph::Unnamed : source.default_graph;
  options.source_name = name;
  if (arguments.deadline_s > 0)
    options.budget.deadline = std::chrono::milliseconds(static_cast<std::int64_t>(arguments.deadline_s * 1000));
  options.budget.max_rows = arguments.max_rows;
  if (arguments.max_memory_mib > 0) options.budget.max_memory_bytes = arguments.max_memory_mib << 20U;
  return options;
}

Question questionOf(const QueryArguments& arguments, const Session& session) {
  if (!arguments.text.empty() && !arguments.file.empty())
    throw Error(ExitCode::Usage, "give a query file or -e TEXT, not both");
  if (arguments.file.empty() && arguments.text.empty())
    throw Error(ExitCode::Usage, "give a query file, or a query with -e TEXT");
  if (!arguments.file.empty()) {
    fs::path file = arguments.file;
    if (!file.has_extension()) file += ".rq";
    return readQuestion(session.dataHome().locate("queries", file));
  }
  Question question;
  question.file = "-e";
  question.text = arguments.text;
  return question;
}

ResultFormat formatOf(const QueryArguments& arguments, const Session& session, ast::QueryForm form) {
  const bool is_graph = form == ast::QueryForm::Construct || form == ast::QueryForm::Describe;
  if (arguments.format.empty()) {
    if (is_graph) return ResultFormat::Turtle;
    return session.json ? ResultFormat::Json : ResultFormat::Table;
  }
  const auto format = resultFormatOf(arguments.format);
  if (!format)
    throw Error(ExitCode::Usage, "--format " + arguments.format +
                                     ": known are table, json, xml, csv, tsv, and for graphs turtle, ntriples");
  return *format;
}

ExitCode query(const QueryArguments& arguments, const Session& session) {
  const Question question = questionOf(arguments, session);
  const QuerySource source = openQuerySource(arguments.source);
  const QuadReader reader = source.reader();
  const QueryOptions options = optionsOf(arguments, source, question.file.string());
  const std::vector<Binding> bindings = bindingsFor(question, arguments.params);
  std::vector<std::string> names;
  for (const Binding& binding : bindings) names.push_back(binding.first);
  PreparedQuery prepared(reader, question.text, options, names);
  for (const Diagnostic& warning : checkQuery(reader, question.text, options))
    std::fprintf(stderr, "%s\n", format(warning).c_str());
  const auto writer = makeResultWriter(formatOf(arguments, session, prepared.form()), [](std::string_view piece) {
    std::fwrite(piece.data(), 1, piece.size(), stdout);
  });
  CountingSink counter(*writer);
  prepared.run(counter, bindings);
  std::fflush(stdout);
  if (arguments.explain) std::fprintf(stderr, "%s\n", prepared.explain().c_str());
  if (arguments.why_empty && counter.exitCode() == ExitCode::NoRows)
    std::fprintf(stderr, "%s\n", whyEmpty(reader, question.text, options).c_str());
  return counter.exitCode();
}

struct UpdateArguments {
  fs::path map, file;
  std::string text;
};

ExitCode update(const UpdateArguments& arguments, const Session& session) {
  QueryArguments as_query;
  as_query.file = arguments.file;
  as_query.text = arguments.text;
  const Question question = questionOf(as_query, session);
  const auto environment = Environment::open(arguments.map, OpenMode::ReadWrite);
  WriteTransaction transaction = environment->write();
  UpdateOptions options;
  options.query.source_name = question.file.string();
  const UpdateReport report = runUpdate(transaction, question.text, options);
  transaction.commit();
  if (session.json)
    printJson(Json{{"inserted", report.inserted}, {"deleted", report.deleted}});
  else
    std::printf("%llu inserted, %llu deleted\n", static_cast<unsigned long long>(report.inserted),
                static_cast<unsigned long long>(report.deleted));
  return ExitCode::Done;
}

Json questionJson(const Question& question) {
  Json json{{"file", question.file.filename().string()}, {"title", question.title}, {"parameters", Json::array()},
            {"columns", Json::array()}};
  for (const QueryParameter& p : question.parameters)
    json["parameters"].push_back({{"name", p.name}, {"unit", p.unit}, {"default", p.default_value}, {"help", p.help}});
  for (const QueryColumn& c : question.columns)
    json["columns"].push_back({{"name", c.name}, {"unit", c.unit}, {"help", c.help}});
  return json;
}

ExitCode listTasks(const Session& session) {
  Json all = Json::array();
  for (const Question& question : shippedQuestions(session.dataHome())) {
    if (session.json) {
      all.push_back(questionJson(question));
      continue;
    }
    std::printf("%s\n  %s\n", question.file.filename().c_str(), question.title.c_str());
    for (const QueryParameter& p : question.parameters)
      std::printf("  --param %s=%s  [%s] %s\n", p.name.c_str(), p.default_value.c_str(), p.unit.c_str(), p.help.c_str());
    for (const QueryColumn& c : question.columns)
      std::printf("    ?%s [%s] %s\n", c.name.c_str(), c.unit.c_str(), c.help.c_str());
  }
  if (session.json) printJson(all);
  return ExitCode::Done;
}

}  // namespace

void addQuery(CLI::App& app, Session& session) {
  auto options = std::make_shared<QueryArguments>();
  CLI::App* command = app.add_subcommand("query", "ask a map, or an RDF file, in SPARQL");
  command->add_option("source", options->source, "a map, or an RDF file (.ttl .nt .nq .trig .rdf)")->required();
  command->add_option("query", options->file, "a query file, by path or by name in queries/");
  command->add_option("-e,--text", options->text, "the query itself");
  command->add_option("--param", options->params, "NAME=VALUE for a parameter of the question");
  command->add_option("--format", options->format, "table, json, xml, csv, tsv; for graphs turtle, ntriples");
  command->add_option("--deadline", options->deadline_s, "seconds after which the query fails with exit code 6")
      ->check(above0());
  command->add_option("--max-rows", options->max_rows, "rows above which the query fails with exit code 6")
      ->check(above0());
  command->add_option("--max-memory", options->max_memory_mib, "MiB above which the query fails with exit code 6")
      ->check(above0());
  command->add_flag("--explain", options->explain, "print the plan with estimated and actual rows on stderr");
  command->add_flag("--why-empty", options->why_empty, "when there is no row, name the pattern that left none");
  command->add_flag("--strict", options->strict, "the default graph is the unnamed graph, not the union");
  onRun(*command, session, [options, &session] { return query(*options, session); });
}

void addUpdate(CLI::App& app, Session& session) {
  auto options = std::make_shared<UpdateArguments>();
  CLI::App* command = app.add_subcommand("update", "change the operator's statements in a map by SPARQL Update");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("update", options->file, "a file with the update");
  command->add_option("-e,--text", options->text, "the update itself");
  onRun(*command, session, [options, &session] { return update(*options, session); });
}

void addTasks(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("tasks", "list the shipped questions with parameters and columns");
  onRun(*command, session, [&session] { return listTasks(session); });
}

}  // namespace cluxel::app
