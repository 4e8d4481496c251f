// SPDX-License-Identifier: Apache-2.0
// SPARQL 1.1 Update within one write transaction: all of a request or nothing.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/sparql/query_engine.hpp"

namespace cluxel {

struct UpdateOptions {
  QueryOptions query = {};
  /// Graphs that may be written (full IRIs; "" is the unnamed graph). Where DELETE/INSERT names no graph, the first of
  /// them is written.
  std::vector<std::string> writable_graphs = {std::string(vocabulary::kGraphOperator)};
  bool any_graph_writable = false;  ///< then text without a graph writes the unnamed graph
  /// Gives the triples behind a LOAD's IRI (their graph terms are ignored); absent: LOAD is refused.
  std::function<std::vector<Quad>(const std::string& iri)> load = {};
};

struct UpdateReport {
  std::uint64_t inserted = 0, deleted = 0;  ///< quads asked to be added and removed
};

/// Runs a request. The caller commits the transaction; on an error nothing of it may be committed.
UpdateReport runUpdate(WriteTransaction& transaction, std::string_view text, const UpdateOptions& options = {});

}  // namespace cluxel
