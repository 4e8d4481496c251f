// SPDX-License-Identifier: Apache-2.0
// A generated campus as scan files, the shipped inputs, and maps built from them: for tests of mapping and of tasks.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "cluxel/knowledge/rdf_io.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/mapping/map_builder.hpp"
#include "cluxel/mapping/map_reader.hpp"
#include "cluxel/scan/scan_writer.hpp"
#include "cluxel/simulation/laser.hpp"
#include "knowledge/scratch_folder.hpp"

namespace cluxel {

inline ProgressSink& silence() {
  static ProgressSink sink;
  return sink;
}

inline ScanSet scansOf(const std::vector<std::filesystem::path>& files) {
  return ScanSet::open(files, {}, silence());
}

inline MapInputs shippedInputs() {
  return readMapInputs({}, DataHome({CLUXEL_SOURCE_DIR}));
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

/// Equal texts mean equal maps: sorted N-Quads without the history graph.
inline std::string canonicalText(const MapReader& map) {
  std::string text;
  writeSortedNQuads(
      map.quads(), [&](std::string_view piece) { text.append(piece); },
      [](const Quad& quad) { return quad.graph.text != vocabulary::kGraphHistory; });
  return text;
}

inline std::string canonicalText(const std::filesystem::path& file) {
  return canonicalText(MapReader(file));
}

/// Builds a map of `files`, in that order, into a fresh file and gives its canonical text.
inline std::string builtText(const std::vector<std::filesystem::path>& files, const MapInputs& inputs,
                             const BuildParams& params = {}) {
  const ScratchFolder folder;
  buildMap(scansOf(files), inputs, folder.path() / "map.clx", params, silence());
  return canonicalText(folder.path() / "map.clx");
}

}  // namespace cluxel
