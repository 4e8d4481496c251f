// SPDX-License-Identifier: Apache-2.0
// Manifests as text: numbers with the shortest digits that give back the same double, names in double quotes.
#include "scan/formats/manifest_writer.hpp"

#include <charconv>

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

std::string numberText(double number) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, number).ptr};
}

/// A YAML scalar in double quotes; bytes below 32 and the quote's own signs escaped.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) {
      result += c;
      continue;
    }
    constexpr const char* kHex = "0123456789abcdef";
    result += std::string("\\x") + kHex[static_cast<unsigned char>(c) >> 4] + kHex[c & 15];
  }
  return result + '"';
}

/// `path` as seen from the folder of the manifest, so that a tree of files can be moved as a whole.
std::string pathText(const fs::path& path, const fs::path& manifest) {
  const fs::path folder = fs::weakly_canonical(fs::absolute(manifest)).parent_path();
  return quoted(fs::weakly_canonical(fs::absolute(path)).lexically_relative(folder).generic_string());
}

std::string poseText(const Eigen::Isometry3d& T) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row) {
    text += row == 0 ? "[" : ", [";
    for (int column = 0; column < 4; ++column) text += (column == 0 ? "" : ", ") + numberText(T.matrix()(row, column));
    text += ']';
  }
  return text + ']';
}

std::string entryText(const ScanFile& file, const Eigen::Isometry3d& T_map_sensor, const fs::path& manifest) {
  std::string text = "  - path: " + pathText(file.path, manifest) + "\n    format: " + nameOf(file.format) + '\n';
  if (file.time_s) text += "    time_s: " + numberText(*file.time_s) + '\n';
  if (file.labels) text += "    labels: " + pathText(*file.labels, manifest) + '\n';
  return text + "    pose: " + poseText(T_map_sensor) + '\n';
}

}  // namespace

std::string manifestText(const ScanSet& set, const std::vector<PosedScan>& scans, const fs::path& file,
                         const std::string& comment) {
  std::string text = "# " + comment + '\n';
  const Eigen::Vector3d& origin = set.mapOrigin();
  if (!origin.isZero(0))
    text += "map_origin: [" + numberText(origin.x()) + ", " + numberText(origin.y()) + ", " + numberText(origin.z()) +
            "]\n";
  if (!set.crs().empty()) text += "crs: " + quoted(set.crs()) + '\n';
  text += "scans:\n";
  for (const PosedScan& scan : scans) text += entryText(set.file(scan.index), scan.T_map_sensor, file);
  return text;
}

}  // namespace cluxel::scan
