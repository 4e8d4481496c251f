// SPDX-License-Identifier: Apache-2.0
// Reads the numbers of objects from a scan's own file: the map keeps its points and labels only.
#include <filesystem>

#include "base/file_bytes.hpp"
#include "scan/formats/ply_format.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::scan {

namespace {

/// Evaluation numbers the objects of several scans one after the other.
constexpr std::uint32_t kMaxInstances = 1'000'000;

}  // namespace

std::vector<std::int32_t> instancesFromFile(const std::filesystem::path& file, const std::string& field,
                                            std::size_t point_count) {
  const std::string remedy = "run where the scan's file has the path that the map was built with";
  if (!std::filesystem::exists(file))
    throw InputError({.file = file.string()}, "is not there; its field '" + field + "' numbers the objects", remedy);
  if (file.extension() != ".ply")
    throw InputError({.file = file.string()}, "is no PLY file; only these can number objects in a field",
                     "use a folder of truth files");
  const ParsedScan parsed = parsePly(readFile(file), file.string(), field);
  const std::vector<std::uint32_t>& numbers = parsed.points.label;
  if (numbers.size() != point_count)
    throw InputError(
        {.file = file.string()},
        "has " + std::to_string(numbers.size()) + " points where the map's scan has " + std::to_string(point_count),
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
