// SPDX-License-Identifier: Apache-2.0
// Stores and loads scans.
#include "mapping/build/scan_store.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "mapping/build/scan_plausibility.hpp"
#include "mapping/map_tables.hpp"
#include "perception/clustering/tile_points.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kTilesKey = "tiles";

using Json = nlohmann::json;

std::vector<double> numbersOf(const Eigen::Isometry3d& pose) {
  return {pose.matrix().data(), pose.matrix().data() + 16};
}

Json vectorJson(const Eigen::Vector3d& v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Eigen::Vector3d vectorFrom(const Json& json) {
  return Eigen::Vector3d(json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>());
}

std::string toBytes(const Cloud& cloud) {
  Json json{{"source", cloud.source},      {"pose", numbersOf(cloud.T_map_sensor)}, {"has_pose", cloud.has_pose},
            {"points", cloud.point_count}, {"min", vectorJson(cloud.min)},          {"max", vectorJson(cloud.max)}};
  if (cloud.time_s) json["time_s"] = *cloud.time_s;
  const auto bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

Cloud cloudFromBytes(const scan::ScanId& id, std::string_view bytes) {
  try {
    const Json json = Json::from_cbor(bytes);
    Cloud cloud;
    cloud.id = id;
    cloud.source = json.at("source");
    const auto pose = json.at("pose").get<std::vector<double>>();
    if (pose.size() != 16) throw std::invalid_argument("a pose has 16 numbers");
    std::copy(pose.begin(), pose.end(), cloud.T_map_sensor.matrix().data());
    cloud.has_pose = json.at("has_pose");
    cloud.point_count = json.at("points");
    cloud.min = vectorFrom(json.at("min"));
    cloud.max = vectorFrom(json.at("max"));
    if (json.contains("time_s")) cloud.time_s = json.at("time_s").get<double>();
    return cloud;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::StoreUnavailable,
                "the description of cloud " + id.hex() + " is damaged (" + fault.what() + "); build the map anew");
  }
}

template <typename T>
void append(std::string& bytes, const std::vector<T>& values) {
  const std::uint64_t count = values.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  if (count > 0) bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

template <typename T>
std::vector<T> takeArray(std::string_view& bytes) {
  const auto damaged = [] {
    return Error(ErrorKind::StoreUnavailable, "points of a cloud are damaged; build the map anew");
  };
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) throw damaged();
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (count > bytes.size() / sizeof(T)) throw damaged();
  std::vector<T> values(count);
  if (count > 0) std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return values;
}

std::string toBytes(const scan::ScanPoints& points) {
  std::string bytes;
  append(bytes, points.x), append(bytes, points.y), append(bytes, points.z);
  append(bytes, points.intensity), append(bytes, points.label), append(bytes, points.origin);
  return bytes;
}

Cloud cloudOf(const scan::Scan& scan) {
  Cloud cloud{scan.id, scan.source, scan.time_s, scan.T_map_sensor, scan.has_pose, scan.points.size(), {}, {}};
  cloud.min.setConstant(1e300), cloud.max.setConstant(-1e300);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d p = scan::toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    cloud.min = cloud.min.cwiseMin(p);
    cloud.max = cloud.max.cwiseMax(p);
  }
  return cloud;
}

void putTiles(rdf::WriteTransaction& transaction, const TileSet& tiles) {
  std::string bytes;
  for (const perception::TileKey& tile : tiles) bytes += tables::keyOf(tile);
  transaction.putBlock(tables::kMeta, kTilesKey, bytes);
}

/// The later one does not depend on the order of the scans. An absent time compares as earlier.
void keepLaterTime(rdf::WriteTransaction& transaction, Cloud there, std::optional<double> time_s) {
  if (time_s <= there.time_s) return;
  there.time_s = time_s;
  transaction.putBlock(tables::kScans, tables::keyOf(there.id), toBytes(there));
}

/// The years that xsd:dateTime writes with four digits.
void requireTime(const scan::Scan& scan) {
  constexpr double kFirst_s = -62135596800.0, kEnd_s = 253402300799.0;
  if (scan.time_s && !(*scan.time_s >= kFirst_s && *scan.time_s < kEnd_s))
    throw InputError({.file = scan.source},
                     "its time of " + std::to_string(*scan.time_s) + " s lies outside the years 1 to 9999",
                     "times are seconds since 1970-01-01 UTC: is it in milliseconds or nanoseconds?");
}

}  // namespace

TileSet storedTiles(const rdf::ReadTransaction& transaction) {
  TileSet tiles;
  const auto bytes = transaction.block(tables::kMeta, kTilesKey);
  for (std::size_t at = 0; bytes && at + 8 <= bytes->size(); at += 8)
    tiles.insert(tables::tileOfKey(bytes->substr(at, 8)));
  return tiles;
}

TileSet storeScan(rdf::WriteTransaction& transaction, const scan::Scan& scan) {
  requireTime(scan);
  if (auto there = storedCloud(transaction, scan.id)) {
    // Sensor positions are stored only for scans with a pose, so a scan given with and without one would make the map
    // depend on arrival order.
    const bool same =
        numbersOf(there->T_map_sensor) == numbersOf(scan.T_map_sensor) && there->has_pose == scan.has_pose;
    if (same) {
      keepLaterTime(transaction, *std::move(there), scan.time_s);
      return {};
    }
    const std::string how = there->has_pose == scan.has_pose ? "with another pose"
                            : scan.has_pose                  ? "now with a pose"
                                                             : "now without a pose";
    throw InputError({.file = scan.source}, "is the same scan as '" + there->source + "', " + how,
                     "give each scan once; to correct its pose, move the scan in the map");
  }
  TileSet tiles;
  const auto segments = perception::splitScan(scan);
  requirePlausible(scan, segments);
  for (const auto& [tile, segment] : segments) {
    transaction.putBlock(tables::kSegments, tables::keyOf(tile) + tables::keyOf(scan.id), toBytes(segment));
    tiles.insert(tile);
  }
  transaction.putBlock(tables::kScanPoints, tables::keyOf(scan.id), toBytes(scan.points));
  transaction.putBlock(tables::kScans, tables::keyOf(scan.id), toBytes(cloudOf(scan)));
  putTiles(transaction, unionOf(storedTiles(transaction), tiles));
  return tiles;
}

TileSet removeScan(rdf::WriteTransaction& transaction, const scan::ScanId& id) {
  const scan::Scan scan = storedScan(transaction, id);
  TileSet touched, emptied;
  for (const auto& [tile, segment] : perception::splitScan(scan)) {
    transaction.eraseBlock(tables::kSegments, tables::keyOf(tile) + tables::keyOf(id));
    touched.insert(tile);
    bool is_empty = true;
    transaction.forEachBlock(tables::kSegments, tables::keyOf(tile),
                             [&](std::string_view, std::string_view) { is_empty = false; });
    if (is_empty) emptied.insert(tile);
  }
  transaction.eraseBlock(tables::kScanPoints, tables::keyOf(id));
  transaction.eraseBlock(tables::kScans, tables::keyOf(id));
  TileSet left = storedTiles(transaction);
  for (const perception::TileKey& tile : emptied) left.erase(tile);
  putTiles(transaction, left);
  return touched;
}

scan::Scan storedScan(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  const auto cloud = storedCloud(transaction, id);
  if (!cloud) throw Error(ErrorKind::NotFound, "the map has no cloud " + id.hex());
  scan::Scan scan;
  scan.points = storedPoints(transaction, id);
  scan.time_s = cloud->time_s;
  scan.T_map_sensor = cloud->T_map_sensor;
  scan.has_pose = cloud->has_pose;
  scan.source = cloud->source;
  scan.id = id;
  return scan;
}

std::vector<Cloud> storedClouds(const rdf::ReadTransaction& transaction) {
  std::vector<Cloud> clouds;
  transaction.forEachBlock(tables::kScans, "", [&](std::string_view key, std::string_view bytes) {
    clouds.push_back(cloudFromBytes(tables::hashOfKey(key), bytes));
  });
  return clouds;
}

std::optional<Cloud> storedCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  const auto bytes = transaction.block(tables::kScans, tables::keyOf(id));
  if (!bytes) return std::nullopt;
  return cloudFromBytes(id, *bytes);
}

scan::ScanPoints storedPoints(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  const auto block = transaction.block(tables::kScanPoints, tables::keyOf(id));
  if (!block)
    throw Error(ErrorKind::StoreUnavailable, "cloud " + id.hex() + " has no points in the map; build it anew");
  std::string_view bytes = *block;
  scan::ScanPoints points;
  points.x = takeArray<float>(bytes), points.y = takeArray<float>(bytes), points.z = takeArray<float>(bytes);
  points.intensity = takeArray<float>(bytes);
  points.label = takeArray<std::uint32_t>(bytes);
  points.origin = takeArray<Eigen::Vector3f>(bytes);
  return points;
}

}  // namespace cluxel::mapping
