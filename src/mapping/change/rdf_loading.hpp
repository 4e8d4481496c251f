// SPDX-License-Identifier: Apache-2.0
// Loads RDF files into a store or among the operator's statements of a map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/change/map_editor.hpp"

namespace cluxel::mapping {

struct RdfLoadParams {
  std::string graph = {};     ///< graph for statements that name no graph; default in a map: `operator`
  std::string base_iri = {};  ///< for relative IRIs; else the IRI of each file
  bool dry_run = false;       ///< compute what would change, and write nothing
};

struct RdfLoadReport {
  std::uint64_t statements = 0, added = 0;  ///< read, and new in the store
  bool is_map = false;                      ///< else a store that no build has made
  ChangeReport change;                      ///< of a map: what became of its objects
};

/// Adds the statements of RDF files in one commit; named graphs keep their names. A store that does not exist is made,
/// and removed again after an error. In a map only graph `operator` may be written, and what follows from it is
/// inferred. Throws InputError with all faults of a file, Error (InvalidArgument) for another graph of a map. Memory:
/// some 200 MB, and for RDF/XML that of the file.
RdfLoadReport loadRdfFiles(const std::filesystem::path& store, const std::vector<std::filesystem::path>& files,
                           const RdfLoadParams& params, ProgressSink& sink);

}  // namespace cluxel::mapping
