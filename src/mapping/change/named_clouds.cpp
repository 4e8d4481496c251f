// SPDX-License-Identifier: Apache-2.0
// A path names the scan that was read from it. When the file has other content now, the name may mean that instead.
#include "mapping/change/named_clouds.hpp"

#include <algorithm>
#include <optional>

#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/map_history.hpp"
#include "rdf/file/environment.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

bool isIdOf(const scan::ScanId& id, const std::string& name) {
  constexpr std::size_t kMinDigits = 4;
  std::string digits = name;
  if (const std::size_t slash = name.rfind('/'); slash != std::string::npos && name.find("cloud/") != std::string::npos)
    digits = name.substr(slash + 1);
  return digits.size() >= kMinDigits && id.hex().starts_with(digits);
}

bool isNamed(const scan::ScanId& id, const fs::path& source, const std::string& name) {
  if (isIdOf(id, name)) return true;
  if (source == name || source.filename() == name || source.stem() == name)
    return true;  // "0001" may be meant as a file
  std::error_code ignored;
  return name.find('/') != std::string::npos && fs::equivalent(source, name, ignored);
}

/// The scan that a file holds now. Absent when there is no such file, or it cannot be read by itself.
std::optional<scan::ScanId> scanIn(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  try {
    ProgressSink silent;
    const scan::ScanSet set = scan::ScanSet::open({file}, {}, silent);
    return set.size() == 1 ? std::optional(set.load(0).id) : std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

void requireSameScan(const std::string& name, const scan::ScanId& meant, const std::vector<Cloud>& clouds,
                     ProgressSink& sink) {
  if (isIdOf(meant, name)) return;
  const std::optional<scan::ScanId> held = scanIn(name);
  if (!held || *held == meant) return;
  const auto other = std::find_if(clouds.begin(), clouds.end(), [&](const Cloud& cloud) { return cloud.id == *held; });
  if (other != clouds.end())
    throw Error(ErrorKind::InvalidArgument, name + ": holds cloud " + held->hex() + " now, which the map read from '" +
                                                other->source + "'; what the map read from this name is cloud " +
                                                meant.hex() + ". Name one of them by its id");
  sink.note(name + ": is taken for cloud " + meant.hex() +
            ", which was read from it; what the file holds now is another scan, or was read in another way");
}

}  // namespace

std::vector<scan::ScanId> cloudsNamed(const fs::path& file, std::span<const std::string> names, ProgressSink& sink,
                                      CloudNaming naming) {
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadOnly);
  const rdf::ReadTransaction transaction = environment->read();
  const std::vector<Cloud> clouds = storedClouds(transaction);
  std::optional<std::vector<RetractedScan>> former;
  std::vector<scan::ScanId> ids;
  for (const std::string& name : names) {
    std::vector<scan::ScanId> fitting;
    for (const Cloud& cloud : clouds)
      if (isNamed(cloud.id, cloud.source, name)) fitting.push_back(cloud.id);
    if (fitting.size() > 1)
      throw Error(ErrorKind::InvalidArgument, file.string() + ": '" + name + "' names " +
                                                  std::to_string(fitting.size()) + " clouds; name each by its id");
    if (fitting.size() == 1 && naming.compare == CompareFiles::Yes)
      requireSameScan(name, fitting.front(), clouds, sink);
    if (fitting.empty() && naming.include == IncludeRetracted::Yes) {
      if (!former) former = retractedScans(transaction);
      for (const RetractedScan& scan : *former)  // nothing is to be done for any of them
        if (std::any_of(scan.sources.begin(), scan.sources.end(),
                        [&](const std::string& source) { return isNamed(scan.id, source, name); }))
          fitting.push_back(scan.id);
    }
    if (fitting.empty())
      throw Error(ErrorKind::NotFound,
                  file.string() + ": has no cloud '" + name + "'" +
                      (name.find('/') != std::string::npos
                           ? "; give the path as it was given when the scan was added, or another path of the same file"
                           : ""),
                  Remedy::ListClouds);
    ids.insert(ids.end(), fitting.begin(), fitting.end());
  }
  return ids;
}

}  // namespace cluxel::mapping
