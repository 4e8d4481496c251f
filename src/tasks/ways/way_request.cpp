// SPDX-License-Identifier: Apache-2.0
// What names mean in a request for ways: classes, mobilities, places.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/finite_number.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/named_class.hpp"
#include "tasks/objects_of_class.hpp"
#include "tasks/ways/class_cells.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

namespace {

/// Which objects, and which cells, belong to a class or are of a mobility.
class ObjectSelector {
 public:
  explicit ObjectSelector(const mapping::MapReader& map) : map_(map), ontology_(ontologyViewOf(map.quads())) {}

  void mark(const std::string& name, std::vector<bool>& marked) const {
    const std::optional<rdf::Mobility> mobility = mobilityNamed(ontology_, name);
    if (!mobility) {
      for (const std::uint32_t i : objectsOfClass(map_, classNamed(map_, ontology_, name))) marked[i] = true;
      return;
    }
    const std::vector<std::string>& classes = map_.objectClasses();
    for (std::size_t i = 0; i < classes.size(); ++i) {
      const rdf::OntologyClass* known = ontology_.find(classes[i]);
      if (known != nullptr && known->mobility == mobility) marked[i] = true;
    }
  }

  /// Throws Error (NotFound) where there is nothing of it.
  LargeArray<std::uint8_t> cells(const std::string& name, const TerrainGrid& terrain,
                                 const std::vector<bool>& is_left_out) const {
    LargeArray<std::uint8_t> cells(terrain.frame.size(), 0);
    if (mobilityNamed(ontology_, name)) {
      std::vector<bool> marked(map_.objectIds().size(), false);
      mark(name, marked);
      for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
        for (const std::uint32_t thing : terrain.thingsIn(cell))
          if (thing != kUnnamedThing && marked[thing] && !is_left_out[thing]) cells[cell] = 1;
    } else {
      const std::string iri = classNamed(map_, ontology_, name);
      const bool is_surface = ontology_.isA(iri, rdf::vocabulary::clx("Surface"));  // one walks on it
      cells = is_surface ? terrain.seen : cellsWith(map_, terrain, iri, is_left_out);
    }
    if (std::find(cells.begin(), cells.end(), 1) == cells.end())
      throw Error(ErrorKind::NotFound, "the map holds nothing of " + name + " that a way could stay near");
    return cells;
  }

 private:
  const mapping::MapReader& map_;
  rdf::OntologyView ontology_;
};

Eigen::Vector2d centroidOf(const mapping::MapReader& map, const std::string& iri) {
  const rdf::QuadReader& quads = map.quads();
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  for (const int axis : {0, 1}) {
    rdf::QuadPattern pattern;
    pattern.s = quads.idOf(Term::iri(iri));
    pattern.p = quads.idOf(Term::iri(rdf::vocabulary::clx(axis == 0 ? "x" : "y")));
    rdf::QuadIds quad;
    if (!pattern.s || !pattern.p || !quads.scan(pattern).next(quad))
      throw Error(ErrorKind::NotFound, "the map says no position of <" + iri + ">");
    place[axis] = quads.valueOf(quad.o).number;
  }
  return place;
}

}  // namespace

std::vector<bool> leftOut(const mapping::MapReader& map, const WayRequest& request) {
  std::vector<bool> is_left_out(map.objectIds().size(), false);
  if (!request.with_gone) is_left_out = goneAmong(map);
  if (request.without.empty()) return is_left_out;
  const ObjectSelector selector(map);
  for (const std::string& name : request.without) selector.mark(name, is_left_out);
  return is_left_out;
}

TerrainGrid terrainIn(const mapping::MapReader& map, const WayRequest& request) {
  return terrainOf(map, request.terrain, leftOut(map, request));
}

PassableGrid passableIn(const mapping::MapReader& map, const WayRequest& request) {
  return passableIn(map, terrainIn(map, request), request);
}

PassableGrid passableIn(const mapping::MapReader& map, const TerrainGrid& terrain, const WayRequest& request) {
  LargeArray<std::uint8_t> near;
  const std::vector<bool> is_left_out = leftOut(map, request);
  if (!request.near.empty()) near = ObjectSelector(map).cells(request.near, terrain, is_left_out);
  return passableOf(terrain, request.params, is_left_out, near);
}

Eigen::Vector2d placeNamed(const mapping::MapReader& map, const std::string& text) {
  constexpr std::size_t min_digits = 4;
  const std::size_t comma = text.find(',');
  if (comma != std::string::npos) {
    const auto x = finiteNumber(std::string_view(text).substr(0, comma));
    const auto y = finiteNumber(std::string_view(text).substr(comma + 1));
    if (x && y) return {*x, *y};
    throw Error(ErrorKind::InvalidArgument, "'" + text + "': write a place as X,Y in metres of the map frame");
  }
  const bool is_bracketed = text.starts_with('<') && text.ends_with('>');
  const std::string name = is_bracketed ? text.substr(1, text.size() - 2) : text;
  const std::size_t slash = name.rfind('/');
  const std::string path = slash == std::string::npos ? std::string() : name.substr(0, slash + 1);
  const bool is_of_object =
      path.empty() || path == "object/" || path == "map:object/" || path == rdf::mapIri("object", "");
  const std::string digits = is_of_object ? name.substr(path.size()) : std::string();
  std::vector<std::string> found;
  for (std::size_t i = 0; i < map.objectIds().size(); ++i) {
    const ContentHash& id = map.objectIds()[i];
    if (text == "#" + std::to_string(i) || (digits.size() >= min_digits && id.hex().starts_with(digits)))
      found.push_back(rdf::iriOfObject(id));
  }
  if (found.size() == 1) return centroidOf(map, found.front());
  throw Error(ErrorKind::NotFound,
              "'" + text + "' names " + (found.empty() ? "no object" : "more than one object") +
                  " of the map; write X,Y in metres, at least four digits of an object's hash, or # and its number");
}

}  // namespace cluxel::tasks
