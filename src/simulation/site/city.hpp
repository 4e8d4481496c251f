// SPDX-License-Identifier: Apache-2.0
// A generated city: a grid of campuses on one terrain, each made for itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "simulation/site/campus.hpp"

namespace cluxel::simulation {

struct CityParams {
  CampusParams district;  ///< of every district; its seed is that of the city
  std::size_t columns = 1, rows = 1;
};

/// Columns and rows go up to this.
inline constexpr std::size_t kMaxCityEdge = 100;

/// Crowns hang over the border of a district by less than this.
inline constexpr double kMaxOverhang_m = 3;

/// Throws Error (InvalidArgument) as check(CampusParams) does, and when the grid is too large or has several visits.
void check(const CityParams& params);

/// One district, ready to be scanned. Its frame is that of the map, moved to the middle of the district.
struct District {
  DistrictPlace place;
  Campus campus;  ///< the district alone
  Campus scene;   ///< the same with what its scans see of the districts around; instances are numbered over the city
  std::map<std::int32_t, CampusObject> objects;  ///< those of `scene`, by instance, in the frame of `campus`
};

/// A function of the parameters. It holds no district.
class City {
 public:
  explicit City(const CityParams& params);

  std::size_t size() const { return params_.columns * params_.rows; }
  const CityParams& params() const { return params_; }
  DistrictPlace placeOf(std::size_t number) const;
  /// Throws Error (InvalidArgument) for a number that is not there.
  District district(std::size_t number) const;
  /// The largest number of a district whose scans may see something of this one.
  std::size_t lastToSee(std::size_t number) const;

 private:
  std::vector<std::size_t> around(std::size_t number) const;
  Campus campusOf(std::size_t number) const;

  CityParams params_;
  CampusFrame frame_;  ///< of the whole city
  double pitch_m_;     ///< from a district to the next
  std::size_t reach_;  ///< how many districts away scans may see something
};

}  // namespace cluxel::simulation
