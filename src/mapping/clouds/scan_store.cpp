// SPDX-License-Identifier: Apache-2.0
// Stores and loads scans.
#include "mapping/clouds/scan_store.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/parallel.hpp"
#include "base/text/short_number.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/packed_points.hpp"
#include "mapping/clouds/scan_plausibility.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/clustering/tile_points.hpp"

namespace cluxel::mapping {

namespace {

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
  json["rays"] = Json::array({vectorJson(cloud.rays.min()), vectorJson(cloud.rays.max())});
  if (cloud.sight) json["sensor"] = vectorJson(cloud.sight->origin);
  if (cloud.sight && cloud.sight->upper_edge) {
    const perception::UpperEdge& edge = *cloud.sight->upper_edge;
    json["upper_edge"] = vectorJson({edge.mean_rad, edge.cosine_rad, edge.sine_rad});
  }
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
    if (json.contains("rays")) cloud.rays = {vectorFrom(json["rays"].at(0)), vectorFrom(json["rays"].at(1))};
    if (json.contains("sensor")) cloud.sight = perception::SensorSight{vectorFrom(json["sensor"]), std::nullopt};
    if (cloud.sight && json.contains("upper_edge")) {
      const Eigen::Vector3d edge = vectorFrom(json["upper_edge"]);
      cloud.sight->upper_edge = perception::UpperEdge{edge[0], edge[1], edge[2]};
    }
    if (json.contains("time_s")) cloud.time_s = json.at("time_s").get<double>();
    return cloud;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::StoreUnavailable,
                "the description of cloud " + id.hex() + " is damaged (" + fault.what() + "); build the map anew");
  }
}

/// The cloud with what its points tell of it, without a look at each.
Cloud withRayStarts(const rdf::ReadTransaction& transaction, Cloud cloud) {
  cloud.has_ray_starts = cloud.has_pose;
  if (cloud.has_pose) return cloud;
  const auto points = transaction.block(tables::kScanPoints, tables::keyOf(cloud.id));
  cloud.has_ray_starts = points && haveOrigins(*points, cloud.point_count);
  return cloud;
}

/// What tells whether a scan is there, without a look at its points.
Cloud unmeasuredCloud(const scan::Scan& scan) {
  Cloud cloud;
  cloud.id = scan.id, cloud.source = scan.source, cloud.time_s = scan.time_s;
  cloud.T_map_sensor = scan.T_map_sensor, cloud.has_pose = scan.has_pose;
  cloud.has_ray_starts = scan.has_pose || !scan.points.origin.empty();
  cloud.point_count = scan.points.size();
  return cloud;
}

Cloud cloudOf(const scan::Scan& scan) {
  Cloud cloud = unmeasuredCloud(scan);
  cloud.sight = perception::sensorSightOf(scan);
  cloud.min.setConstant(1e300), cloud.max.setConstant(-1e300);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d p = scan::toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    cloud.min = cloud.min.cwiseMin(p);
    cloud.max = cloud.max.cwiseMax(p);
  }
  cloud.rays = {cloud.min, cloud.max};
  cloud.rays.extend(Eigen::Vector3d(scan.T_map_sensor.translation()));
  for (const auto& origin : scan.points.origin) cloud.rays.extend(scan::toMap(scan.T_map_sensor, origin));
  return cloud;
}

/// The later one does not depend on the order of the scans. An absent time compares as earlier.
void keepLaterTime(rdf::WriteTransaction& transaction, Cloud there, std::optional<double> time_s) {
  // Maps of earlier versions hold finer times.
  if (time_s > toMicroseconds(there.time_s)) storeTime(transaction, std::move(there), *time_s);
}

/// Poses that are closer differ because numbers were written or computed in another way.
constexpr double kRounding_m = 1e-6, kRounding_deg = 1e-6;

std::string textOfDifference(const Eigen::Isometry3d& given, const Eigen::Isometry3d& there) {
  const double moved_m = (given.translation() - there.translation()).norm();
  const double turned_deg =
      Eigen::AngleAxisd(given.linear() * there.linear().transpose()).angle() * 180 / std::numbers::pi;
  std::array<char, 96> text{};
  if (moved_m < kRounding_m && turned_deg < kRounding_deg) return "with a pose that differs by rounding alone";
  std::snprintf(text.data(), text.size(), "with another pose (%.3f m and %.3f degrees away)", moved_m, turned_deg);
  return text.data();
}

bool haveEqualPoses(const Cloud& a, const Cloud& b) {
  return numbersOf(a.T_map_sensor) == numbersOf(b.T_map_sensor) && a.has_pose == b.has_pose;
}

/// Whether the map has the scan, which then gets the later of the two times. Refuses it with another pose: sensor
/// positions are stored only for scans with a pose, so a scan given with and without one would make the map depend on
/// arrival order.
bool isThere(rdf::WriteTransaction& transaction, const Cloud& given) {
  auto there = storedCloud(transaction, given.id);
  if (!there) return false;
  if (haveEqualPoses(given, *there)) {
    keepLaterTime(transaction, *std::move(there), given.time_s);
    return true;
  }
  const std::string how = there->has_pose == given.has_pose ? textOfDifference(given.T_map_sensor, there->T_map_sensor)
                          : given.has_pose                  ? "now with a pose"
                                                            : "now without a pose";
  throw InputError({.file = given.source}, "is the same scan as '" + there->source + "' of the map, " + how,
                   "give each scan once; to correct its pose, move the scan in the map", Remedy::MoveScans);
}

/// The packed points of a scan. They stay until the next write.
std::string_view requiredPoints(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  if (const auto block = transaction.block(tables::kScanPoints, tables::keyOf(id))) return *block;
  throw Error(ErrorKind::StoreUnavailable, "cloud " + id.hex() + " has no points in the map; build it anew");
}

void requireTime(const scan::Scan& scan) {
  if (scan.time_s && !hasCalendarYear(*scan.time_s))
    throw InputError({.file = scan.source},
                     "its time of " + shortNumber(*scan.time_s) + " s lies outside the years 1 to 9999",
                     "times are seconds since 1970-01-01 UTC: is it in milliseconds or nanoseconds?");
}

}  // namespace

scan::Scan scanOf(const Cloud& cloud, scan::ScanPoints points) {
  scan::Scan scan;
  scan.points = std::move(points);
  scan.time_s = cloud.time_s;
  scan.T_map_sensor = cloud.T_map_sensor;
  scan.has_pose = cloud.has_pose;
  scan.source = cloud.source;
  scan.id = cloud.id;
  return scan;
}

TileSet tilesInBounds(const Cloud& cloud, const TileSet& tiles, const perception::TileGrid& grid) {
  const perception::TileKey low = grid.tileOf(cloud.min), high = grid.tileOf(cloud.max);
  TileSet reached;
  for (auto tile = tiles.lower_bound({low.x, low.y}); tile != tiles.end() && tile->x <= high.x; ++tile)
    if (tile->y >= low.y && tile->y <= high.y) reached.insert(*tile);
  return reached;
}

TileSet PointChanges::tiles() const {
  TileSet all = anew;
  for (const auto& [tile, segments] : added) all.insert(tile);
  for (const auto& [tile, points] : stored_points) all.insert(tile);
  if (copied != nullptr) all.merge(storedTiles(*copied));
  return all;
}

void PointChanges::readAnew(const rdf::ReadTransaction& transaction) {
  noteAnew(transaction);
  const perception::TileGrid grid = storedGrid(transaction);
  for (const auto& [scan, lowest] : std::exchange(scans_anew, {}))
    for (auto& [tile, segment] : perception::splitScan(storedScan(transaction, scan), grid))
      if (anew.contains(tile)) added[tile].push_back(std::move(segment));
}

void PointChanges::noteAnew(const rdf::ReadTransaction& transaction) {
  if (anew.empty()) return;
  for (const perception::TileKey& tile : anew) added[tile].clear();  // no scan may have points there
  const perception::TileGrid grid = storedGrid(transaction);
  for (const Cloud& cloud : storedClouds(transaction))
    if (const TileSet reached = tilesInBounds(cloud, anew, grid); !reached.empty()) {
      perception::TileKey lowest = *reached.begin();
      for (const perception::TileKey& tile : reached) lowest.y = std::min(lowest.y, tile.y);
      scans_anew.emplace(cloud.id, lowest);
    }
}

void PointChanges::add(ScanSegments segments, std::uint64_t part_points) {
  for (const auto& [tile, segment] : segments) points_ += segment.size();
  if (points_ > part_points + part_points / 2) {
    for (const auto& [tile, of_tile] : std::exchange(added, {}))
      for (const perception::ScanSegment& segment : of_tile) note(segment);
    for (const auto& [tile, segment] : segments) note(segment);
    return;
  }
  for (auto& [tile, segment] : segments) added[tile].push_back(std::move(segment));
}

void PointChanges::note(const perception::ScanSegment& segment) {
  const auto [scan, is_new] = stored.try_emplace(segment.scan, segment.key);
  scan->second = {std::min(scan->second.x, segment.key.x), std::min(scan->second.y, segment.key.y)};
  stored_points[segment.key] += segment.size();
}

TileSet storedTiles(const rdf::ReadTransaction& transaction) {
  TileSet tiles;
  const auto bytes = transaction.block(tables::kMeta, tables::kTilesKey);
  for (std::size_t at = 0; bytes && at + 8 <= bytes->size(); at += 8)
    tiles.insert(tables::tileOfKey(bytes->substr(at, 8)));
  return tiles;
}

void storeTiles(rdf::WriteTransaction& transaction, const TileSet& tiles) {
  std::string bytes;
  for (const perception::TileKey& tile : tiles) bytes += tables::keyOf(tile);
  transaction.putBlock(tables::kMeta, tables::kTilesKey, bytes);
}

std::optional<std::string> differenceOfPoses(const Cloud& given, const Cloud& there) {
  if (haveEqualPoses(given, there)) return std::nullopt;
  if (given.has_pose != there.has_pose) return given.has_pose ? "with a pose" : "without a pose";
  return textOfDifference(given.T_map_sensor, there.T_map_sensor);
}

PreparedScan prepareScan(const scan::Scan& scan, const perception::TileGrid& grid) {
  requireTime(scan);
  PreparedScan prepared{cloudOf(scan), {}, perception::splitScan(scan, grid)};
  requirePlausible(scan, prepared.segments);
  prepared.packed_points = packedPoints(scan.points);
  return prepared;
}

ScanSegments storeScan(rdf::WriteTransaction& transaction, const scan::Scan& scan) {
  requireTime(scan);
  if (isThere(transaction, unmeasuredCloud(scan))) return {};
  return storeScan(transaction, prepareScan(scan, storedGrid(transaction)));
}

ScanSegments storeScan(rdf::WriteTransaction& transaction, PreparedScan scan) {
  if (isThere(transaction, scan.cloud)) return {};
  const std::string key = tables::keyOf(scan.cloud.id);
  transaction.putBlock(tables::kScanPoints, key, scan.packed_points);
  transaction.putBlock(tables::kScans, key, toBytes(scan.cloud));
  return std::move(scan.segments);
}

void storeTime(rdf::WriteTransaction& transaction, Cloud cloud, double time_s) {
  cloud.time_s = time_s;
  transaction.putBlock(tables::kScans, tables::keyOf(cloud.id), toBytes(cloud));
}

bool copyScan(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other, const Cloud& cloud) {
  if (isThere(transaction, cloud)) return false;
  const std::string key = tables::keyOf(cloud.id);
  for (const std::string_view table : {tables::kScanPoints, tables::kScans}) {
    const auto block = other.block(table, key);
    if (!block)
      throw Error(ErrorKind::StoreUnavailable, "cloud " + cloud.id.hex() + " has no points in the map; build it anew");
    transaction.putBlock(table, key, *block);
  }
  return true;
}

TileSet removeScan(rdf::WriteTransaction& transaction, const scan::ScanId& id) {
  TileSet touched;
  for (const auto& [tile, segment] : perception::splitScan(storedScan(transaction, id), storedGrid(transaction)))
    touched.insert(tile);
  transaction.eraseBlock(tables::kScanPoints, tables::keyOf(id));
  transaction.eraseBlock(tables::kScans, tables::keyOf(id));
  return touched;
}

std::vector<ScanSegments> segmentsOfScans(const rdf::ReadTransaction& transaction, std::span<const scan::ScanId> scans,
                                          unsigned threads) {
  std::vector<Cloud> clouds;
  std::vector<std::string_view> blocks;
  for (const scan::ScanId& id : scans) {
    clouds.push_back(requiredCloud(transaction, id));
    blocks.push_back(requiredPoints(transaction, id));
  }
  const perception::TileGrid grid = storedGrid(transaction);
  std::vector<ScanSegments> segments(scans.size());
  parallelFor(scans.size(), threads, [&](std::size_t i) {
    segments[i] = perception::splitScan(scanOf(clouds[i], unpackedPoints(blocks[i], clouds[i].point_count)), grid);
  });
  return segments;
}

scan::Scan storedScan(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  return scanOf(requiredCloud(transaction, id), storedPoints(transaction, id));
}

std::vector<Cloud> storedClouds(const rdf::ReadTransaction& transaction) {
  std::vector<Cloud> clouds;
  transaction.forEachBlock(tables::kScans, "", [&](std::string_view key, std::string_view bytes) {
    clouds.push_back(withRayStarts(transaction, cloudFromBytes(tables::hashOfKey(key), bytes)));
  });
  return clouds;
}

std::optional<Cloud> storedCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  const auto bytes = transaction.block(tables::kScans, tables::keyOf(id));
  if (!bytes) return std::nullopt;
  return withRayStarts(transaction, cloudFromBytes(id, *bytes));
}

Cloud requiredCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  if (auto cloud = storedCloud(transaction, id)) return *std::move(cloud);
  throw Error(ErrorKind::NotFound, "the map has no cloud " + id.hex());
}

scan::ScanPoints storedPoints(const rdf::ReadTransaction& transaction, const scan::ScanId& id) {
  const std::string_view packed = requiredPoints(transaction, id);
  const auto cloud = storedCloud(transaction, id);
  return unpackedPoints(packed, cloud ? cloud->point_count : 0);
}

}  // namespace cluxel::mapping
