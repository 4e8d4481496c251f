// SPDX-License-Identifier: Apache-2.0
// RDF formats by name, and reading a file as a source.
#include <algorithm>
#include <array>

#include "base/ascii.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

struct FormatName {
  std::string_view name;
  RdfFormat format;
};

constexpr std::array<FormatName, 20> kNames = {{
    {"turtle", RdfFormat::Turtle},      {"ttl", RdfFormat::Turtle},
    {"text/turtle", RdfFormat::Turtle}, {"n3", RdfFormat::Turtle},
    {"ntriples", RdfFormat::NTriples},  {"n-triples", RdfFormat::NTriples},
    {"nt", RdfFormat::NTriples},        {"application/n-triples", RdfFormat::NTriples},
    {"nquads", RdfFormat::NQuads},      {"n-quads", RdfFormat::NQuads},
    {"nq", RdfFormat::NQuads},          {"application/n-quads", RdfFormat::NQuads},
    {"trig", RdfFormat::TriG},          {"application/trig", RdfFormat::TriG},
    {"rdfxml", RdfFormat::RdfXml},      {"rdf/xml", RdfFormat::RdfXml},
    {"rdf", RdfFormat::RdfXml},         {"owl", RdfFormat::RdfXml},
    {"xml", RdfFormat::RdfXml},         {"application/rdf+xml", RdfFormat::RdfXml},
}};

/// A source without its text.
RdfSource namedSource(const std::filesystem::path& file, const Term& graph) {
  const std::optional<RdfFormat> format = rdfFormatOf(file);
  if (!format)
    throw InputError({.file = file.string()}, "is of no known RDF format",
                     "known endings: .ttl .nt .nq .trig .rdf .owl .xml");
  const std::string base = "file://" + percentEncoded(std::filesystem::absolute(file).lexically_normal().string(), "/");
  return {.text = {}, .name = file.string(), .format = *format, .base_iri = base, .graph = graph};
}

}  // namespace

std::optional<RdfFormat> rdfFormatNamed(std::string_view name) {
  const std::string lower = lowerCase(name);
  const auto found = std::find_if(kNames.begin(), kNames.end(), [&](const FormatName& f) { return f.name == lower; });
  return found == kNames.end() ? std::nullopt : std::optional(found->format);
}

std::optional<RdfFormat> rdfFormatOf(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension.empty() ? std::nullopt : rdfFormatNamed(std::string_view(extension).substr(1));
}

RdfSource readRdfSource(const std::filesystem::path& file, const Term& graph) {
  RdfSource source = namedSource(file, graph);
  source.text = readFile(file);
  return source;
}

RdfSource openRdfSource(const std::filesystem::path& file, const Term& graph) {
  RdfSource source = namedSource(file, graph);
  std::error_code ignored;
  if (source.format != RdfFormat::RdfXml && std::filesystem::is_regular_file(file, ignored))
    source.file = file;
  else
    source.text = readFile(file);
  return source;
}

const RdfPrefixes& commonPrefixes() {
  using namespace vocabulary;
  static const RdfPrefixes prefixes = {
      {"clx", std::string(kClx)},   {"rdf", std::string(kRdf)},   {"rdfs", std::string(kRdfs)},
      {"owl", std::string(kOwl)},   {"xsd", std::string(kXsd)},   {"geo", std::string(kGeo)},
      {"sosa", std::string(kSosa)}, {"prov", std::string(kProv)}, {"skos", std::string(kSkos)},
  };
  return prefixes;
}

}  // namespace cluxel::rdf
