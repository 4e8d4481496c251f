// SPDX-License-Identifier: Apache-2.0
// Tiles of points, read from the clouds when they are asked for.
#include <array>
#include <charconv>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"
#include "serve/resources/map_resources.hpp"
#include "tasks/view/point_tiles.hpp"

namespace cluxel::serve {

namespace {

constexpr const char* kTileSource = "point tiles";
constexpr std::int64_t kFarthestTile = 1'000'000'000;

std::int64_t tileNumber(const std::string& text) {
  std::int64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size() || std::abs(number) > kFarthestTile)
    throw Refusal(400,
                  "'" + text + "': a tile is named by two whole numbers, X/Y: its corner is at 16 m times X and Y");
  return number;
}

std::array<double, 2> intensityOf(const Parameters& parameters) {
  const auto text = valueOf(parameters, "intensity");
  if (!text) return {0, 1};
  const std::vector<double> range = numbersIn("intensity", *text);
  if (range.size() != 2) throw Refusal(400, "parameter intensity: write LOW,HIGH: the values of bytes 0 and 255");
  return {range[0], range[1]};
}

/// Kept with the commit, as long as somebody reads it.
std::shared_ptr<const tasks::PointTileSource> sourceOf(ServedMap& map, const mapping::MapReader& reader) {
  const auto make = [&reader] { return std::make_shared<const tasks::PointTileSource>(reader); };
  return std::static_pointer_cast<const tasks::PointTileSource>(map.keptOrMade(reader.quads(), kTileSource, make));
}

}  // namespace

HttpResponse answerPointTile(ServedMap& map, const ResourceRequest& asked, const std::string& x, const std::string& y) {
  const Parameters& parameters = asked.target.parameters;
  requireKnown(parameters, {"state", "intensity"});
  const tasks::ViewTileKey key{tileNumber(x), tileNumber(y)};
  const std::array<double, 2> intensity = intensityOf(parameters);
  const auto state = valueOf(parameters, "state");
  std::optional<tasks::PointTile> tile;
  map.withReader([&](const mapping::MapReader& reader) {
    const auto source = sourceOf(map, reader);
    if (state && *state != source->state())
      throw Refusal(409, "the map has changed since this state; load the page again");
    tile = source->tile(reader, key, intensity);
  });
  if (!tile) throw Refusal(404, "no point of the map lies in tile " + x + "/" + y);
  LimitedBody body(asked.limits.max_answer_bytes);
  body.add(tasks::tileBytes(*tile));
  return {200, "application/octet-stream", body.take(), {}};
}

}  // namespace cluxel::serve
