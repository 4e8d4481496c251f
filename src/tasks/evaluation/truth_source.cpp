// SPDX-License-Identifier: Apache-2.0
// Chooses between label maps and truth folders.
#include "tasks/evaluation/truth_source.hpp"

#include "cluxel/error.hpp"
#include "scan/input_paths.hpp"
#include "tasks/evaluation/label_map_check.hpp"

namespace cluxel::tasks {

namespace fs = std::filesystem;

fs::path locateTruth(const fs::path& given, const DataHome& home) {
  fs::path name = given;
  if (name.extension() != ".yaml") name += ".yaml";
  const bool is_name = !given.has_parent_path() && fs::exists(home.root() / "labels" / name);
  return !is_name && fs::is_directory(given) ? given : home.locate("labels", name);
}

TruthSource TruthSource::open(const fs::path& given, const DataHome& home) {
  TruthSource source;
  const fs::path path = locateTruth(given, home);
  if (!fs::is_directory(path)) {
    source.labels_ = scan::LabelMap::load(path);
    source.file_ = path;
    return source;
  }
  scan::requireInput(path);
  source.folder_ = path;
  source.labels_ = scan::LabelMap::load(home.locate("labels", "truth_files.yaml"));
  source.ambiguous_ = scan::ambiguousInstances(path);
  return source;
}

std::optional<fs::path> TruthSource::fileOf(const scan::Scan& scan) const {
  return folder_.empty() ? std::nullopt : scan::truthFileOf(folder_, scan.source);
}

TruthClasses TruthSource::classes() const {
  TruthClasses classes{truthClassNames(labels_), labels_.countsAs()};
  if (!folder_.empty()) classes.meant.insert(classes.names.begin(), classes.names.end());
  for (const auto& [id, meaning] : labels_.entries()) {
    if (meaning.object_class) classes.meant.insert(*meaning.object_class);
    if (meaning.near) classes.meant.insert(meaning.near->object_class);
  }
  return classes;
}

std::vector<std::string> TruthSource::doubtfulClasses(const rules::ClassCatalogue& catalogue) const {
  if (file_.empty()) return {};
  return LabelMapCheck(labels_, catalogue, file_.string()).run();
}

std::string TruthSource::nameOfLabel(std::uint32_t label) const {
  const scan::LabelMeaning* meaning = folder_.empty() ? labels_.find(label) : nullptr;
  return meaning ? meaning->name : std::string();
}

scan::PointTruth TruthSource::truthOf(const scan::Scan& scan) const {
  if (!folder_.empty()) {
    const auto file = fileOf(scan);
    if (!file)
      throw InputError({.file = scan.source}, "has no truth file in " + folder_.string(),
                       "truth files are named like their scan, with .truth or .truth.gz at the end");
    return scan::truthFromFile(*file, scan.points.size());
  }
  if (scan.points.label.empty())
    throw InputError({.file = scan.source}, "has no labels, so a label map gives no truth",
                     "name a folder of truth files", Remedy::NameTruth);
  scan::PointTruth truth = truthFromLabels(scan, labels_);
  if (!labels_.instanceField().empty()) truth.instance = scan::instancesFromFile(scan, labels_.instanceField());
  return truth;
}

}  // namespace cluxel::tasks
