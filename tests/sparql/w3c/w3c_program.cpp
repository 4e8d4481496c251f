// SPDX-License-Identifier: Apache-2.0
// Runs a test of the W3C suites by starting the program, and reads what it prints.
#include <sys/wait.h>

#include <cstdlib>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "sparql/support/results_reader_fixture.hpp"
#include "sparql/w3c/w3c_case.hpp"
#include "sparql/w3c/w3c_expectation.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace fs = std::filesystem;

namespace {

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

class ProgramCase {
 public:
  ProgramCase(const fs::path& program, const fs::path& scratch, const W3cFolder& folder, const W3cCase& test)
      : program_(program),
        scratch_(scratch),
        store_(scratch / "case.clx"),
        out_(scratch / "out"),
        folder_(folder),
        test_(test) {}

  std::string run() {
    fs::remove(store_);
    fs::remove(store_.string() + "-lock");
    if (test_.kind == W3cKind::QueryEvaluation || test_.kind == W3cKind::CsvResults) return query();
    if (test_.kind == W3cKind::UpdateEvaluation) return update();
    return syntax();
  }

 private:
  int call(const std::string& arguments) {
    const std::string command = quoted(program_.string()) + " " + arguments + " > " + quoted(out_.string()) + " 2> " +
                                quoted(out_.string() + ".err");
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string complaint(const std::string& what, int code) const {
    return what + " ended with exit code " + std::to_string(code) + ": " + readFile(out_.string() + ".err");
  }
  std::string load(const std::vector<W3cGraph>& graphs) {
    if (graphs.empty()) return loadNothing(store_);
    for (const W3cGraph& graph : graphs) {
      const std::string target = graph.iri.empty() ? "" : " --graph " + quoted(graph.iri);
      const int code = call("load " + quoted(store_.string()) + " " + quoted(graph.file.string()) + target +
                            " --base " + quoted(folder_.iriOf(graph.file)));
      if (code != 0) return complaint("load", code);
    }
    return {};
  }
  std::string loadNothing(const fs::path& store) {
    writeFile(scratch_ / "empty.nt", "");
    const int code = call("load " + quoted(store.string()) + " " + quoted((scratch_ / "empty.nt").string()));
    return code == 0 ? "" : complaint("load", code);
  }
  std::string request(const std::string& command, const std::string& more) const {
    return command + " " + quoted(store_.string()) + " " + quoted(test_.request.string()) + " --no-prefixes --base " +
           quoted(folder_.iriOf(test_.request)) + " " + more;
  }

  std::string query() {
    const ast::Query query = parsedRequest(folder_, test_, readFile(test_.request));
    if (std::string fault = load(datasetOf(folder_, test_, query)); !fault.empty()) return fault;
    const Expected expected = expectedOf(folder_, test_, query);
    const bool is_graph = query.form == ast::QueryForm::Construct || query.form == ast::QueryForm::Describe;
    const ResultFormat format = expected.format.value_or(ResultFormat::Json);
    const std::string name = is_graph                      ? "ntriples"
                             : format == ResultFormat::Csv ? "csv"
                             : format == ResultFormat::Tsv ? "tsv"
                             : format == ResultFormat::Xml ? "xml"
                                                           : "json";
    const int code = call(request("query", "--strict --format " + name));
    if (code != 0 && code != 1 && code != 3) return complaint("query", code);
    const Cardinality cardinality = test_.lax_cardinality ? Cardinality::Reduced : Cardinality::Exact;
    return difference(answer(is_graph, format), expected.result, expected.order, cardinality);
  }
  QueryResult answer(bool is_graph, ResultFormat format) const {
    if (!is_graph) return readResults(readFile(out_), format, "the program's answer");
    QueryResult result;
    result.kind = QueryResult::Kind::Graph;
    parseRdf({readFile(out_), "the program's answer", RdfFormat::NTriples, "http://answer/", Term::iri("")},
             [&result](const Quad& quad) { result.graph.push_back(quad); });
    return result;
  }

  std::string update() {
    if (std::string fault = load(test_.data); !fault.empty()) return fault;
    if (const int code = call(request("update", "--strict")); code != 0) return complaint("update", code);
    if (const int code = call("dump " + quoted(store_.string())); code != 0) return complaint("dump", code);
    std::map<std::string, std::vector<Quad>> graphs;
    parseRdf({readFile(out_), "the dump", RdfFormat::NQuads, "http://dump/", Term::iri("")},
             [&graphs](const Quad& quad) { graphs[quad.graph.text].push_back(quad); });
    return compareGraphs(folder_, test_, std::move(graphs));
  }

  /// Queries are run on an empty store, the same for all; those with SERVICE, and updates, are only checked.
  std::string syntax() {
    const bool is_update = test_.kind == W3cKind::PositiveUpdate || test_.kind == W3cKind::NegativeUpdate;
    const bool is_positive = test_.kind == W3cKind::PositiveQuery || test_.kind == W3cKind::PositiveUpdate;
    store_ = scratch_ / "empty.clx";
    if (!fs::exists(store_))
      if (std::string fault = loadNothing(store_); !fault.empty()) return fault;
    const std::string text = readFile(test_.request);
    const bool only_check = is_update || text.find("SERVICE") != std::string::npos;
    const int code = call(request(is_update ? "update" : "query", only_check ? "--check" : "--strict"));
    const bool is_taken = code == 0 || code == 1 || code == 3;
    if (is_taken == is_positive && (is_taken || code == 4)) return {};
    return complaint(is_positive ? "a right request" : "a faulty request", code);
  }

  fs::path program_, scratch_, store_, out_;
  const W3cFolder& folder_;
  const W3cCase& test_;
};

}  // namespace

std::string runCaseByProgram(const fs::path& program, const fs::path& scratch, const W3cFolder& folder,
                             const W3cCase& test) {
  try {
    return ProgramCase(program, scratch, folder, test).run();
  } catch (const std::exception& error) {
    return std::string("error: ") + error.what();
  }
}

}  // namespace cluxel::test
