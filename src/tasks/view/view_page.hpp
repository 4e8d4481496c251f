// SPDX-License-Identifier: Apache-2.0
// A map as one HTML page that needs no server: points, objects, quads and reasons beside the page's own program.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/export/map_export.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::tasks {

struct ViewOptions {
  std::string name;                      ///< of the map, shown as the page's title
  std::uint64_t max_points = 5'000'000;  ///< a larger map is shown by a uniform sample, and the page says so
  std::uint64_t max_quads = 2'000'000;   ///< a larger map is held without the quads about primitives
  bool reasons = true;                   ///< with the explanation of every object
  bool is_served = false;                ///< the page may ask the service that it comes from
  unsigned threads = 1;                  ///< for the changes between visits
};

/// What a page was made of.
struct ViewReport {
  std::uint64_t points = 0, points_in_map = 0;
  std::size_t objects = 0;
  std::uint64_t quads = 0, quads_left_out = 0;
  std::uint64_t program_bytes = 0, point_bytes = 0, quad_bytes = 0, object_bytes = 0;
};

/// The page without a map, as `./run web` makes it. Throws Error (FaultyInput) with the remedy when it is absent.
std::string viewTemplate(const DataHome& home);

/// Writes the page in pieces. `page` is viewTemplate(). The same map and options give the same bytes. Throws Error
/// (FaultyInput) when `page` has no place for the data.
ViewReport writeViewPage(const mapping::MapReader& map, const std::string& page, const std::vector<Question>& questions,
                         const ViewOptions& options, const ByteSink& out);

}  // namespace cluxel::tasks
