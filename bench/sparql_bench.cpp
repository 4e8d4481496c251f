// SPDX-License-Identifier: Apache-2.0
// Cluxel's SPARQL engine beside oxigraph (npm, WASM) and rasqal over librdf's `trees`, in one run: text in, TSV out.
//   sparql_bench [--triples N] [--others] [--only NAME] [--module FOLDER]
#include <librdf.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/sparql/query_engine.hpp"
#include "cluxel/sparql/result_writer.hpp"
#include "sparql_data.hpp"

namespace {

using namespace cluxel;
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr const char* kPrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> "
    "PREFIX sosa: <http://www.w3.org/ns/sosa/> PREFIX geo: <http://www.opengis.net/ont/geosparql#> "
    "PREFIX geof: <http://www.opengis.net/def/function/geosparql/> ";
constexpr double kMostSecondsPerQuery = 5;

struct Question {
  std::string name, text;
};

/// Seconds of the median run, and the rows of the answer.
struct Measure {
  double seconds = -1;
  std::size_t rows = 0;
  bool given_up = false;   ///< the seconds are a lower bound
};

std::vector<Question> questions(const fs::path& file, const std::string& only) {
  std::ifstream in(file);
  std::vector<Question> result;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("== ")) result.push_back({line.substr(3), kPrefixes});
    else if (!line.empty() && line[0] != '#' && !result.empty()) result.back().text += line + "\n";
  }
  std::erase_if(result, [&](const Question& q) { return q.name.find(only) == std::string::npos; });
  return result;
}

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Runs at least five times, or for half a second.
template <typename Run>
Measure measured(Run run) {
  std::vector<double> seconds;
  Measure measure;
  const auto start = Clock::now();
  while (seconds.size() < 5 || (seconds.size() < 200 && since(start) < 0.4)) {
    const auto begin = Clock::now();
    measure.rows = run();
    seconds.push_back(since(begin));
    if (since(start) > kMostSecondsPerQuery) break;
  }
  std::sort(seconds.begin(), seconds.end());
  measure.seconds = seconds[seconds.size() / 2];
  return measure;
}

std::size_t lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

void load(Environment& environment, std::uint64_t triples, const fs::path& nt_file) {
  std::ofstream out;
  if (!nt_file.empty()) out.open(nt_file);
  WriteTransaction transaction = environment.write();
  QuadWriter writer(transaction);
  bench::generateMap(triples, [&](const Quad& quad) {
    writer.add(quad);
    // The peers get all triples in one default graph: their best case.
    if (out.is_open()) out << toNTriples(quad.subject) << ' ' << toNTriples(quad.predicate) << ' ' << toNTriples(quad.object) << " .\n";
  });
  writer.flush();
  transaction.commit();
}

std::map<std::string, Measure> askCluxel(const Environment& environment, const std::vector<Question>& asked) {
  std::map<std::string, Measure> measures;
  for (const Question& question : asked) {
    measures[question.name] = measured([&] {
      const QuadReader reader(environment.read());
      std::string text;
      const auto writer = makeResultWriter(ResultFormat::Tsv, [&](std::string_view piece) { text += piece; });
      runQuery(reader, question.text, {}, *writer);
      return lines(text);
    });
  }
  return measures;
}

std::map<std::string, Measure> askOxigraph(const fs::path& module, const fs::path& nt_file, const std::vector<Question>& asked) {
  const fs::path requests = nt_file.string() + ".requests.json", answers = nt_file.string() + ".answers.json";
  nlohmann::json list = nlohmann::json::array();
  for (const Question& question : asked) list.push_back({{"name", question.name}, {"query", question.text}});
  std::ofstream(requests) << list;
  const std::string script = std::string(CLUXEL_SOURCE_DIR) + "/bench/sparql_oxigraph.mjs";
  const std::string command = "node --max-old-space-size=8000 '" + script + "' '" + module.string() + "' '" + nt_file.string() +
                              "' '" + requests.string() + "' '" + answers.string() + "'";
  std::map<std::string, Measure> measures;
  if (std::system(command.c_str()) != 0) return measures;
  nlohmann::json read;
  std::ifstream(answers) >> read;
  for (const auto& answer : read) measures[answer["name"]] = {answer["seconds"], answer["rows"], answer.contains("given_up")};
  return measures;
}

/// Rasqal through librdf, in a process of its own that a deadline ends.
Measure askRasqal(librdf_world* world, librdf_model* model, const Question& question) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    alarm(static_cast<unsigned>(kMostSecondsPerQuery) * 2);
    const Measure measure = measured([&]() -> std::size_t {
      librdf_query* query = librdf_new_query(world, "sparql11-query", nullptr, reinterpret_cast<const unsigned char*>(question.text.c_str()), nullptr);
      if (query == nullptr) _exit(1);
      librdf_query_results* results = librdf_model_query_execute(model, query);
      if (results == nullptr) _exit(1);
      std::size_t size = 0;
      unsigned char* text = librdf_query_results_to_counted_string2(results, "tsv", nullptr, nullptr, nullptr, &size);
      if (text == nullptr) _exit(1);
      const std::size_t rows = lines({reinterpret_cast<char*>(text), size});
      librdf_free_memory(text);
      librdf_free_query_results(results);
      librdf_free_query(query);
      return rows;
    });
    if (write(ends[1], &measure, sizeof measure) != sizeof measure) _exit(1);
    _exit(0);
  }
  close(ends[1]);
  Measure measure;
  if (read(ends[0], &measure, sizeof measure) != sizeof measure) measure = {};
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return measure;
}

std::map<std::string, Measure> askRasqal(const fs::path& nt_file, const std::vector<Question>& asked) {
  librdf_world* world = librdf_new_world();
  librdf_world_open(world);
  librdf_world_set_logger(world, nullptr, [](void*, librdf_log_message*) { return 1; });
  librdf_storage* storage = librdf_new_storage(world, "trees", nullptr, nullptr);
  librdf_model* model = librdf_new_model(world, storage, nullptr);
  librdf_parser* parser = librdf_new_parser(world, "ntriples", nullptr, nullptr);
  librdf_uri* uri = librdf_new_uri_from_filename(world, nt_file.c_str());
  std::map<std::string, Measure> measures;
  if (librdf_parser_parse_into_model(parser, uri, uri, model) == 0) {
    for (const Question& question : asked) measures[question.name] = askRasqal(world, model, question);
  }
  return measures;
}

std::string cell(const std::map<std::string, Measure>& measures, const std::string& name) {
  const auto found = measures.find(name);
  if (found == measures.end() || found->second.seconds < 0) return "-";
  std::ostringstream text;
  text.precision(3);
  if (found->second.given_up) text << "> ";
  text << found->second.seconds * 1000;
  return text.str();
}

void printTable(const std::vector<Question>& asked, const std::map<std::string, Measure>& ours,
                const std::map<std::string, Measure>& oxigraph, const std::map<std::string, Measure>& rasqal) {
  std::printf("| question | rows | cluxel [ms] | oxigraph [ms] | ratio | rasqal trees [ms] | ratio |\n|---|---|---|---|---|---|---|\n");
  double logs = 0, least = HUGE_VAL;
  std::string slowest;
  int compared = 0;
  const auto ratio = [&](const std::map<std::string, Measure>& others, const std::string& name) {
    const auto found = others.find(name);
    return found == others.end() || found->second.seconds < 0 ? -1 : found->second.seconds / ours.at(name).seconds;
  };
  for (const Question& question : asked) {
    const double to_oxigraph = ratio(oxigraph, question.name), to_rasqal = ratio(rasqal, question.name);
    const auto other = oxigraph.find(question.name);
    const bool same = other == oxigraph.end() || other->second.given_up || other->second.rows == ours.at(question.name).rows;
    std::printf("| %s | %zu%s | %s | %s | %.1f | %s | %.1f |\n", question.name.c_str(), ours.at(question.name).rows,
                same ? "" : (" (oxigraph " + std::to_string(other->second.rows) + ")").c_str(), cell(ours, question.name).c_str(),
                cell(oxigraph, question.name).c_str(), to_oxigraph, cell(rasqal, question.name).c_str(), to_rasqal);
    if (to_oxigraph <= 0) continue;
    logs += std::log(to_oxigraph);
    ++compared;
    if (to_oxigraph < least) least = to_oxigraph, slowest = question.name;
  }
  if (compared > 0) {
    std::printf("\n%d questions: %.1f times oxigraph's speed in the geometric mean, least %.1f (%s)\n", compared,
                std::exp(logs / compared), least, slowest.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t triples = 100'000;
  std::string only;
  bool others = true, with_rasqal = true;
  fs::path module = fs::path(CLUXEL_SOURCE_DIR) / "build/npm";
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    if (option == "--triples" && i + 1 < argc) triples = std::stoull(argv[++i]);
    if (option == "--only" && i + 1 < argc) only = argv[++i];
    if (option == "--module" && i + 1 < argc) module = argv[++i];
    if (option == "--alone") others = false;
    if (option == "--no-rasqal") with_rasqal = false;
  }
  const auto asked = questions(fs::path(CLUXEL_SOURCE_DIR) / "bench/sparql_queries.txt", only);
  const fs::path nt_file = others ? fs::temp_directory_path() / ("cluxel_sparql_bench_" + std::to_string(getpid()) + ".nt") : fs::path();
  const auto environment = Environment::temporary();
  auto start = Clock::now();
  load(*environment, triples, nt_file);
  std::printf("%llu triples, loaded and written in %.1f s\n\n",
              static_cast<unsigned long long>(QuadReader(environment->read()).size()), since(start));
  std::fflush(stdout);
  const auto ours = askCluxel(*environment, asked);
  std::map<std::string, Measure> oxigraph, rasqal;
  if (others && fs::exists(module / "node_modules/oxigraph")) oxigraph = askOxigraph(module, nt_file, asked);
  if (others && with_rasqal) rasqal = askRasqal(nt_file, asked);
  printTable(asked, ours, oxigraph, rasqal);
  for (const char* ending : {"", ".requests.json", ".answers.json"}) {
    if (others) fs::remove(nt_file.string() + ending);
  }
  return 0;
}
