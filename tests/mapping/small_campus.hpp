// SPDX-License-Identifier: Apache-2.0
// Fixtures for tests of mapping and tasks: scan files of a generated campus, the shipped inputs, and maps built from
// them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "mapping/build/map_builder.hpp"
#include "mapping/map_reader.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/vocabulary.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/laser.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace rules;

inline ProgressSink& silence() {
  static ProgressSink sink;
  return sink;
}

inline ScanSet scansOf(const std::vector<std::filesystem::path>& files) {
  return ScanSet::open(files, {}, silence());
}

inline MapInputs shippedInputs() {
  return readMapInputs({}, DataHome(test::sourceFolder()));
}

/// Scan files of a small generated campus, posed by their VIEWPOINT.
class SmallCampus {
 public:
  explicit SmallCampus(CampusParams params) : campus_(buildCampus(params)) {
    const Laser laser(campus_);
    for (std::size_t stop = 0; stop < campus_.stops.size(); ++stop) {
      files_.push_back(folder_.path() / ("stop" + std::to_string(stop) + ".pcd"));
      scans_.push_back(laser.scanAt(stop));
      writeScanFile(scans_.back().scan, files_.back());
    }
  }
  const std::vector<std::filesystem::path>& files() const { return files_; }
  const std::vector<SimulatedScan>& scans() const { return scans_; }

 private:
  ScratchFolder folder_;
  Campus campus_;
  std::vector<std::filesystem::path> files_;
  std::vector<SimulatedScan> scans_;
};

/// Sorted N-Quads without the history graph: equal texts mean equal maps.
inline std::string canonicalText(const MapReader& map) {
  std::string text;
  writeCanonicalNQuads(
      map.quads(), [&](std::string_view piece) { text.append(piece); },
      [](const Term& graph) { return graph.text != vocabulary::kGraphHistory; });
  return text;
}

inline std::string canonicalText(const std::filesystem::path& file) {
  return canonicalText(MapReader(file));
}

/// Builds a map of `files`, in that order, and returns its canonical text.
inline std::string builtText(const std::vector<std::filesystem::path>& files, const MapInputs& inputs,
                             const BuildParams& params = {}) {
  const ScratchFolder folder;
  buildMap(scansOf(files), inputs, folder.path() / "map.clx", params, silence());
  return canonicalText(folder.path() / "map.clx");
}

}  // namespace cluxel::mapping
