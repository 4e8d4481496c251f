// SPDX-License-Identifier: Apache-2.0
// A map of a small generated campus, built by the facade once a process.
#pragma once

#include "cluxel/cluxel.hpp"
#include "mapping/small_campus.hpp"
#include "test_paths.hpp"

namespace cluxel {

class CountingSink : public ProgressSink {
 public:
  void progress(std::string_view, std::size_t, std::size_t) override { ++calls; }
  std::size_t calls = 0;
};

struct FacadeCampus {
  static FacadeCampus& shared() {
    static FacadeCampus campus;
    return campus;
  }
  static BuildOptions options() {
    BuildOptions options;
    options.home = test::sourceFolder();
    options.model = "campus";
    options.threads = 2;
    return options;
  }
  /// A copy of the map that a test may change.
  Map copyIn(const std::filesystem::path& folder) const {
    std::filesystem::copy_file(map.file(), folder / "copy.clx");
    return Map::open(folder / "copy.clx");
  }

  mapping::SmallCampus campus{simulation::CampusParams{.seed = 3, .stops = 3, .size_m = 50, .points_per_stop = 25'000}};
  rdf::ScratchFolder folder;
  CountingSink sink;
  Map map = Map::build(campus.files(), folder.path() / "campus.clx", options(), sink);
};

}  // namespace cluxel
