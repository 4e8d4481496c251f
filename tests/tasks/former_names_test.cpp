// SPDX-License-Identifier: Apache-2.0
// Who asks for an object that has ended is told when and by what it ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::tasks {
namespace {

std::string faultOf(const mapping::MapReader& map, const std::string& name) {
  try {
    thingNamed(map, name);
    return "";
  } catch (const Error& fault) {
    return fault.what();
  }
}

TEST(FormerNames, OfWhatEndedTellWhenAndByWhat) {
  const mapping::SmallCampus campus({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 2500});
  const mapping::ScratchFolder folder;
  const auto file = folder.path() / "map.clx";
  const mapping::ScanSet scans = mapping::scansOf({campus.files()});
  mapping::buildMap(scans, mapping::shippedInputs(), file, {}, mapping::silence());
  mapping::retractScans(file, {scans.load(0).id}, {}, mapping::silence());
  const mapping::MapReader map(file);
  std::string gone;
  mapping::forEachHistoryLink(map.quads(), "wasInvalidatedBy",
                              [&](const Term& ended, const Term&) { gone = ended.text; });
  ASSERT_NE(gone, "") << "each object goes on";
  const std::string digits = gone.substr(gone.rfind('/') + 1);
  const mapping::Things things = mapping::storedThings(map.quads());
  const std::string thing = mapping::thingOf(things, ContentHash::fromHex(digits)).iri;
  for (const std::string& name : {gone, digits, "<" + gone + ">", digits.substr(0, 12)})
    EXPECT_THAT(faultOf(map, name), testing::AllOf(testing::HasSubstr("object/" + digits + " ended at "),
                                                   testing::HasSubstr("by `retract`")));
  EXPECT_THAT(faultOf(map, thing), testing::HasSubstr("ended at "));
  EXPECT_THAT(faultOf(map, "object/00000000000000000000000000000000"),
              testing::HasSubstr("nothing in the map is named"));
}

}  // namespace
}  // namespace cluxel::tasks
