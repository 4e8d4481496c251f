// SPDX-License-Identifier: Apache-2.0
// What is known to be true of a scan's points: primitive, object class and instance, from labels or truth files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
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

/// What a label map says.
struct LabelMapContent {
  std::map<std::uint32_t, LabelMeaning> labels;
  /// Answers of a class, and of its subclasses, count as another class, which the truth names: {"Building", "Static"}.
  std::map<std::string, std::string> counts_as;
  std::string instance_field;  ///< the field of the scan files that numbers the objects of a scan; empty: none
  bool covers_all = true;      ///< false: only some objects are labelled, so nothing is known of the other points
};

/// A label map (labels/*.yaml): a data set's ids to Cluxel's names.
class LabelMap {
 public:
  LabelMap() = default;
  explicit LabelMap(LabelMapContent content) : content_(std::move(content)) {}
  /// Throws InputError with every fault of the file, each with file:line:col.
  static LabelMap load(const std::filesystem::path& path);
  /// The meaning of `id`; an id that the map does not name is left out.
  const LabelMeaning* find(std::uint32_t id) const;
  const std::map<std::uint32_t, LabelMeaning>& entries() const { return content_.labels; }
  const std::map<std::string, std::string>& countsAs() const { return content_.counts_as; }
  const std::string& instanceField() const { return content_.instance_field; }
  bool coversAll() const { return content_.covers_all; }

 private:
  LabelMapContent content_;
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

/// The classes above, then the other classes of the label map in the order of its ids. Throws Error for more than 127.
std::vector<std::string> truthClassNames(const LabelMap& map);

/// Truth from the scan's own labels through a label map, without instances.
PointTruth truthFromLabels(const Scan& scan, const LabelMap& map);

/// The numbers of objects that the field `field` of the scan's PLY file gives its points, in the scan's point order;
/// -1: none. A map does not keep them. Throws InputError when the file is not there, is no PLY file, or holds another
/// scan now. Cost: the file is read, and its points are hashed.
std::vector<std::int32_t> instancesFromFile(const Scan& scan, const std::string& field);

/// Truth from a folder of files with one line `primitive object instance` per point, plain or gzip; the file of a scan
/// has the scan file's stem followed by ".truth", ".truth.gz". Throws InputError naming file and line.
PointTruth truthFromFile(const std::filesystem::path& file, std::size_t point_count);

/// The truth file of a scan file in a truth folder: below a folder of the name of the scan's own folder (for scans of
/// one name in several folders), else in the folder itself; absent when there is none.
/// Throws InputError where it lies there both packed and unpacked.
std::optional<std::filesystem::path> truthFileOf(const std::filesystem::path& folder,
                                                 const std::filesystem::path& scan);

/// Ids of instances that count neither way (instances.csv, column `ambiguous`), sorted; empty without such a file.
std::vector<std::int32_t> ambiguousInstances(const std::filesystem::path& folder);

}  // namespace cluxel::scan
