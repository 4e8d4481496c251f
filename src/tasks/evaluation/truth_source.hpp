// SPDX-License-Identifier: Apache-2.0
// Where truth comes from: the scans' own labels through a label map, or a folder of truth files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/installation/data_home.hpp"
#include "rules/language/class_catalogue.hpp"
#include "scan/scan.hpp"
#include "scan/truth/truth.hpp"
#include "tasks/evaluation/truth_class.hpp"

namespace cluxel::tasks {

/// The path of a label map or of a folder of truth files. `given` is the name of a label map in labels/ ("oakland.yaml"
/// or "oakland"), which a folder of this name in the working directory does not hide, or else a path.
std::filesystem::path locateTruth(const std::filesystem::path& given, const DataHome& home);

class TruthSource {
 public:
  /// What locateTruth() finds. Throws InputError when it is neither a folder nor a label map.
  static TruthSource open(const std::filesystem::path& given, const DataHome& home);

  /// Truth of every point of the scan; the truth file is found by the scan's source. Throws InputError when there is no
  /// truth file for it, or when it has no labels. A label map that names a field of instances needs the scan's file.
  scan::PointTruth truthOf(const scan::Scan& scan) const;
  /// The file that truthOf() reads for the scan; absent with a label map, and where there is none.
  std::optional<std::filesystem::path> fileOf(const scan::Scan& scan) const;
  /// The classes that truthOf() numbers, the same for every scan.
  std::vector<std::string> classNames() const { return classes().names; }
  /// These, and what answers of other classes count as.
  TruthClasses classes() const;
  /// False where only some objects of a scan are labelled: nothing is known of the other points.
  bool coversAll() const { return labels_.coversAll(); }
  /// Whether the numbers of truthOf()'s instances begin anew in each scan.
  bool countsInstancesByScan() const { return folder_.empty(); }
  /// What the data set itself calls a label ("trunk"); empty with truth files, and for a label without meaning.
  std::string nameOfLabel(std::uint32_t label) const;
  /// What a label map says of classes that can match no answer, because `catalogue` does not know them or knows them as
  /// something else: one sentence each. A truth may have classes of its own.
  std::vector<std::string> doubtfulClasses(const rules::ClassCatalogue& catalogue) const;
  /// Instances that count neither way, sorted.
  const std::vector<std::int32_t>& ambiguous() const { return ambiguous_; }

 private:
  std::filesystem::path folder_;  ///< empty with a label map
  std::filesystem::path file_;    ///< of the label map
  scan::LabelMap labels_;         ///< of a folder: that of the numbers in truth files
  std::vector<std::int32_t> ambiguous_;
};

}  // namespace cluxel::tasks
