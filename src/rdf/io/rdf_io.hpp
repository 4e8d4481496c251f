// SPDX-License-Identifier: Apache-2.0
// Reads and writes RDF: Turtle, N-Triples, N-Quads, TriG and RDF/XML.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/sorting/sorted_records.hpp"
#include "cluxel/error.hpp"
#include "cluxel/term.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

enum class RdfFormat { Turtle, NTriples, NQuads, TriG, RdfXml };

/// The format of a file name's extension: .ttl .nt .nq .trig .rdf .owl .xml.
std::optional<RdfFormat> rdfFormatOf(const std::filesystem::path& file);
/// The format of a name or media type: "turtle", "ttl", "ntriples", "nt", "nquads", "nq", "trig", "rdfxml",
/// "text/turtle" …
std::optional<RdfFormat> rdfFormatNamed(std::string_view name);

/// An RDF text and the context needed to parse it.
struct RdfSource {
  std::string text;
  std::string name;  ///< the file name in messages
  RdfFormat format = RdfFormat::Turtle;
  std::string base_iri;             ///< for relative IRIs; if empty, a relative IRI is an error
  Term graph = Term::iri("");       ///< the graph of statements without one
  std::filesystem::path file = {};  ///< read in pieces instead of `text`, which is then empty
};

/// Reads a file as a source whose base IRI is its file: IRI. InputError when the extension is unknown.
RdfSource readRdfSource(const std::filesystem::path& file, const Term& graph = Term::iri(""));
/// As above, but a regular file is not read now: it is parsed in pieces, so that memory does not grow with it. XML is
/// read into memory all the same.
RdfSource openRdfSource(const std::filesystem::path& file, const Term& graph = Term::iri(""));

/// Calls `take` for every quad, in document order. Blank node labels are derived from a hash of text, base and graph:
/// equal sources give equal labels, different sources disjoint ones. Throws one InputError with all faults as
/// file:line:col; `take` may have been called before. Cost: about a million statements per second for N-Quads.
void parseRdf(const RdfSource& source, const std::function<void(const Quad&)>& take);

/// Where the first quad that `is_meant` accepts stands: its line, in Turtle and TriG the one where its list of objects
/// ends. Line 0 in such a text of more than 4 MiB; empty when there is no such quad. Labels of blank nodes may differ
/// from those of parseRdf(). Throws as parseRdf(). Cost: up to some twenty times that of parsing.
SourceLocation placeOf(const RdfSource& source, const std::function<bool(const Quad&)>& is_meant);

/// The prefixes that a source declares, in document order, without the colon; a later one of the same name goes before.
/// Throws as parseRdf().
std::vector<std::pair<std::string, std::string>> prefixesIn(const RdfSource& source);

/// Parses into a store and returns the number of statements. After an error the transaction must be dropped.
std::uint64_t loadRdf(const RdfSource& source, QuadWriter& writer);
inline std::uint64_t loadRdf(const std::filesystem::path& file, const Term& graph, QuadWriter& writer) {
  return loadRdf(readRdfSource(file, graph), writer);
}

using TextSink = std::function<void(std::string_view)>;
/// Pairs of a prefix without the colon and its namespace IRI.
using RdfPrefixes = std::map<std::string, std::string, std::less<>>;
/// clx, rdf, rdfs, owl, xsd, geo, sosa, prov, skos.
const RdfPrefixes& commonPrefixes();

/// Says which graphs are written; absent: all.
using GraphFilter = std::function<bool(const Term& graph)>;
/// Canonical N-Quads without duplicates, sorted bytewise. What takes more than `sort_bytes` to sort goes to a temporary
/// file (SortedRecords, which tells the errors), so that memory does not grow with the store.
void writeSortedNQuads(const QuadReader& reader, const TextSink& out, const GraphFilter& keep = {},
                       std::size_t sort_bytes = SortedRecords::kUsualBytes);
/// The same with the canonical labels of blank nodes (canonicalLabels()): what is written follows from the dataset
/// alone. False when the blank nodes were too much alike for that, and kept the labels that the store has. Quads with
/// blank nodes are held in memory.
bool writeCanonicalNQuads(const QuadReader& reader, const TextSink& out, const GraphFilter& keep = {},
                          std::size_t sort_bytes = SortedRecords::kUsualBytes);
/// N-Quads of all graphs, or the triples of one as N-Triples, in the order of the store. Memory does not grow with it.
void writeStoredNQuads(const QuadReader& reader, const std::optional<Term>& graph, const TextSink& out);
/// Turtle of one graph, or of the union of all graphs but history when `graph` is absent. Subjects are sorted by term,
/// rdf:type comes first, duplicates are removed, and lexical forms are preserved. Sorted as writeSortedNQuads() does.
void writeTurtle(const QuadReader& reader, const std::optional<Term>& graph, const TextSink& out,
                 const RdfPrefixes& prefixes = commonPrefixes(), std::size_t sort_bytes = SortedRecords::kUsualBytes);

}  // namespace cluxel::rdf
