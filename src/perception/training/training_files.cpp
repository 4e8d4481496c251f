// SPDX-License-Identifier: Apache-2.0
// Reads scan files into places and their copies.
#include "perception/training/training_files.hpp"

#include "cluxel/error.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::perception {

namespace {

scan::PointTruth truthOf(const scan::Scan& scan, const std::filesystem::path& file, const TrainingSource& source) {
  if (!std::filesystem::is_directory(source.truth)) return truthFromLabels(scan, scan::LabelMap::load(source.truth));
  const auto truth_file = scan::truthFileOf(source.truth, file);
  if (!truth_file)
    throw InputError(SourceLocation{.file = file.string()}, "no truth for this scan in " + source.truth.string(),
                     "put a file named like the scan, with the ending .truth or .truth.gz, there");
  return scan::truthFromFile(*truth_file, scan.points.size());
}

/// The scans of one source, split into places that are processed separately.
std::vector<LabelledScans> placesOf(const TrainingSource& source, ProgressSink& sink) {
  const scan::ScanSet set = scan::ScanSet::open(source.inputs, {}, sink);
  std::vector<LabelledScans> places;
  std::filesystem::path folder_before;  // of the last scan with a pose
  for (std::size_t i = 0; i < set.size(); ++i) {
    scan::Scan scan = set.load(i);
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
      : perception_(perception), copies_(copies), threads_(threads) {}

  void add(const LabelledScans& scans, int group, bool only_for_training, std::vector<TrainingPlace>& places) const {
    const std::string name = scans.scans.front().source;
    places.push_back(make(scans, name, group, only_for_training));
    for (std::size_t i = 0; i < copies_.sensors.size(); ++i)
      addCopy(seenBy(scans.scans, scans.truth, copies_.sensors[i]), name + ", seen again", group, places);
    for (const VirtualDrive& drive : copies_.drives)
      addCopy(seenAlong(scans.scans, scans.truth, drive), name + ", driven past", group, places);
    if (copies_.thin_share > 0)
      addCopy(thinned(scans.scans, scans.truth, copies_.thin_share, kThinSeed), name + ", thinned", group, places);
  }

 private:
  static constexpr std::uint64_t kThinSeed = 17;

  TrainingPlace make(const LabelledScans& scans, const std::string& name, int group, bool only_for_training) const {
    TrainingPlace place = makePlace(scans.scans, scans.truth, perception_, threads_);
    place.name = name;
    place.group = group;
    place.only_for_training = only_for_training;
    return place;
  }

  void addCopy(const LabelledScans& copy, const std::string& name, int group,
               std::vector<TrainingPlace>& places) const {
    if (!copy.scans.empty()) places.push_back(make(copy, name, group, true));
  }

  const PerceptionParams& perception_;
  const CopyParams& copies_;
  unsigned threads_;
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

}  // namespace cluxel::perception
