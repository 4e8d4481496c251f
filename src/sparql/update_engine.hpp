// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Update within one write transaction; a request is atomic.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rdf/file/environment.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::sparql {

struct UpdateOptions {
  QueryOptions query = {};
  /// IRIs of the writable graphs; "" is the unnamed graph. The first is the target of DELETE and INSERT without a
  /// graph.
  std::vector<std::string> writable_graphs = {std::string(rdf::vocabulary::kGraphOperator)};
  bool any_graph_writable = false;  ///< then the unnamed graph is the default target
  /// Returns the triples for the IRI of a LOAD (graph terms are ignored); if absent, LOAD is refused.
  std::function<std::vector<Quad>(const std::string& iri)> load = {};
  /// Is told of each quad that an operation removes from a graph, also of those that are not there.
  std::function<void(const Quad&)> on_removal = {};
  /// How to delete a triple of a graph that may not be written; empty where only the general advice holds.
  std::function<std::string(const Quad& triple)> remedy_for = {};
};

struct UpdateReport {
  /// Inserted and deleted quads, summed over the operations; one that an operation deletes and inserts counts for
  /// neither.
  std::uint64_t inserted = 0, deleted = 0;
  std::vector<Diagnostic> warnings = {};  ///< unknown functions, and constant patterns that are no regular expressions
};

/// Runs a request. The caller commits the transaction, and must not commit it after an error. A deletion that names no
/// graph and meets triples of graphs that may not be written is refused: the union would hold them afterwards, too.
UpdateReport runUpdate(rdf::WriteTransaction& transaction, std::string_view text, const UpdateOptions& options = {});

}  // namespace cluxel::sparql
