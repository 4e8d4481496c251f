// SPDX-License-Identifier: Apache-2.0
// --poses, --units and --up.
#include "app/scan_options.hpp"

#include <map>
#include <string>

namespace cluxel::app {

scan::ScanSetParams ScanOptions::params() const {
  return {.poses = poses,
          .frame = frame,
          .remedies = {.poses = "name a poses file with --poses FILE",
                       .unit = "state the unit with --units mm, cm, m, ft or us-ft",
                       .up = "state the up axis with --up y"}};
}

void addScanOptions(CLI::App& command, ScanOptions& options) {
  using scan::LengthUnit;
  using scan::UpAxis;
  const std::map<std::string, LengthUnit> units{{"m", LengthUnit::Metre},
                                                {"cm", LengthUnit::Centimetre},
                                                {"mm", LengthUnit::Millimetre},
                                                {"ft", LengthUnit::Foot},
                                                {"us-ft", LengthUnit::UsSurveyFoot}};
  const std::map<std::string, UpAxis> axes{{"z", UpAxis::Z}, {"y", UpAxis::Y}};
  command.add_option("--poses", options.poses, "poses of the scans: KITTI 3x4, TUM, or 4x4 text");
  command.add_option("--units", options.frame.unit, "unit of the scans and poses: m (default), cm, mm, ft or us-ft")
      ->transform(CLI::CheckedTransformer(units).description("UNIT"));
  command.add_option("--up", options.frame.up, "axis of the scans and poses that points up: z (default) or y")
      ->transform(CLI::CheckedTransformer(axes).description("AXIS"));
}

}  // namespace cluxel::app
