// SPDX-License-Identifier: Apache-2.0
// Oxigraph as the second engine: one node process answers a batch of queries.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sparql/results/result_table.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;

struct EngineRequest {
  std::string query;
};

struct EngineAnswer {
  std::optional<QueryResult> result;  ///< absent: refused
  std::string error;
};

/// The folder with node_modules/oxigraph (CLUXEL_OXIGRAPH, or build/npm); nothing when it or node is absent.
std::optional<std::filesystem::path> secondEngineFolder();

/// Throws std::runtime_error when node fails as a whole.
std::vector<EngineAnswer> askSecondEngine(const std::filesystem::path& folder, const std::vector<Quad>& data,
                                          const std::vector<EngineRequest>& requests);

}  // namespace cluxel::test
