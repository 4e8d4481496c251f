// SPDX-License-Identifier: Apache-2.0
// Scan files to places with copies.
#include "cluxel/perception/training_files.hpp"

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/scan/scan_set.hpp"

namespace cluxel {

namespace {

PointTruth truthOf(const Scan& scan, const std::filesystem::path& file, const TrainingSource& source) {
  if (!std::filesystem::is_directory(source.truth)) return truthFromLabels(scan, LabelMap::load(source.truth));
  const auto truth_file = truthFileOf(source.truth, file);
  if (!truth_file)
    throw InputError(SourceLocation{.file = file.string()}, "no truth for this scan in " + source.truth.string(),
                     "put a file named like the scan, with the ending .truth or .truth.gz, there");
  return truthFromFile(*truth_file, scan.points.size());
}

/// The scans of one source, split into places that are perceived apart.
std::vector<LabelledScans> placesOf(const TrainingSource& source, ProgressSink& sink) {
  const ScanSet set = ScanSet::open(source.inputs, {}, sink);
  std::vector<LabelledScans> places;
  std::filesystem::path folder_before;  // of a scan with a pose
  for (std::size_t i = 0; i < set.size(); ++i) {
    Scan scan = set.load(i);
    const std::filesystem::path folder = std::filesystem::absolute(set.file(i).path).parent_path();
    if (places.empty() || !scan.has_pose || folder != folder_before) places.emplace_back();
    folder_before = scan.has_pose ? folder : std::filesystem::path{};
    places.back().truth.push_back(truthOf(scan, set.file(i).path, source));
    places.back().scans.push_back(std::move(scan));
  }
  return places;
}

/// A place and its copies.
class PlaceMaker {
 public:
  PlaceMaker(const PerceptionParams& perception, const CopyParams& copies, unsigned threads)
      : x_perception(perception), x_copies(copies), x_threads(threads) {}

  void add(const LabelledScans& scans, int group, bool only_for_training, std::vector<TrainingPlace>& places) const {
    const std::string name = scans.scans.front().source;
    places.push_back(make(scans, name, group, only_for_training));
    for (std::size_t i = 0; i < x_copies.sensors.size(); ++i)
      addCopy(seenBy(scans.scans, scans.truth, x_copies.sensors[i]), name + ", seen again", group, places);
    for (const VirtualDrive& drive : x_copies.drives)
      addCopy(seenAlong(scans.scans, scans.truth, drive), name + ", driven past", group, places);
    if (x_copies.thin_share > 0)
      addCopy(thinned(scans.scans, scans.truth, x_copies.thin_share, kThinSeed), name + ", thinned", group, places);
  }

 private:
  static constexpr std::uint64_t kThinSeed = 17;

  TrainingPlace make(const LabelledScans& scans, const std::string& name, int group, bool only_for_training) const {
    TrainingPlace place = makePlace(scans.scans, scans.truth, x_perception, x_threads);
    place.name = name;
    place.group = group;
    place.only_for_training = only_for_training;
    return place;
  }

  void addCopy(const LabelledScans& copy, const std::string& name, int group,
               std::vector<TrainingPlace>& places) const {
    if (!copy.scans.empty()) places.push_back(make(copy, name, group, true));
  }

  const PerceptionParams& x_perception;
  const CopyParams& x_copies;
  unsigned x_threads;
};

}  // namespace

PerceptionParams portablePerception() {
  PerceptionParams params;
  params.features.density = false;
  params.features.extent = false;
  return params;
}

std::vector<TrainingPlace> readPlaces(const std::vector<TrainingSource>& sources, const PerceptionParams& perception,
                                      const CopyParams& copies, int group_size, unsigned threads, ProgressSink& sink) {
  const PlaceMaker maker(perception, copies, threads);
  std::vector<TrainingPlace> places;
  int group = 0;
  for (const TrainingSource& source : sources) {
    int in_group = 0;
    const std::vector<LabelledScans> of_source = placesOf(source, sink);
    for (std::size_t i = 0; i < of_source.size(); ++i) {
      sink.progress("perceiving training places", i, of_source.size());
      maker.add(of_source[i], group, source.only_for_training, places);
      if (++in_group % group_size == 0) ++group;
    }
    if (in_group % group_size != 0) ++group;
  }
  return places;
}

}  // namespace cluxel
