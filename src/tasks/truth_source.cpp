// SPDX-License-Identifier: Apache-2.0
// Chooses between label maps and truth folders.
#include "tasks/truth_source.hpp"

#include "cluxel/error.hpp"

namespace cluxel::tasks {

namespace fs = std::filesystem;

TruthSource TruthSource::open(const fs::path& given, const DataHome& home) {
  TruthSource source;
  if (fs::is_directory(given)) {
    source.folder_ = given;
    source.ambiguous_ = scan::ambiguousInstances(given);
    return source;
  }
  fs::path name = given;
  if (name.extension() != ".yaml") name += ".yaml";
  source.labels_ = scan::LabelMap::load(home.locate("labels", name));
  return source;
}

std::optional<fs::path> TruthSource::fileOf(const scan::Scan& scan) const {
  return labels_ ? std::nullopt : scan::truthFileOf(folder_, scan.source);
}

std::vector<std::string> TruthSource::classNames() const {
  return labels_ ? truthClassNames(*labels_) : scan::truthClassNames();
}

scan::PointTruth TruthSource::truthOf(const scan::Scan& scan) const {
  if (!labels_) {
    const auto file = fileOf(scan);
    if (!file)
      throw InputError({.file = scan.source}, "has no truth file in " + folder_.string(),
                       "truth files are named like their scan, with .truth or .truth.gz at the end");
    return scan::truthFromFile(*file, scan.points.size());
  }
  if (scan.points.label.empty())
    throw InputError({.file = scan.source}, "has no labels, so a label map gives no truth",
                     "name a folder of truth files", Remedy::NameTruth);
  return truthFromLabels(scan, *labels_);
}

}  // namespace cluxel::tasks
