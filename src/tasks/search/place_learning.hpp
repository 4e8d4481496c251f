// SPDX-License-Identifier: Apache-2.0
// Usual places learned by counting in maps: how often objects of a class stand near objects of another.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

struct PlaceLearningParams {
  std::vector<double> distances_m{3, 6, 12, 25};  ///< candidates for `within`
  double pseudo_count = 1;                        ///< spread over the places and "anywhere" (Laplace smoothing)
  double least_probability = 0.03;                ///< places that explain less are left out
  std::size_t least_objects = 5;                  ///< a class with fewer objects is left out
  double cell_m = 0.5;
};

struct LearnedPlace {
  std::string class_iri, near_class;
  double within_m = 0, probability = 0;
  std::size_t objects = 0, near = 0;  ///< of the class: in all, and within the distance of one of the other
  double ground_share = 0;            ///< of the observed ground that lies within the distance, mean over the maps
};

/// Collects maps, then learns. What is kept of a map is, for each object and each candidate place, whether the object
/// stands there.
class PlaceLearner {
 public:
  explicit PlaceLearner(PlaceLearningParams params = {}) : params_(std::move(params)) {}
  void add(const mapping::MapReader& map);
  /// A mixture for each class: an object comes from one of the places (evenly over its observed ground), or from
  /// anywhere. Its weights are the most probable ones, by expectation maximisation from even weights; the likelihood
  /// has one maximum. By class, most probable first.
  std::vector<LearnedPlace> learn() const;
  std::size_t maps() const { return maps_; }

 private:
  struct Candidate {
    std::string near_class;
    double within_m = 0;
    auto operator<=>(const Candidate&) const = default;
  };
  /// One object of a class: how dense each place is in which it stands, in units of "anywhere".
  struct Example {
    std::map<Candidate, double> density;
  };
  struct Ground {
    double sum = 0;
    std::size_t maps = 0;
  };

  std::vector<LearnedPlace> learnClass(const std::string& class_iri, const std::vector<Example>& examples) const;
  std::map<Candidate, double> weightsOf(const std::vector<Example>& examples,
                                        const std::vector<Candidate>& candidates) const;

  PlaceLearningParams params_;
  std::map<std::string, std::vector<Example>> examples_;  ///< by class
  std::map<Candidate, Ground> ground_;
  std::size_t maps_ = 0;
};

/// Turtle with one clx:UsualPlace for each, and the counts as comments.
std::string placesTurtle(const std::vector<LearnedPlace>& places, std::size_t maps);

}  // namespace cluxel::tasks
