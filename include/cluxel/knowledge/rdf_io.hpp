// SPDX-License-Identifier: Apache-2.0
// RDF texts in and out: Turtle, N-Triples, N-Quads, TriG and RDF/XML.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/term.hpp"

namespace cluxel {

enum class RdfFormat { Turtle, NTriples, NQuads, TriG, RdfXml };

/// By the name's ending: .ttl .nt .nq .trig .rdf .owl .xml.
std::optional<RdfFormat> rdfFormatOf(const std::filesystem::path& file);
/// By name or media type: "turtle", "ttl", "ntriples", "nt", "nquads", "nq", "trig", "rdfxml", "text/turtle" …
std::optional<RdfFormat> rdfFormatNamed(std::string_view name);

/// An RDF text and what is needed to read it.
struct RdfSource {
  std::string text;
  std::string name;  ///< the file's name, for messages
  RdfFormat format = RdfFormat::Turtle;
  std::string base_iri;        ///< relative IRIs are resolved against it; empty: they are errors
  Term graph = Term::iri("");  ///< where statements go that name no graph
};

/// Reads a file as a source; its base IRI is its file: IRI. InputError when the format cannot be told from the name.
RdfSource readRdfSource(const std::filesystem::path& file, const Term& graph = Term::iri(""));

/// Hands every quad to `take`, in the order of the text. Blank nodes get labels of their own for each text, base and
/// graph: the same source gives the same labels, another one never. All faults as one InputError, file:line:col; some
/// quads may have been handed on before. Cost: some million statements a second for N-Quads.
void parseRdf(const RdfSource& source, const std::function<void(const Quad&)>& take);

/// The same, into a store; gives the number of statements read. After an error drop the transaction.
std::uint64_t loadRdf(const RdfSource& source, QuadWriter& writer);
inline std::uint64_t loadRdf(const std::filesystem::path& file, const Term& graph, QuadWriter& writer) {
  return loadRdf(readRdfSource(file, graph), writer);
}

using TextSink = std::function<void(std::string_view)>;
/// Prefix names without the colon, and their IRIs.
using RdfPrefixes = std::map<std::string, std::string, std::less<>>;
/// clx, rdf, rdfs, owl, xsd, geo, sosa, prov, skos.
const RdfPrefixes& commonPrefixes();

/// Canonical N-Quads, each line once, sorted by bytes. All graphs, or the given one; a line per quad that `keep`
/// accepts.
void writeSortedNQuads(const QuadReader& reader, const TextSink& out,
                       const std::function<bool(const Quad&)>& keep = {});
/// Turtle of one graph, or of the union of all but history when `graph` is absent: subjects sorted by term, rdf:type
/// first, each triple once; with exactly the terms of the store.
void writeTurtle(const QuadReader& reader, const std::optional<Term>& graph, const TextSink& out,
                 const RdfPrefixes& prefixes = commonPrefixes());

}  // namespace cluxel
