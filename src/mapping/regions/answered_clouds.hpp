// SPDX-License-Identifier: Apache-2.0
// The points of all clouds with what the map says about them: memory follows a region and a cloud, not the map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// A region of so many cluxels, with its points, takes some 150 MB.
inline constexpr std::size_t kAnsweredCluxels = 200'000;

/// The arrays of the answers are parallel to the points.
using AnsweredVisit = std::function<void(const Cloud&, const scan::ScanPoints&, const PointAnswers&)>;

/// Visits all clouds in the order of MapReader::clouds(), with the answers of MapReader::answersFor(). A map of more
/// than `max_cluxels` is read region by region; the answers wait in a temporary file, 13 bytes a point, until their
/// cloud is complete. Throws Error (StoreUnavailable) for a damaged map, and when there is no room for that file. Cost:
/// about 0.3 us a point, and for each region 20 ns a point of all scans in it.
void forEachAnsweredCloud(const MapReader& map, const AnsweredVisit& visit, std::size_t max_cluxels = kAnsweredCluxels);
/// The same of these clouds of the map, in their order. Only the tiles within their bounds are read, but of all scans
/// in them: who asks for one cloud after the other takes KeptAnswers.
void forEachAnsweredCloud(const MapReader& map, std::vector<Cloud> clouds, const AnsweredVisit& visit,
                          std::size_t max_cluxels = kAnsweredCluxels);

/// Numbers of points in their cloud, ascending, with the PrimitiveLabel of each.
using LabelledPoints = std::vector<std::pair<std::uint32_t, std::uint8_t>>;
using ObjectPointsVisit = std::function<void(const Cloud&, const scan::ScanPoints&, const LabelledPoints&)>;

/// Visits the clouds that hold points of an object, in the order of MapReader::clouds(). `object`: its number in
/// MapReader::objects(). Only its tiles are read, region by region; from several, its points wait in a temporary file.
/// Throws as forEachAnsweredCloud(). Cost: 20 ns for each point of the clouds whose bounds meet its tiles, and 0.3 us
/// for each of the points in these.
void forEachCloudOfObject(const MapReader& map, std::uint32_t object, const ObjectPointsVisit& visit,
                          std::size_t max_cluxels = kAnsweredCluxels);

/// The same answers for single clouds and objects of one commit, for callers that ask again and again: the tiles of the
/// last calls stay, of at most `max_cluxels` together. The second call that lacks one reads all tiles of a map that is
/// not larger. What does not fit is read as by the functions above. Not thread-safe.
class KeptAnswers {
 public:
  explicit KeptAnswers(const MapReader& map, std::size_t max_cluxels = kAnsweredCluxels);
  ~KeptAnswers();
  KeptAnswers(const KeptAnswers&) = delete;
  KeptAnswers& operator=(const KeptAnswers&) = delete;

  /// Whether `map` reads the commit of the constructor, as it must in the calls below.
  bool isOf(const MapReader& map) const;
  /// For all `points` of a cloud. Cost: 0.1 us a point, and for the tiles under the cloud that are not kept 0.3 us for
  /// each point in them and 20 ns for each point of the scans in them.
  PointAnswers answersFor(const MapReader& map, const Cloud& cloud, const scan::ScanPoints& points);
  /// As forEachCloudOfObject().
  void forEachCloud(const MapReader& map, std::uint32_t object, const ObjectPointsVisit& visit);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::mapping
