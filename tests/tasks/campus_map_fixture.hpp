// SPDX-License-Identifier: Apache-2.0
// A map of a generated campus with what is true of it, built once a process: for tests of exports and questions.
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "mapping/small_campus.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;

/// One object of the truth as the scans saw it.
struct TruthObject {
  std::string class_name;  ///< "Tree"
  std::size_t points = 0;
  Eigen::AlignedBox3d box_map_m;
  Eigen::Vector3d center_map_m = Eigen::Vector3d::Zero();  ///< mean of its points
};

class CampusMap {
 public:
  static const CampusMap& shared();

  CampusMap();
  const MapReader& map() const { return map_; }
  const SmallCampus& campus() const { return campus_; }
  const std::filesystem::path& file() const { return file_; }
  const std::vector<TruthObject>& truth() const { return truth_; }
  std::vector<TruthObject> truthOf(const std::string& class_name, std::size_t min_points) const;
  /// The boxes that the RDF says the objects have [m, map], by hash: another way from the points to a file.
  std::map<std::string, Eigen::AlignedBox3d> boxesInRdf() const;
  /// The answer of queries/NAME.rq, with parameters as NAME=VALUE.
  ResultTable answer(const std::string& name, const std::vector<std::string>& parameters = {}) const;

 private:
  SmallCampus campus_;
  ScratchFolder folder_;
  std::filesystem::path file_;
  MapReader map_;
  std::vector<TruthObject> truth_;
};

/// A cell as a number; NaN when it is unbound or no number.
double numberAt(const ResultTable& table, std::size_t row, const std::string& column);
/// A cell's text; empty when it is unbound.
std::string textAt(const ResultTable& table, std::size_t row, const std::string& column);

/// Where the sensor stood at one of the stops, as tasks take places. The scans have no times, so none is the last.
std::string placeOfAStop(const mapping::MapReader& map);

}  // namespace cluxel::tasks
