// SPDX-License-Identifier: Apache-2.0
// Puts blocks of data where the page has its mark.
#include "tasks/view/view_page.hpp"

#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/file_bytes.hpp"
#include "base/free_memory.hpp"
#include "cluxel/error.hpp"
#include "tasks/object_explanations.hpp"
#include "tasks/view/packed_quads.hpp"
#include "tasks/view/page_blocks.hpp"
#include "tasks/view/point_tiles.hpp"
#include "tasks/view/view_values.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::string_view kDataMark = "<!--map data-->";
constexpr std::size_t kReasonsInBlock = 64;  // read one block for a click, not all

double rounded(double value) {
  constexpr int digits = 6;  // the page shows three
  char text[32];
  const std::to_chars_result end =
      std::to_chars(std::begin(text), std::end(text), value, std::chars_format::general, digits);
  std::from_chars(std::begin(text), end.ptr, value);
  return value;
}

/// Rounds all numbers with a fraction, and leaves out margins, which the page computes: a third of the bytes.
void shorten(nlohmann::ordered_json& json) {
  if (json.is_number_float()) json = rounded(json.get<double>());
  if (json.is_object()) json.erase("margin");
  if (json.is_structured())
    for (nlohmann::ordered_json& member : json) shorten(member);
}

std::string shortened(std::string_view reasons) {
  auto json = nlohmann::ordered_json::parse(reasons);
  shorten(json);
  return json.dump();
}

std::uint64_t writeReasons(const mapping::MapReader& map, const ByteSink& out) {
  std::uint64_t written = 0;
  std::size_t blocks = 0, objects = 0;
  std::string lines;
  const auto write = [&] {
    written += writeBlock("reasons-" + std::to_string(blocks++), std::exchange(lines, {}), out);
  };
  forEachExplanation(map, [&](std::string_view reasons) {
    lines += shortened(reasons) + "\n";
    if (++objects % kReasonsInBlock == 0) write();
  });
  if (!lines.empty()) write();
  return written;
}

void writeData(const mapping::MapReader& map, const std::vector<Question>& questions, const ViewOptions& options,
               const ByteSink& out, ViewReport& report) {
  PointTiles tiles = pointTilesOf(map, options.max_points);
  PackedQuads quads = packedQuadsOf(map.quads(), options.max_quads);
  returnFreeMemory();
  report.points = tiles.points;
  report.points_in_map = tiles.points_in_map;
  report.objects = map.objectIds().size();
  report.quads = quads.quad_count;
  report.quads_left_out = quads.left_out;
  report.object_bytes = writeBlock("map", mapValuesJson(map, tiles, quads.left_out, options, questions), out) +
                        writeBlock("objects", objectValuesJson(map), out) +
                        writeBlock("changes", visitChangesJson(map, options.threads), out) +
                        writeBlock("lineage", lineageJson(map), out);
  for (std::size_t i = 0; i < tiles.tiles.size(); ++i)
    report.point_bytes += writeBlock("tile-" + std::to_string(i), std::exchange(tiles.tiles[i].planes, {}), out);
  report.quad_bytes = writeBlock("terms", std::exchange(quads.terms, {}), out) +
                      writeBlock("quads", std::exchange(quads.quads, {}), out);
  returnFreeMemory();  // reasons take much
  if (options.reasons) report.object_bytes += writeReasons(map, out);
}

/// What stands before the data. The policy of the page allows no connection; a served page may ask its service.
std::string headOf(const std::string& page, std::size_t mark, bool is_served) {
  constexpr std::string_view kPolicy = "default-src 'none'; ";
  std::string head = page.substr(0, mark);
  const std::size_t place = is_served ? head.find(kPolicy) : std::string::npos;
  if (place != std::string::npos) head.insert(place + kPolicy.size(), "connect-src 'self'; ");
  return head;
}

}  // namespace

std::string viewTemplate(const DataHome& home) {
  const std::filesystem::path file = std::filesystem::path("web") / "dist" / "page.html";
  std::error_code ignored;
  if (!home.root().empty() && !std::filesystem::exists(home.root() / file, ignored))
    throw Error(ErrorKind::FaultyInput, (home.root() / file).string() +
                                            ": the page's program is not there; './run web' in the checkout makes it "
                                            "(needs npm)");
  return readFile(home.locate(file));
}

ViewReport writeViewPage(const mapping::MapReader& map, const std::string& page, const std::vector<Question>& questions,
                         const ViewOptions& options, const ByteSink& out) {
  const std::size_t mark = page.find(kDataMark);
  if (mark == std::string::npos)
    throw Error(ErrorKind::FaultyInput, "the page's program has no mark '" + std::string(kDataMark) +
                                            "' for the map's data; './run web' in the checkout makes it anew");
  ViewReport report;
  report.program_bytes = page.size() - kDataMark.size();
  out(headOf(page, mark, options.is_served));
  writeData(map, questions, options, out, report);
  out(std::string_view(page).substr(mark + kDataMark.size()));
  return report;
}

}  // namespace cluxel::tasks
