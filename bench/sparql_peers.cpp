// SPDX-License-Identifier: Apache-2.0
// Puts the questions to each engine.
#include "sparql_peers.hpp"

#include <librdf.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/results/result_table.hpp"
#include "sparql/results/result_writer.hpp"

namespace cluxel::bench {

namespace fs = std::filesystem;

namespace {

constexpr const char* kPrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> "
    "PREFIX sosa: <http://www.w3.org/ns/sosa/> PREFIX geo: <http://www.opengis.net/ont/geosparql#> "
    "PREFIX geof: <http://www.opengis.net/def/function/geosparql/> ";

/// The sum of the actual rows of all operators, as the plan's text tells them.
double workRows(const rdf::Environment& environment, const Question& question) {
  const rdf::QuadReader reader(environment.read());
  sparql::PreparedQuery query(reader, question.text);
  sparql::NoSink sink;
  query.run(sink);
  const std::string plan = query.explain();
  constexpr std::string_view kMark = ", actual ";
  double sum = 0;
  for (std::size_t at = plan.find(kMark); at != std::string::npos; at = plan.find(kMark, at + 1))
    sum += std::strtod(plan.c_str() + at + kMark.size(), nullptr);
  return sum;
}

std::size_t linesOfAnswer(const rdf::Environment& environment, const Question& question) {
  const rdf::QuadReader reader(environment.read());
  std::string text;
  const auto writer = makeResultWriter(sparql::ResultFormat::Tsv, [&](std::string_view piece) { text += piece; });
  runQuery(reader, question.text, {}, *writer);
  return lines(text);
}

/// What the process of one rasqal question hands back through its pipe.
struct PipedMeasure {
  double seconds = -1;
  std::size_t rows = 0;
};

std::size_t rowsOfRasqal(librdf_world* world, librdf_model* model, const Question& question) {
  const auto* text = reinterpret_cast<const unsigned char*>(question.text.c_str());
  librdf_query* query = librdf_new_query(world, "sparql11-query", nullptr, text, nullptr);
  if (query == nullptr) _exit(1);
  librdf_query_results* results = librdf_model_query_execute(model, query);
  if (results == nullptr) _exit(1);
  std::size_t size = 0;
  if (librdf_query_results_is_boolean(results)) {  // TSV has no form for it
    librdf_query_results_get_boolean(results);
    librdf_free_query_results(results);
    librdf_free_query(query);
    return 1;
  }
  unsigned char* written = librdf_query_results_to_counted_string2(results, "tsv", nullptr, nullptr, nullptr, &size);
  if (written == nullptr) _exit(1);
  const std::size_t rows = lines({reinterpret_cast<char*>(written), size});
  librdf_free_memory(written);
  librdf_free_query_results(results);
  librdf_free_query(query);
  return rows;
}

Measure askRasqal(librdf_world* world, librdf_model* model, const Question& question) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    alarm(static_cast<unsigned>(kMaxSecondsPerQuery) * 2);
    const Measure measure = measured([&] { return rowsOfRasqal(world, model, question); });
    const PipedMeasure piped{measure.seconds, measure.rows};
    if (write(ends[1], &piped, sizeof piped) != sizeof piped) _exit(1);
    _exit(0);
  }
  close(ends[1]);
  PipedMeasure piped;
  const bool answered = read(ends[0], &piped, sizeof piped) == sizeof piped;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  Measure measure;
  if (answered) {
    measure.seconds = piped.seconds;
    measure.rows = piped.rows;
  } else if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) {
    measure.failure = "over " + std::to_string(static_cast<int>(kMaxSecondsPerQuery) * 2) + " s";
  } else {
    measure.failure = WIFSIGNALED(status) ? "crashed" : "refused";
  }
  return measure;
}

}  // namespace

std::vector<Question> readQuestions(const fs::path& file, const std::string& only) {
  std::ifstream in(file);
  std::vector<Question> result;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("== "))
      result.push_back({line.substr(3), kPrefixes});
    else if (!line.empty() && line[0] != '#' && !result.empty())
      result.back().text += line + "\n";
  }
  std::erase_if(result, [&](const Question& q) { return q.name.find(only) == std::string::npos; });
  return result;
}

Measures askCluxel(const rdf::Environment& environment, const std::vector<Question>& asked) {
  Measures measures;
  for (const Question& question : asked) {
    Measure& measure = measures[question.name];
    measure = measured([&] { return linesOfAnswer(environment, question); });
    measure.work_rows = workRows(environment, question);
  }
  return measures;
}

std::pair<Measures, Measures> askCluxelInTurn(const rdf::Environment& small, const rdf::Environment& large,
                                              const std::vector<Question>& asked) {
  std::pair<Measures, Measures> measures;
  for (const Question& question : asked) {
    const auto [of_small, of_large] =
        measuredInTurn([&] { return linesOfAnswer(small, question); }, [&] { return linesOfAnswer(large, question); });
    measures.first[question.name] = of_small;
    measures.second[question.name] = of_large;
    measures.first[question.name].work_rows = workRows(small, question);
    measures.second[question.name].work_rows = workRows(large, question);
  }
  return measures;
}

Measures askOxigraph(const fs::path& module, const fs::path& nt_file, const std::vector<Question>& asked) {
  const fs::path requests = nt_file.string() + ".requests.json", answers = nt_file.string() + ".answers.json";
  nlohmann::json list = nlohmann::json::array();
  for (const Question& question : asked) list.push_back({{"name", question.name}, {"query", question.text}});
  std::ofstream(requests) << list;
  const std::string script = std::string(CLUXEL_SOURCE_DIR) + "/bench/sparql_oxigraph.mjs";
  const std::string command = "node --max-old-space-size=8000 '" + script + "' '" + module.string() + "' '" +
                              nt_file.string() + "' '" + requests.string() + "' '" + answers.string() + "'";
  Measures measures;
  if (std::system(command.c_str()) == 0) {
    nlohmann::json read;
    std::ifstream(answers) >> read;
    for (const auto& answer : read) {
      Measure& measure = measures[answer["name"]];
      measure.seconds = answer["seconds"];
      measure.rows = answer["rows"];
      measure.given_up = answer.contains("given_up");
      if (answer.contains("error")) measure.failure = "refused";
    }
  }
  fs::remove(requests);
  fs::remove(answers);
  return measures;
}

Measures askRasqal(const fs::path& nt_file, const std::vector<Question>& asked) {
  librdf_world* world = librdf_new_world();
  librdf_world_open(world);
  librdf_world_set_logger(world, nullptr, [](void*, librdf_log_message*) { return 1; });
  librdf_storage* storage = librdf_new_storage(world, "trees", nullptr, nullptr);
  librdf_model* model = librdf_new_model(world, storage, nullptr);
  librdf_parser* parser = librdf_new_parser(world, "ntriples", nullptr, nullptr);
  librdf_uri* uri = librdf_new_uri_from_filename(world, nt_file.c_str());
  Measures measures;
  if (librdf_parser_parse_into_model(parser, uri, uri, model) == 0) {
    for (const Question& question : asked) measures[question.name] = askRasqal(world, model, question);
  }
  return measures;
}

}  // namespace cluxel::bench
