// SPDX-License-Identifier: Apache-2.0
// Cluxel's SPARQL engine beside rasqal over librdf's `trees` (10k triples) and oxigraph (npm, WASM; 100k and 1M), and
// alone at 10M: text in, TSV out, all in one run.
//   sparql_bench [--only NAME] [--module FOLDER] [--rasqal N] [--oxigraph N,N] [--alone N]     (0: leave out)
//                [--questions FILE]     a file in bench/, by default sparql_queries.txt
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>

#include "rdf/store/quad_store.hpp"
#include "sparql/query_engine.hpp"
#include "sparql_data.hpp"
#include "sparql_peers.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::bench;
namespace fs = std::filesystem;

struct Arguments {
  std::string only, questions = "sparql_queries.txt";
  fs::path module = fs::path(CLUXEL_SOURCE_DIR) / "build/npm";
  std::uint64_t rasqal = 10'000, alone = 10'000'000;
  std::vector<std::uint64_t> oxigraph = {100'000, 1'000'000};
};

Arguments argumentsOf(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--only") arguments.only = value;
    if (option == "--questions") arguments.questions = value;
    if (option == "--module") arguments.module = fs::absolute(value);  // node would look beside its script
    if (option == "--rasqal") arguments.rasqal = std::stoull(value);
    if (option == "--alone") arguments.alone = std::stoull(value);
    if (option != "--oxigraph") continue;
    arguments.oxigraph.clear();
    std::istringstream sizes(value);
    for (std::string size; std::getline(sizes, size, ',');)
      if (size != "0") arguments.oxigraph.push_back(std::stoull(size));
  }
  return arguments;
}

/// A generated map in a store, and for the peers as a file of triples, all in one default graph: their best case.
class Data {
 public:
  Data(std::uint64_t triples, bool with_file) : environment_(rdf::Environment::temporary()) {
    const auto start = std::chrono::steady_clock::now();
    std::ofstream out;
    if (with_file) {
      file_ = fs::temp_directory_path() / ("cluxel_sparql_bench_" + std::to_string(getpid()) + ".nt");
      out.open(file_);
    }
    rdf::WriteTransaction transaction = environment_->write();
    rdf::QuadWriter writer(transaction);
    generateMap(triples, [&](const Quad& quad) {
      writer.add(quad);
      if (out.is_open())
        out << toNTriples(quad.subject) << ' ' << toNTriples(quad.predicate) << ' ' << toNTriples(quad.object)
            << " .\n";
    });
    writer.flush();
    transaction.commit();
    std::printf("\n%llu triples, made and loaded in %.1f s\n\n",
                static_cast<unsigned long long>(rdf::QuadReader(environment_->read()).size()), since(start));
    std::fflush(stdout);
  }
  ~Data() {
    if (!file_.empty()) fs::remove(file_);
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
  const rdf::Environment& environment() const { return *environment_; }
  const fs::path& file() const { return file_; }

 private:
  std::shared_ptr<rdf::Environment> environment_;
  fs::path file_;
};

std::string milliseconds(const Measure& measure) {
  if (measure.seconds < 0) return measure.failure.empty() ? "-" : measure.failure;
  std::ostringstream text;
  text.precision(3);
  if (measure.given_up) text << "> ";
  text << measure.seconds * 1000;
  return text.str();
}

std::string nameOfLeast(const std::map<std::string, double>& ratios) {
  return std::min_element(ratios.begin(), ratios.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void printComparison(const std::string& peer, const std::vector<Question>& asked, const Measures& ours,
                     const Measures& theirs) {
  std::printf(
      "| question | rows | cluxel [ms] | %s [ms] | ratio | cluxel, processor [ms] |\n|---|---|---|---|---|---|\n",
      peer.c_str());
  double logs = 0;
  std::map<std::string, double> ratios;
  std::size_t wrong = 0, unanswered = 0;
  for (const Question& question : asked) {
    const Measure& mine = ours.at(question.name);
    const auto found = theirs.find(question.name);
    const Measure other = found == theirs.end() ? Measure() : found->second;
    const bool answered = other.seconds >= 0, same = !answered || other.given_up || other.rows == mine.rows;
    const double ratio = other.seconds / mine.seconds;
    std::printf("| %s | %zu%s | %s | %s | %s | %.3g |\n", question.name.c_str(), mine.rows,
                same ? "" : (" (" + peer + " " + std::to_string(other.rows) + ")").c_str(), milliseconds(mine).c_str(),
                milliseconds(other).c_str(),
                answered ? (std::ostringstream() << std::fixed << std::setprecision(1) << ratio).str().c_str() : "",
                mine.processor * 1000);
    wrong += same ? 0 : 1;
    unanswered += answered ? 0 : 1;
    if (!answered) continue;
    logs += std::log(ratio);
    ratios[question.name] = ratio;
  }
  if (ratios.empty()) return;
  const std::string least = nameOfLeast(ratios);
  std::printf(
      "\n%zu questions answered by both: %.1f times the speed of %s in the geometric mean, least %.1f (%s); %zu with "
      "other rows, "
      "%zu without an answer by %s\n",
      ratios.size(), std::exp(logs / static_cast<double>(ratios.size())), peer.c_str(), ratios.at(least), least.c_str(),
      wrong, unanswered, peer.c_str());
  std::fflush(stdout);
}

/// The same question with its patterns in another order: names that differ by "_bad".
void printOrders(const std::vector<Question>& asked, const Measures& ours) {
  std::printf("\nPatterns in bad order against good order, time:");
  for (const Question& question : asked) {
    if (!question.name.ends_with("_bad")) continue;
    const std::string stem = question.name.substr(0, question.name.size() - 4);
    const auto good = ours.contains(stem) ? ours.find(stem) : ours.find(stem + "_good");
    if (good != ours.end())
      std::printf(" %s %.2f", stem.c_str(), ours.at(question.name).seconds / good->second.seconds);
  }
  std::printf("\n");
}

/// Growth against the smaller data, measured in turn: time, rows of the answer, rows that the operators had to make.
void printGrowth(const std::vector<Question>& asked, const Measures& small, const Measures& large) {
  std::printf(
      "| question | rows | cluxel [ms] | time grows | rows grow | work grows | bar |\n|---|---|---|---|---|---|---|\n");
  std::size_t over = 0;
  for (const Question& question : asked) {
    const Measure &before = small.at(question.name), &now = large.at(question.name);
    const double time = now.seconds / before.seconds;
    const double rows = static_cast<double>(std::max<std::size_t>(now.rows, 1)) /
                        static_cast<double>(std::max<std::size_t>(before.rows, 1));
    const double work = now.work_rows / std::max(before.work_rows, 1.0);
    // An aggregate, a filter or a LIMIT answers with few rows from many: what grows is what it has to read.
    const double grown = std::max(rows, work), bar = grown <= 1 ? 3 : std::max(3.0, 1.5 * grown);
    over += time > bar ? 1 : 0;
    std::printf("| %s | %zu | %s | %.1f | %.1f | %.1f | %.1f%s |\n", question.name.c_str(), now.rows,
                milliseconds(now).c_str(), time, rows, work, bar, time > bar ? " over" : "");
  }
  std::printf("\n%zu of %zu questions grow more than 1.5 times what their rows grow (3 times where those are equal)\n",
              over, asked.size());
}

/// Text to plan, without running it.
void printPreparation(const rdf::Environment& environment, const std::vector<Question>& asked) {
  const rdf::QuadReader reader(environment.read());
  std::printf("\nParse and plan [ms]:");
  for (const Question& question : asked) {
    for (const char* name : {"class_lookup", "one_object", "star3_good", "chain3_bad", "range_height", "star5_bad"}) {
      if (question.name != name) continue;
      const Measure measure = measured([&] { return sparql::PreparedQuery(reader, question.text).variables().size(); });
      std::printf(" %s %.4f", name, measure.seconds * 1000);
    }
  }
  std::printf("\n");
}

/// A geo filter from the R-tree, and the same one where the planner does not see it; the first also makes the tree.
void printGeometry(const rdf::Environment& environment) {
  const rdf::QuadReader reader(environment.read());
  const std::string prefixes =
      "PREFIX geo: <http://www.opengis.net/ont/geosparql#> PREFIX geof: "
      "<http://www.opengis.net/def/function/geosparql/> ";
  std::printf("\nGeo filters [ms]:");
  for (const char* radius : {"10", "100"}) {
    const std::string filter = std::string("geof:distance(?w, \"POINT(200 200)\"^^geo:wktLiteral) < ") + radius;
    const auto ask = [&](const std::string& condition) {
      return sparql::evaluateQuery(reader, prefixes + "SELECT ?g { ?g geo:asWKT ?w FILTER(" + condition + ") }")
          .table.row_count;
    };
    const auto start = std::chrono::steady_clock::now();
    ask(filter);
    const double first = since(start);
    const Measure indexed = measured([&] { return ask(filter); });
    const Measure plain = measured([&] { return ask("IF(" + filter + ", true, false)"); });
    std::printf(" %zu found within %s m: first %.3f, then %.4f, without the tree %.3f;", indexed.rows, radius,
                first * 1000, indexed.seconds * 1000, plain.seconds * 1000);
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  const auto asked = readQuestions(fs::path(CLUXEL_SOURCE_DIR) / "bench" / arguments.questions, arguments.only);
  if (arguments.rasqal > 0) {
    const Data data(arguments.rasqal, true);
    printComparison("rasqal", asked, askCluxel(data.environment(), asked), askRasqal(data.file(), asked));
  }
  const bool has_oxigraph = fs::exists(arguments.module / "node_modules/oxigraph");
  if (!has_oxigraph) std::printf("oxigraph is not in %s: npm install there\n", arguments.module.c_str());
  std::optional<Data> data;  // the last stays for the growth
  for (const std::uint64_t triples : arguments.oxigraph) {
    data.emplace(triples, has_oxigraph);
    const Measures ours = askCluxel(data->environment(), asked);
    printComparison("oxigraph", asked, ours,
                    has_oxigraph ? askOxigraph(arguments.module, data->file(), asked) : Measures());
    printOrders(asked, ours);
    printPreparation(data->environment(), asked);
    printGeometry(data->environment());
  }
  if (arguments.alone > 0 && data) {
    const Data large(arguments.alone, false);
    const auto [small_measures, large_measures] = askCluxelInTurn(data->environment(), large.environment(), asked);
    printGrowth(asked, small_measures, large_measures);
    printGeometry(large.environment());
  }
  return 0;
}
