// SPDX-License-Identifier: Apache-2.0
// Any bytes as poses, calibration and times.
#include "scan/poses/pose_files.hpp"
#include "scan_reader_fuzzing.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cluxel;
  using namespace cluxel::scan;
  const std::string_view bytes = fuzz::textOf(data, size);
  fuzz::feed([&] {
    const PoseList list = parsePoses(bytes, "poses.txt");
    fuzz::require(!list.poses.empty() && (list.time_s.empty() || list.time_s.size() == list.poses.size()));
    for (const auto& pose : list.poses) fuzz::require(!faultOfPose(pose));
  });
  fuzz::feed([&] { fuzz::require(!faultOfPose(parseKittiCalibration(bytes, "calib.txt"))); });
  fuzz::feed([&] { fuzz::require(!faultOfPose(parseFreiburgPose(bytes, "pose.dat"))); });
  fuzz::feed([&] { parseTimes(bytes, "times.txt"); });
  return 0;
}
