// SPDX-License-Identifier: Apache-2.0
// Reads manifests (mf:, qt:, ut: vocabularies) with Cluxel's Turtle reader.
#include "sparql/w3c/w3c_manifest.hpp"

#include <map>
#include <set>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::test {

using namespace rdf;

namespace {

constexpr std::string_view kRoot = "http://w3c.test/sparql/";

std::string mf(std::string_view local) {
  return std::string("http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#").append(local);
}
std::string qt(std::string_view local) {
  return std::string("http://www.w3.org/2001/sw/DataAccess/tests/test-query#").append(local);
}
std::string ut(std::string_view local) {
  return std::string("http://www.w3.org/2009/sparql/tests/test-update#").append(local);
}

const std::map<std::string, W3cKind>& kinds() {
  static const std::map<std::string, W3cKind> known{{mf("QueryEvaluationTest"), W3cKind::QueryEvaluation},
                                                    {mf("CSVResultFormatTest"), W3cKind::CsvResults},
                                                    {mf("UpdateEvaluationTest"), W3cKind::UpdateEvaluation},
                                                    {mf("PositiveSyntaxTest"), W3cKind::PositiveQuery},
                                                    {mf("PositiveSyntaxTest11"), W3cKind::PositiveQuery},
                                                    {mf("NegativeSyntaxTest"), W3cKind::NegativeQuery},
                                                    {mf("NegativeSyntaxTest11"), W3cKind::NegativeQuery},
                                                    {mf("PositiveUpdateSyntaxTest11"), W3cKind::PositiveUpdate},
                                                    {mf("NegativeUpdateSyntaxTest11"), W3cKind::NegativeUpdate}};
  return known;
}

class Manifest {
 public:
  Manifest(const W3cFolder& folder, const std::string& iri) : folder_(folder) {
    RdfSource source = readRdfSource(folder.fileOf(iri));
    source.base_iri = iri;
    parseRdf(source, [this](const Quad& quad) { objects_[quad.subject][quad.predicate.text].push_back(quad.object); });
    group_ = std::filesystem::path(iri.substr(kRoot.size())).parent_path().string();
  }

  std::vector<std::string> included() const {
    std::vector<std::string> iris;
    for (const auto& [subject, properties] : objects_)
      for (const Term& list : all(subject, mf("include")))
        for (const Term& entry : listOf(list)) iris.push_back(entry.text);
    return iris;
  }

  std::vector<W3cCase> cases() const {
    std::vector<W3cCase> found;
    for (const auto& [subject, properties] : objects_)
      for (const Term& list : all(subject, mf("entries")))
        for (const Term& entry : listOf(list)) found.push_back(caseOf(entry));
    return found;
  }

 private:
  const std::vector<Term>& all(const Term& subject, const std::string& property) const {
    static const std::vector<Term> none;
    const auto properties = objects_.find(subject);
    if (properties == objects_.end()) return none;
    const auto objects = properties->second.find(property);
    return objects == properties->second.end() ? none : objects->second;
  }
  std::optional<Term> first(const Term& subject, const std::string& property) const {
    const std::vector<Term>& objects = all(subject, property);
    return objects.empty() ? std::nullopt : std::optional<Term>(objects[0]);
  }
  std::vector<Term> listOf(Term cell) const {
    std::vector<Term> entries;
    while (const std::optional<Term> value = first(cell, vocabulary::rdf("first"))) {
      entries.push_back(*value);
      cell = first(cell, vocabulary::rdf("rest")).value();
    }
    return entries;
  }
  std::vector<W3cGraph> graphs(const Term& node, const std::string& data, const std::string& graph_data) const {
    std::vector<W3cGraph> found;
    for (const Term& file : all(node, data)) found.push_back({"", folder_.fileOf(file.text)});
    for (const Term& graph : all(node, graph_data)) {
      const std::optional<Term> file = first(graph, ut("graph")), label = first(graph, vocabulary::rdfs("label"));
      found.push_back({label ? label->text : graph.text, folder_.fileOf(file ? file->text : graph.text)});
    }
    return found;
  }
  W3cCase caseOf(const Term& entry) const;

  const W3cFolder& folder_;
  std::string group_;
  std::map<Term, std::map<std::string, std::vector<Term>>> objects_;
};

W3cCase Manifest::caseOf(const Term& entry) const {
  W3cCase test;
  test.group = group_;
  const std::size_t mark = entry.text.find('#');
  test.id = group_ + "#" + entry.text.substr(mark == std::string::npos ? 0 : mark + 1);
  const std::optional<Term> type = first(entry, vocabulary::rdf("type")), action = first(entry, mf("action"));
  if (!type || !action || !kinds().contains(type->text))
    throw InputError({.file = group_}, test.id + ": no test of a known type: " + (type ? type->text : ""));
  test.kind = kinds().at(type->text);
  const bool update = test.kind == W3cKind::UpdateEvaluation;
  const std::optional<Term> request = first(*action, update ? ut("request") : qt("query"));
  test.request = folder_.fileOf(request ? request->text : action->text);
  test.data = graphs(*action, update ? ut("data") : qt("data"), update ? ut("graphData") : qt("graphData"));
  test.lax_cardinality = !all(entry, mf("resultCardinality")).empty();
  const std::optional<Term> result = first(entry, mf("result"));
  if (result && update) test.graphs_after = graphs(*result, ut("data"), ut("graphData"));
  if (result && !update) test.result = folder_.fileOf(result->text);
  return test;
}

}  // namespace

std::string W3cFolder::iriOf(const std::filesystem::path& file) const {
  return std::string(kRoot) + file.lexically_relative(folder_).generic_string();
}

std::filesystem::path W3cFolder::fileOf(const std::string& iri) const {
  if (!iri.starts_with(kRoot)) throw Error(ErrorKind::FaultyInput, iri + " is no file of the suites");
  return folder_ / iri.substr(kRoot.size());
}

std::vector<W3cCase> readManifest(const W3cFolder& folder, const std::string& manifest) {
  const Manifest read(folder, folder.iriOf(folder.path() / manifest));
  std::vector<W3cCase> cases = read.cases();
  for (const std::string& iri : read.included()) {
    const std::string name = folder.fileOf(iri).lexically_relative(folder.path()).generic_string();
    for (W3cCase& test : readManifest(folder, name)) cases.push_back(std::move(test));
  }
  return cases;
}

}  // namespace cluxel::test
