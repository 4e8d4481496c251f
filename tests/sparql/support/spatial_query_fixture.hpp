// SPDX-License-Identifier: Apache-2.0
// Random spatial queries over a small town, each with its answer by brute force.
#pragma once

#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "cluxel/term.hpp"

namespace cluxel::test {

/// A point or an axis-parallel box.
struct Patch {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  std::string wkt() const;
  double distanceTo(const Patch& other) const;
  bool meets(const Patch& other) const { return distanceTo(other) == 0; }
};

struct Thing {
  std::string name;  ///< as shown by SmallStore::rows()
  int kind = 0;
  std::vector<Patch> patches;
};

/// Things of three kinds; some share a geometry, some have two.
struct Town {
  std::vector<Thing> things;
  std::vector<Quad> quads;
};

/// `strange`: geometries and numbers that are missing, malformed, empty, of other datatypes or reference systems.
/// Their answers depend on the functions, so that brute force does not know them.
Town madeTown(std::uint32_t seed, int count, bool strange);

struct SpatialQuery {
  std::string family, text;
  /// The expected rows of the whole answer, sorted; with `limit`, of the answer without its LIMIT and OFFSET.
  std::vector<std::string> rows;
  bool is_ordered = false;  ///< the order and the rows up to ties are checked by the comparison of plans
};

class SpatialQueryMaker {
 public:
  SpatialQueryMaker(const Town& town, std::uint32_t seed) : town_(town), random_(seed) {}
  SpatialQuery next();
  /// ORDER BY distance LIMIT k.
  SpatialQuery nearestFirst();

 private:
  using Pair = std::function<bool(const Thing&, const Patch&, const Thing&, const Patch&)>;
  int upTo(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  std::string number(double value) const;
  double limit() { return upTo(12) + 0.3; }
  Patch somewhere();
  std::string literal(const Patch& patch) const;
  std::string shuffled(std::vector<std::string> parts);
  std::string within(const std::string& a, const std::string& b, double limit_m);
  std::vector<std::string> thing(const std::string& name, int kind);
  std::vector<std::string> pairs(int kind_a, int kind_b, const Pair& test) const;
  double nearestOf(const Patch& from, int kind, const std::string& but) const;

  SpatialQuery pairWithin();
  SpatialQuery pairRelated();
  SpatialQuery boundThing();
  SpatialQuery placesOfValues();
  SpatialQuery oneOfPlaces();
  SpatialQuery nearestByAbsence();
  SpatialQuery nearestByMinimum();
  SpatialQuery nearestByCount();
  SpatialQuery lonely();
  SpatialQuery optionalNeighbour();
  SpatialQuery numberBand();
  SpatialQuery boxesOfNumbers();

  const Town& town_;
  std::mt19937 random_;
};

}  // namespace cluxel::test
