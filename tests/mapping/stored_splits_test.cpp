// SPDX-License-Identifier: Apache-2.0
// Splits of crowns that a map stores serve the next run of reasoning over it.
#include <gtest/gtest.h>

#include "mapping/change/map_change.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/splits_store.hpp"
#include "rules/decide/reason.hpp"

namespace cluxel::mapping {
namespace {

TEST(StoredSplits, ServeWhatAChangeLeftAsItWas) {
  // The last scan sees less than the whole campus.
  const SmallCampus campus({.seed = 6, .stops = 4, .size_m = 160, .points_per_stop = 20000, .max_range_m = 35});
  const auto& files = campus.files();
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "campus.clx";
  const MapInputs inputs = shippedInputs();
  buildMap(scansOf({files[0], files[1], files[2]}), inputs, file, {}, silence());
  const rules::RuleSet rules = parseInputs(inputs).rules;
  const auto stored = [&] { return storedSplits(Environment::open(file, OpenMode::ReadOnly)->read()); };
  /// The splits of a run over the map as it is, with those of an earlier one at hand.
  const auto reasonWith = [&](KnownSplits known) {
    reason(MapReader(file).scene(), rules, {.splits = &known});
    return known;
  };

  const KnownSplits before = stored(), same = reasonWith(before);
  ASSERT_GE(same.count(), 2U);
  EXPECT_EQ(same.reused(), same.count());

  extendMap(file, scansOf({files[3]}), {}, silence());
  const KnownSplits changed = reasonWith(before), now = reasonWith(stored());
  EXPECT_GT(changed.reused(), 0U);
  EXPECT_LT(changed.reused(), changed.count());
  EXPECT_EQ(now.reused(), now.count());
  EXPECT_EQ(now.stored(), reasonWith({}).stored());
}

}  // namespace
}  // namespace cluxel::mapping
