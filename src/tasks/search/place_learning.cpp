// SPDX-License-Identifier: Apache-2.0
// Counts objects near objects, and explains them by a mixture of places.
#include "tasks/search/place_learning.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/regions/whole_objects.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/named_class.hpp"
#include "tasks/objects_of_class.hpp"
#include "tasks/search/search_field.hpp"
#include "tasks/ways/class_cells.hpp"
#include "tasks/ways/passable_grid.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

namespace {

struct PlacedObject {
  std::uint32_t number = 0;  ///< in MapReader::objects()
  std::string class_iri;
  Eigen::Vector2d at;
};

std::vector<PlacedObject> placedObjects(const mapping::MapReader& map, const rdf::OntologyView& ontology) {
  const std::vector<std::string>& classes = map.objectClasses();
  std::vector<bool> is_thing;
  for (const std::string& class_iri : classes)
    is_thing.push_back(!ontology.isA(class_iri, rdf::vocabulary::clx("Surface")));
  std::vector<PlacedObject> placed;
  mapping::forEachWholeObject(map, is_thing, [&](const mapping::WholeObject& whole) {
    const auto cluxels = mapping::cluxelsOf(whole.object);
    placed.push_back(
        {whole.number, classes[whole.number], mapping::geometryOf(whole.cluxels, cluxels).centroid.head<2>()});
  });
  std::sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return placed;
}

/// The cells of a class, and which objects are of it.
struct NearClass {
  std::vector<bool> is_of_class;
  NearestMarked nearest;
};

constexpr double kNowhere_m = std::numeric_limits<double>::infinity();

/// The distance from an object to the nearest other one of the class [m].
double toNextOfClass(const NearClass& near, const std::vector<PlacedObject>& objects, std::size_t self) {
  double nearest = kNowhere_m;
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (i != self && near.is_of_class[objects[i].number])
      nearest = std::min(nearest, (objects[i].at - objects[self].at).norm());
  return nearest;
}

/// From an object to the nearest other thing of a class [m]. The cells of an object that is of the class itself are
/// marked by itself.
double distanceTo(const NearClass& near, const std::vector<PlacedObject>& objects, std::size_t self,
                  const TerrainGrid& terrain) {
  if (near.is_of_class[objects[self].number]) return toNextOfClass(near, objects, self);
  const auto cell = terrain.frame.cellAt(objects[self].at);
  if (!cell) return kNowhere_m;
  return static_cast<double>(near.nearest.distance[*cell]) * terrain.frame.cell_m;
}

/// The share of the observed ground whose distance [cells] to what is marked is at most `within`.
double groundShare(const TerrainGrid& terrain, const NearestMarked& nearest, double within) {
  std::size_t seen = 0, near = 0;
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell) {
    if (terrain.seen[cell] == 0) continue;
    ++seen;
    near += nearest.distance[cell] <= within ? 1 : 0;
  }
  return seen == 0 ? 0 : static_cast<double>(near) / static_cast<double>(seen);
}

std::string placeName(const LearnedPlace& place) {
  std::array<char, 32> distance{};
  std::snprintf(distance.data(), distance.size(), "%gm", place.within_m);
  std::string within = distance.data();
  std::replace(within.begin(), within.end(), '.', '_');
  return distinctName(place.class_iri) + "Within" + within + "Of" + distinctName(place.near_class);
}

std::string shortName(const std::string& iri) {
  return iri.starts_with(rdf::vocabulary::kClx) ? "clx:" + mapping::localName(iri) : "<" + iri + ">";
}

}  // namespace

void PlaceLearner::add(const mapping::MapReader& map) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  TerrainParams terrain_params;
  terrain_params.cell_m = params_.cell_m;
  const TerrainGrid terrain = terrainOf(map, terrain_params);
  const std::vector<PlacedObject> objects = placedObjects(map, ontology);
  const std::vector<bool> none_left_out(map.objectIds().size(), false);  // also what is gone now stood at its place
  ++maps_;
  std::vector<Example> examples(objects.size());
  std::set<std::string> near_classes;
  for (const PlacedObject& object : objects) near_classes.insert(object.class_iri);
  for (const rdf::OntologyClass& known : ontology.classes)
    if (ontology.isA(known.iri, rdf::vocabulary::clx("Place"))) near_classes.insert(known.iri);
  for (const std::string& near_class : near_classes) {
    NearClass near{std::vector<bool>(map.objectIds().size(), false), {}};
    for (const std::uint32_t object : objectsOfClass(map, near_class)) near.is_of_class[object] = true;
    near.nearest = nearestMarked(terrain.frame, cellsWith(map, terrain, near_class, near.is_of_class, none_left_out));
    std::vector<double> distance_m;
    for (std::size_t i = 0; i < objects.size(); ++i) distance_m.push_back(distanceTo(near, objects, i, terrain));
    for (const double within_m : params_.distances_m) {
      const double share = groundShare(terrain, near.nearest, within_m / params_.cell_m);
      if (share == 0) continue;
      const Candidate candidate{near_class, within_m};
      ground_[candidate].sum += share;
      ++ground_[candidate].maps;
      for (std::size_t i = 0; i < objects.size(); ++i)
        if (distance_m[i] <= within_m) examples[i].density[candidate] = 1 / share;
    }
  }
  for (std::size_t i = 0; i < objects.size(); ++i) examples_[objects[i].class_iri].push_back(std::move(examples[i]));
}

std::map<PlaceLearner::Candidate, double> PlaceLearner::weightsOf(const std::vector<Example>& examples,
                                                                  const std::vector<Candidate>& candidates) const {
  constexpr int rounds = 60;
  const double even = 1.0 / static_cast<double>(candidates.size() + 1), smoothing = params_.pseudo_count * even;
  const double total = static_cast<double>(examples.size()) + params_.pseudo_count;
  std::map<Candidate, double> weight;
  for (const Candidate& candidate : candidates) weight[candidate] = even;
  double anywhere = even;
  for (int round = 0; round < rounds; ++round) {
    std::map<Candidate, double> count;
    for (const Candidate& candidate : candidates) count[candidate] = smoothing;
    double count_anywhere = smoothing;
    for (const Example& example : examples) {
      double sum = anywhere;
      for (const auto& [candidate, density] : example.density)
        if (const auto w = weight.find(candidate); w != weight.end()) sum += w->second * density;
      for (const auto& [candidate, density] : example.density)
        if (const auto w = weight.find(candidate); w != weight.end()) count[candidate] += w->second * density / sum;
      count_anywhere += anywhere / sum;
    }
    for (auto& [candidate, w] : weight) w = count[candidate] / total;
    anywhere = count_anywhere / total;
  }
  return weight;
}

std::vector<LearnedPlace> PlaceLearner::learnClass(const std::string& class_iri,
                                                   const std::vector<Example>& examples) const {
  std::vector<Candidate> candidates;
  for (const auto& [candidate, ground] : ground_) candidates.push_back(candidate);
  std::map<Candidate, double> weight;
  // What explains less than two objects is left out, and the rest is weighed again until none is that weak.
  for (std::size_t before = 0; before != candidates.size();) {
    before = candidates.size();
    weight = weightsOf(examples, candidates);
    const double least = std::max(params_.least_probability, 2 / static_cast<double>(examples.size()));
    std::erase_if(candidates, [&](const Candidate& c) { return weight[c] < least; });
  }
  std::vector<LearnedPlace> places;
  for (const Candidate& candidate : candidates) {
    LearnedPlace place{class_iri, candidate.near_class, candidate.within_m, weight[candidate], examples.size(), 0, 0};
    for (const Example& example : examples) place.near += example.density.contains(candidate) ? 1 : 0;
    const Ground& ground = ground_.at(candidate);
    place.ground_share = ground.sum / static_cast<double>(ground.maps);
    places.push_back(std::move(place));
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  return places;
}

std::vector<LearnedPlace> PlaceLearner::learn() const {
  std::vector<LearnedPlace> all;
  for (const auto& [class_iri, examples] : examples_) {
    if (examples.size() < params_.least_objects) continue;
    const std::vector<LearnedPlace> places = learnClass(class_iri, examples);
    all.insert(all.end(), places.begin(), places.end());
  }
  return all;
}

std::string placesTurtle(const std::vector<LearnedPlace>& places, std::size_t maps) {
  std::string text = "# Usual places, learned by counting in " + std::to_string(maps) +
                     (maps == 1 ? " map.\n" : " maps.\n") +
                     "# Probability: the share of the objects that the place explains, after Laplace smoothing.\n"
                     "@prefix clx: <" +
                     std::string(rdf::vocabulary::kClx) + "> .\n";
  for (const LearnedPlace& place : places) {
    std::array<char, 512> line{};
    std::snprintf(
        line.data(), line.size(),
        "\n# %zu of %zu objects of class %s are within %g m of one of class %s; so is %.1f %% of the ground.\n",
        place.near, place.objects, mapping::localName(place.class_iri).c_str(), place.within_m,
        mapping::localName(place.near_class).c_str(), place.ground_share * 100);
    text += line.data();
    std::snprintf(line.data(), line.size(), "    clx:within %.1f ;\n    clx:probability %.4f .\n", place.within_m,
                  std::floor(place.probability * 1e4) / 1e4);
    text += "clx:" + placeName(place) + " a clx:UsualPlace ;\n    clx:usualFor " + shortName(place.class_iri) +
            " ;\n    clx:nearClass " + shortName(place.near_class) + " ;\n" + line.data();
  }
  return text;
}

}  // namespace cluxel::tasks
