// SPDX-License-Identifier: Apache-2.0
// Sends data and queries to oxigraph_answers.mjs and reads its answers.
#include "sparql/support/second_engine_fixture.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/file_bytes.hpp"
#include "rdf/io/rdf_io.hpp"
#include "sparql/support/results_reader_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

namespace {

using nlohmann::json;

/// A temporary folder that is removed afterwards.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cluxel-second-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::filesystem::path file(const char* name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

std::string requestsAsJson(const std::vector<EngineRequest>& requests) {
  json list = json::array();
  for (const EngineRequest& request : requests) list.push_back(request.query);
  return list.dump();
}

QueryResult graphOf(const std::string& text) {
  QueryResult result;
  result.kind = QueryResult::Kind::Graph;
  parseRdf({.text = text, .name = "answer", .format = RdfFormat::NTriples, .base_iri = {}, .graph = Term::iri("")},
           [&result](const Quad& quad) { result.graph.push_back(quad); });
  return result;
}

EngineAnswer answerOf(const json& entry) {
  const std::string kind = entry.at("kind"), text = entry.at("text");
  if (kind == "ERROR") return {std::nullopt, text};
  if (kind == "CONSTRUCT") return {graphOf(text), {}};
  return {readResults(text, ResultFormat::Json), {}};
}

}  // namespace

std::optional<std::filesystem::path> secondEngineFolder() {
  if (std::system("node --version >/dev/null 2>&1") != 0) return std::nullopt;
  std::vector<std::filesystem::path> places{test::sourceFolder() / "build/npm", test::buildFolder() / "npm"};
  if (const char* told = std::getenv("CLUXEL_OXIGRAPH")) places.insert(places.begin(), told);
  for (const std::filesystem::path& place : places)
    if (std::filesystem::exists(place / "node_modules/oxigraph")) return place;
  return std::nullopt;
}

std::vector<EngineAnswer> askSecondEngine(const std::filesystem::path& folder, const std::vector<Quad>& data,
                                          const std::vector<EngineRequest>& requests) {
  const ScratchFolder scratch;
  std::string quads;
  for (const Quad& quad : data) quads += toNQuads(quad);
  writeFile(scratch.file("data.nq"), quads);
  writeFile(scratch.file("requests.json"), requestsAsJson(requests));
  const std::string script = (test::sourceFolder() / "tests/sparql/oxigraph_answers.mjs").string();
  const std::string command = "node '" + script + "' '" + folder.string() + "' '" + scratch.file("data.nq").string() +
                              "' '" + scratch.file("requests.json").string() + "' '" +
                              scratch.file("answers.json").string() + "'";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("node failed: " + command);
  const json document = json::parse(readFile(scratch.file("answers.json")));
  std::vector<EngineAnswer> answers;
  for (const json& entry : document.at("answers")) answers.push_back(answerOf(entry));
  return answers;
}

}  // namespace cluxel::test
