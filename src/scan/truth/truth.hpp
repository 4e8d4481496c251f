// SPDX-License-Identifier: Apache-2.0
// What is known to be true of a scan's points: primitive, object class and instance, from labels or truth files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scan/scan.hpp"
#include "scan/truth/primitive_label.hpp"

namespace cluxel::scan {

/// What one label id of a data set means. Absent: left out of training and scoring.
struct LabelMeaning {
  std::string name;  ///< the data set's own name of the id
  std::optional<PrimitiveLabel> primitive;
  std::optional<std::string> object_class;  ///< local name in the ontology: "Tree"
  std::optional<std::string> part;          ///< local name of the part: "TreeTrunk"
  /// When another id's point is nearer than this, horizontally, the object is of this class instead (posts of signs).
  struct NearRule {
    std::uint32_t other_id = 0;
    double within_m = 0;
    std::string object_class;
  };
  std::optional<NearRule> near;
};

/// A label map (labels/*.yaml): a data set's ids to Cluxel's names.
class LabelMap {
 public:
  /// Throws InputError with every fault of the file, each with file:line:col.
  static LabelMap load(const std::filesystem::path& path);
  /// The meaning of `id`; an id that the map does not name is left out.
  const LabelMeaning* find(std::uint32_t id) const;
  const std::map<std::uint32_t, LabelMeaning>& entries() const { return entries_; }

 private:
  std::map<std::uint32_t, LabelMeaning> entries_;
};

/// Truth per point of one scan, in the scan's point order; -1 means unknown.
struct PointTruth {
  std::vector<std::int8_t> primitive;     ///< PrimitiveLabel
  std::vector<std::int8_t> object_class;  ///< index into `class_names`
  std::vector<std::int32_t> instance;     ///< unique over the data set; 0 and more
  std::vector<std::string> class_names;   ///< local names in the ontology, in the order of truth files
};

/// The object classes in the order of the numbers in truth files: Ground, Building, Tree, Bush, StreetLamp, StreetSign,
/// UtilityPole, Vehicle, SmallObject.
const std::vector<std::string>& truthClassNames();

/// These, then what else the label map names, in the order of its ids. Throws Error for more than 127 of them.
std::vector<std::string> truthClassNames(const LabelMap& map);

/// Truth from the scan's own labels through a label map (no instances).
PointTruth truthFromLabels(const Scan& scan, const LabelMap& map);

/// Truth from a folder of files with one line `primitive object instance` per point, plain or gzip; the file of a scan
/// has the scan file's stem followed by ".truth", ".truth.gz". Throws InputError naming file and line.
PointTruth truthFromFile(const std::filesystem::path& file, std::size_t point_count);

/// The truth file of a scan file in a truth folder: below a folder of the name of the scan's own folder (for scans of
/// one name in several folders), else in the folder itself; absent when there is none.
std::optional<std::filesystem::path> truthFileOf(const std::filesystem::path& folder,
                                                 const std::filesystem::path& scan);

/// Ids of instances that count neither way (instances.csv, column `ambiguous`), sorted; empty without such a file.
std::vector<std::int32_t> ambiguousInstances(const std::filesystem::path& folder);

}  // namespace cluxel::scan
