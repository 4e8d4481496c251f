// SPDX-License-Identifier: Apache-2.0
// The tests of the W3C suites, read from their manifests.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cluxel::test {

enum class W3cKind {
  QueryEvaluation,
  CsvResults,
  UpdateEvaluation,
  PositiveQuery,
  NegativeQuery,
  PositiveUpdate,
  NegativeUpdate
};

struct W3cGraph {
  std::string iri;  ///< of the named graph; empty: the default graph
  std::filesystem::path file;
};

struct W3cCase {
  W3cKind kind = W3cKind::PositiveQuery;
  std::string id;                 ///< "sparql11/aggregates#agg01"
  std::string group;              ///< "sparql11/aggregates"
  std::filesystem::path request;  ///< the query or update
  std::vector<W3cGraph> data;
  std::optional<std::filesystem::path> result;  ///< of a query
  std::vector<W3cGraph> graphs_after;           ///< of an update
  bool lax_cardinality = false;
};

/// Machine-independent IRIs of the files of the suites.
class W3cFolder {
 public:
  explicit W3cFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::string iriOf(const std::filesystem::path& file) const;
  std::filesystem::path fileOf(const std::string& iri) const;
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// All tests of a manifest and of the manifests it includes, in order.
std::vector<W3cCase> readManifest(const W3cFolder& folder, const std::string& manifest);

}  // namespace cluxel::test
