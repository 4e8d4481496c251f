// SPDX-License-Identifier: Apache-2.0
// Languages, formats and graphs of an endpoint as triples.
#include "serve/resources/service_description.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::serve {

namespace {

constexpr const char* kSd = "http://www.w3.org/ns/sparql-service-description#";
constexpr const char* kFormats = "http://www.w3.org/ns/formats/";
constexpr const char* kVoid = "http://rdfs.org/ns/void#";

Term sd(const char* local) {
  return Term::iri(kSd + std::string(local));
}

class Description {
 public:
  void add(const Term& subject, const Term& property, const Term& object) {
    result_.graph.push_back({subject, property, object, Term::iri("")});
  }
  void type(const Term& subject, const Term& type_iri) {
    add(subject, Term::iri(rdf::vocabulary::rdf("type")), type_iri);
  }
  sparql::QueryResult take() {
    result_.kind = sparql::QueryResult::Kind::Graph;
    return std::move(result_);
  }

 private:
  sparql::QueryResult result_;
};

Term count(std::uint64_t value) {
  return Term::integer(static_cast<std::int64_t>(value));
}

void describeGraphs(Description& out, const rdf::QuadReader& snapshot) {
  const Term dataset = Term::blank("dataset"), all = Term::blank("defaultGraph");
  out.type(dataset, sd("Dataset"));
  out.add(dataset, sd("defaultGraph"), all);
  out.type(all, sd("Graph"));
  out.add(all, Term::iri(rdf::vocabulary::rdfs("comment")),
          Term::langLiteral("the union of all graphs but history, unless a request names graphs", "en"));
  std::size_t number = 0;
  for (const rdf::TermId id : snapshot.graphs()) {
    if (id == rdf::kNoTerm) continue;
    const std::string label = std::to_string(++number);
    const Term named = Term::blank("named" + label), graph = Term::blank("graph" + label);
    rdf::QuadPattern pattern;
    pattern.g = id;
    out.add(dataset, sd("namedGraph"), named);
    out.type(named, sd("NamedGraph"));
    out.add(named, sd("name"), snapshot.termOf(id));
    out.add(named, sd("graph"), graph);
    out.type(graph, sd("Graph"));
    out.add(graph, Term::iri(kVoid + std::string("triples")), count(snapshot.count(pattern)));
  }
}

}  // namespace

sparql::QueryResult serviceDescription(const rdf::QuadReader& snapshot, const std::string& endpoint,
                                       bool takes_updates) {
  Description out;
  const Term service = Term::blank("service");
  out.type(service, sd("Service"));
  out.add(service, sd("endpoint"), Term::iri(endpoint));
  out.add(service, sd("supportedLanguage"), sd("SPARQL11Query"));
  if (takes_updates) out.add(service, sd("supportedLanguage"), sd("SPARQL11Update"));
  for (const char* format :
       {"SPARQL_Results_JSON", "SPARQL_Results_XML", "SPARQL_Results_CSV", "SPARQL_Results_TSV", "Turtle", "N-Triples"})
    out.add(service, sd("resultFormat"), Term::iri(kFormats + std::string(format)));
  out.add(service, sd("defaultDataset"), Term::blank("dataset"));
  describeGraphs(out, snapshot);
  return out.take();
}

}  // namespace cluxel::serve
