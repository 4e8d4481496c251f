// SPDX-License-Identifier: Apache-2.0
// A generated street of several tiles, whose map the tests of a suite read.
#pragma once

#include <gtest/gtest.h>

#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

class StreetMap : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder();
    const SmallCampus campus({.seed = 7, .stops = 5, .size_m = 80, .points_per_stop = 5000, .max_range_m = 25});
    buildMap(scansOf(campus.files()), shippedInputs(), folder->path() / "street.clx", {}, silence());
    map = new MapReader(folder->path() / "street.clx");
  }
  static void TearDownTestSuite() {
    delete map;
    delete folder;
  }

  static inline ScratchFolder* folder = nullptr;
  static inline MapReader* map = nullptr;
};

}  // namespace cluxel::mapping
