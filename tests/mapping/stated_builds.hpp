// SPDX-License-Identifier: Apache-2.0
// Builds with the statements of another map, and what is noted of statements.
#pragma once

#include <filesystem>
#include <string>

#include "mapping/build/operator_statements.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

/// Canonical text of the map of some scans, built from scratch with the statements that `map` has.
inline std::string builtWithStatementsOf(const std::filesystem::path& map, const ScanSet& scans,
                                         const MapInputs& inputs) {
  BuildParams params;
  params.statements = operatorStatements(MapReader(map).quads());
  const ScratchFolder other;
  buildMap(scans, inputs, other.path() / "map.clx", params, silence());
  return canonicalText(other.path() / "map.clx");
}

class StatementNotes : public ProgressSink {
 public:
  void note(std::string_view text) override { all.append(text).append("\n"); }
  std::string all;
};

}  // namespace cluxel::mapping
