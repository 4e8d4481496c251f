// SPDX-License-Identifier: Apache-2.0
// Reads the numbers of objects from a scan's own file: the map keeps its points and labels only.
#include <filesystem>

#include "base/file_bytes.hpp"
#include "scan/formats/ply_format.hpp"
#include "scan/scan_loader.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::scan {

namespace {

/// Evaluation numbers the objects of several scans one after the other.
constexpr std::uint32_t kMaxInstances = 1'000'000;

/// Whether the file holds the scan when its points are read in this frame, with the scan's pose or without one. Throws
/// InputError where they cannot be.
bool isReadAs(const Scan& scan, ParsedScan parsed, const InputFrame& frame, bool has_pose) {
  ScanFile file;
  file.path = scan.source;
  file.format = ScanFormat::Ply;
  file.frame = frame;
  file.has_pose = has_pose;
  if (has_pose) file.T_map_sensor = scan.T_map_sensor;
  return scanOf(file, parsed).id == scan.id;
}

/// Whether what the file holds was measured as the scan was. A map keeps neither unit nor axes of its inputs: all are
/// tried, metres with z up first. Nor does it keep whether a scan that has a pose had one when it was read, or got it
/// later: both are tried, too, because points far from the origin are read in two ways.
bool holds(const ParsedScan& parsed, const Scan& scan) {
  for (const UpAxis up : {UpAxis::Z, UpAxis::Y})
    for (const LengthUnit unit : {LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre, LengthUnit::Foot,
                                  LengthUnit::UsSurveyFoot})
      for (const bool has_pose : {true, false}) try {
          if ((scan.has_pose || !has_pose) && isReadAs(scan, parsed, {unit, up}, has_pose)) return true;
        } catch (const InputError&) {
          continue;  // so far away in this unit that no map has it
        }
  return false;
}

}  // namespace

std::vector<std::int32_t> instancesFromFile(const Scan& scan, const std::string& field) {
  const std::filesystem::path file = scan.source;
  const std::string remedy = "run where the scan's file has the path that the map was built with";
  if (!std::filesystem::exists(file))
    throw InputError({.file = file.string()}, "is not there; its field '" + field + "' numbers the objects", remedy);
  if (file.extension() != ".ply")
    throw InputError({.file = file.string()}, "is no PLY file; only these can number objects in a field",
                     "use a folder of truth files");
  const ParsedScan parsed = parsePly(readFile(file), file.string(), field);
  const std::vector<std::uint32_t>& numbers = parsed.points.label;
  if (numbers.size() != scan.points.size())
    throw InputError({.file = file.string()},
                     "has " + std::to_string(numbers.size()) + " points where the map's scan has " +
                         std::to_string(scan.points.size()),
                     remedy);
  if (!holds(parsed, scan))
    throw InputError({.file = file.string()},
                     "holds another scan now than the one that the map read from it, or its points in another order; "
                     "its field '" +
                         field + "' does not number the objects of the map's scan",
                     remedy);
  std::vector<std::int32_t> instances;
  instances.reserve(numbers.size());
  for (const std::uint32_t number : numbers) {
    if (number != kNoLabel && number > kMaxInstances)
      throw InputError({.file = file.string()}, "the field '" + field + "' holds " + std::to_string(number),
                       "numbers of objects go up to " + std::to_string(kMaxInstances));
    instances.push_back(number == kNoLabel ? -1 : static_cast<std::int32_t>(number));
  }
  return instances;
}

}  // namespace cluxel::scan
