// SPDX-License-Identifier: Apache-2.0
// Learned places of classes with one local name stay apart.
#include "tasks/search/place_learning.hpp"

#include <gtest/gtest.h>

#include <set>

#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {
namespace {

using rdf::vocabulary::clx;

/// The name of the place that a text of one place states.
std::string nameOfPlace(const std::string& class_iri, const std::string& near_class) {
  const std::string text = placesTurtle({{class_iri, near_class, 2.5, 0.5, 4, 2, 0.1}}, 1);
  const std::size_t end = text.find(" a clx:UsualPlace"), begin = text.rfind('\n', end) + 1;
  return text.substr(begin, end - begin);
}

TEST(PlaceLearning, NamesPlacesByTheirClasses) {
  const std::string town = "http://t.example/town#", store = "http://t.example/store#";
  EXPECT_EQ(nameOfPlace(clx("Bench"), clx("Tree")), "clx:BenchWithin2_5mOfTree");
  std::set<std::string> names;
  for (const std::string& of : {clx("Tree"), town + "Tree", store + "Tree"})
    for (const std::string& near : {clx("Road"), town + "Road", store + "Road"}) {
      const std::string name = nameOfPlace(of, near);
      EXPECT_TRUE(names.insert(name).second) << name;
      EXPECT_EQ(name, nameOfPlace(of, near)) << "the same in every file";
    }
}

}  // namespace
}  // namespace cluxel::tasks
