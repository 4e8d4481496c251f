// SPDX-License-Identifier: Apache-2.0
// Selects result formats by name and creates their writers.
#include "sparql/results/result_writer.hpp"

#include <algorithm>
#include <array>

#include "rdf/vocabulary.hpp"
#include "sparql/results/solution_writer.hpp"

namespace cluxel::sparql {

namespace {

struct FormatName {
  std::string_view name;
  ResultFormat format;
};

constexpr std::array<FormatName, 22> kFormatNames{{{"application/sparql-results+json", ResultFormat::Json},
                                                   {"json", ResultFormat::Json},
                                                   {"srj", ResultFormat::Json},
                                                   {"application/json", ResultFormat::Json},
                                                   {"application/sparql-results+xml", ResultFormat::Xml},
                                                   {"xml", ResultFormat::Xml},
                                                   {"srx", ResultFormat::Xml},
                                                   {"application/xml", ResultFormat::Xml},
                                                   {"text/csv", ResultFormat::Csv},
                                                   {"csv", ResultFormat::Csv},
                                                   {"text/tab-separated-values", ResultFormat::Tsv},
                                                   {"tsv", ResultFormat::Tsv},
                                                   {"text/plain", ResultFormat::Table},
                                                   {"table", ResultFormat::Table},
                                                   {"txt", ResultFormat::Table},
                                                   {"text/turtle", ResultFormat::Turtle},
                                                   {"turtle", ResultFormat::Turtle},
                                                   {"ttl", ResultFormat::Turtle},
                                                   {"application/n-triples", ResultFormat::NTriples},
                                                   {"ntriples", ResultFormat::NTriples},
                                                   {"n-triples", ResultFormat::NTriples},
                                                   {"nt", ResultFormat::NTriples}}};

}  // namespace

std::optional<ResultFormat> resultFormatOf(std::string_view name) {
  const auto found = std::find_if(kFormatNames.begin(), kFormatNames.end(),
                                  [name](const FormatName& known) { return known.name == name; });
  if (found == kFormatNames.end()) return std::nullopt;
  return found->format;
}

std::vector<std::pair<std::string, std::string>> vocabularyPrefixes() {
  using namespace rdf::vocabulary;
  const auto entry = [](std::string_view prefix, std::string_view iri) {
    return std::pair{std::string(prefix), std::string(iri)};
  };
  return {entry("clx", kClx),   entry("map", kMap),   entry("rdf", kRdf),  entry("rdfs", kRdfs),
          entry("owl", kOwl),   entry("xsd", kXsd),   entry("geo", kGeo),  entry("geof", kGeof),
          entry("sosa", kSosa), entry("prov", kProv), entry("skos", kSkos)};
}

std::unique_ptr<ResultSink> makeResultWriter(ResultFormat format, TextSink out, const WriterOptions& given) {
  WriterOptions options = given;
  if (options.prefixes.empty()) options.prefixes = vocabularyPrefixes();
  switch (format) {
    case ResultFormat::Json:
      return makeJsonWriter(std::move(out));
    case ResultFormat::Xml:
      return makeXmlWriter(std::move(out));
    case ResultFormat::Csv:
      return makeCsvWriter(std::move(out));
    case ResultFormat::Tsv:
      return makeTsvWriter(std::move(out));
    case ResultFormat::Table:
      return makeTableWriter(std::move(out), options);
    case ResultFormat::Turtle:
      return makeTurtleWriter(std::move(out), options);
    case ResultFormat::NTriples:
      break;
  }
  return makeNTriplesWriter(std::move(out));
}

}  // namespace cluxel::sparql
