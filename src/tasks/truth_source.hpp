// SPDX-License-Identifier: Apache-2.0
// Where truth comes from: the scans' own labels through a label map, or a folder of truth files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/data_home.hpp"
#include "scan/scan.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::tasks {

class TruthSource {
 public:
  /// `given` is a folder of truth files, or a label map by path or by name in labels/ ("oakland.yaml" or "oakland").
  /// Throws InputError when it is neither.
  static TruthSource open(const std::filesystem::path& given, const DataHome& home);

  /// Truth of every point of the scan; the truth file is found by the scan's source. Throws InputError when there is no
  /// truth file for it, or when it has no labels.
  scan::PointTruth truthOf(const scan::Scan& scan) const;
  /// The file that truthOf() reads for the scan; absent with a label map, and where there is none.
  std::optional<std::filesystem::path> fileOf(const scan::Scan& scan) const;
  /// The classes that truthOf() numbers, the same for every scan.
  std::vector<std::string> classNames() const;
  /// Instances that count neither way, sorted.
  const std::vector<std::int32_t>& ambiguous() const { return ambiguous_; }

 private:
  std::filesystem::path folder_;
  std::optional<scan::LabelMap> labels_;
  std::vector<std::int32_t> ambiguous_;
};

}  // namespace cluxel::tasks
