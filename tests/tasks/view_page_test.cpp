// SPDX-License-Identifier: Apache-2.0
// Points, quads, objects and reasons that are read back from a page equal those of its map.
#include "tasks/view/view_page.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/explanation.hpp"
#include "tasks/view/page_blocks.hpp"
#include "tasks/view/point_tiles.hpp"

namespace cluxel::tasks {
namespace {

using ViewDocument = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kEmptyPage = "<html><head></head><!--map data--><body>end</body></html>";

std::string pageOf(const ViewOptions& options, ViewReport* report = nullptr) {
  std::string text;
  const ViewReport made =
      writeViewPage(CampusMap::shared().map(), kEmptyPage, shippedQuestions(DataHome(test::sourceFolder())), options,
                    [&text](std::string_view piece) { text.append(piece); });
  if (report != nullptr) *report = made;
  return text;
}

const std::string& wholePage() {
  static const std::string page = pageOf({.name = "campus"});
  return page;
}

std::string fromBase64(std::string_view text) {
  static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((count += 6) >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 0xffU));
  }
  return bytes;
}

std::string unzipped(const std::string& packed) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + 15), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string bytes;
  std::array<char, 65536> piece{};
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = piece.size();
    state = inflate(&stream, Z_NO_FLUSH);
    bytes.append(piece.data(), piece.size() - stream.avail_out);
  }
  EXPECT_EQ(state, Z_STREAM_END);
  inflateEnd(&stream);
  return bytes;
}

std::string blockOf(const std::string& page, const std::string& name) {
  const std::string opening = "id=\"" + name + "\">";
  const std::size_t at = page.find(opening), begin = at + opening.size();
  if (at == std::string::npos) return {};
  return unzipped(fromBase64(std::string_view(page).substr(begin, page.find('<', begin) - begin)));
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// A point of the page: millimetres in the map, and the number of its object + 1.
using PagePoint = std::array<std::int64_t, 4>;
/// Rounded to the page's quantum, in its units.
std::int64_t inQuanta(double metres) {
  return std::llround(metres / kViewQuantum_m);
}

std::vector<PagePoint> pagePoints(const std::string& page) {
  const ViewDocument map = ViewDocument::parse(blockOf(page, "map"));
  std::vector<PagePoint> points;
  for (std::size_t t = 0; t < map.at("tiles").size(); ++t) {
    const ViewDocument& tile = map.at("tiles")[t];
    const std::string planes = blockOf(page, "tile-" + std::to_string(t));
    const std::size_t count = tile.at("pointsTo").back();
    EXPECT_EQ(planes.size(), 14 * count);
    const auto value = [&](std::size_t plane, std::size_t bytes, std::size_t i) {
      std::uint32_t number = 0;
      for (std::size_t k = 0; k < bytes; ++k)
        number |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(planes[(plane + k) * count + i])) << (8 * k);
      return number;
    };
    const auto place = [&](int axis, std::size_t i) {
      const double quantum = axis == 2 ? tile.at("zQuantum").get<double>() : kViewQuantum_m;
      return inQuanta(tile.at("origin")[axis].get<double>() + quantum * value(2 * axis, 2, i));
    };
    for (std::size_t i = 0; i < count; ++i) points.push_back({place(0, i), place(1, i), place(2, i), value(6, 3, i)});
  }
  std::sort(points.begin(), points.end());
  return points;
}

TEST(CampusMapPage, HoldsEveryPointInItsPlaceWithItsObject) {
  const MapReader& map = CampusMap::shared().map();
  std::vector<PagePoint> expected;
  for (const Cloud& cloud : map.clouds()) {
    const ScanPoints points = map.pointsOf(cloud.id);
    const PointAnswers answers = map.answersFor(cloud);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
      const std::int64_t object = answers.object[i] == kNoObjectOfPoint ? 0 : answers.object[i] + 1;
      expected.push_back({inQuanta(p.x()), inQuanta(p.y()), inQuanta(p.z()), object});
    }
  }
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(pagePoints(wholePage()), expected);
}

TEST(CampusMapPage, HoldsTheQuadsOfAllGraphsButHistory) {
  const std::vector<std::string> terms = linesOf(blockOf(wholePage(), "terms"));
  const std::string bytes = blockOf(wholePage(), "quads");
  std::size_t at = 0;
  const auto number = [&] {
    std::uint64_t value = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = static_cast<std::uint8_t>(bytes.at(at++));
      value |= static_cast<std::uint64_t>(byte & 0x7fU) << shift;
      if (byte < 0x80U) return value;
    }
  };
  std::vector<std::string> lines;
  while (at < bytes.size()) {
    const std::string graph = terms.at(number());
    std::uint64_t subject = 0;
    for (std::uint64_t left = number(); left > 0; --left) {
      subject += number();
      const std::string predicate = terms.at(number()), object = terms.at(number());
      lines.push_back(terms.at(subject) + " " + predicate + " " + object + " " + graph + " .\n");
    }
  }
  std::sort(lines.begin(), lines.end());
  std::vector<std::string> expected;
  writeSortedNQuads(
      CampusMap::shared().map().quads(), [&](std::string_view line) { expected.emplace_back(line); },
      [](const Term& graph) { return graph.text != vocabulary::kGraphHistory; });
  EXPECT_EQ(lines, expected);
}

/// The page's reasons have six digits and no margins.
void expectShortened(const ViewDocument& shown, const ViewDocument& whole) {
  if (whole.is_number_float()) {
    const double value = whole.get<double>();
    EXPECT_NEAR(shown.get<double>(), value, 5e-6 * std::abs(value));
  } else if (whole.is_object()) {
    EXPECT_EQ(shown.size(), whole.size() - whole.count("margin")) << whole;
    for (const auto& [key, value] : whole.items())
      if (key != "margin") expectShortened(shown.at(key), value);
  } else if (whole.is_array()) {
    ASSERT_EQ(shown.size(), whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i) expectShortened(shown[i], whole[i]);
  } else {
    EXPECT_EQ(shown, whole);
  }
}

TEST(CampusMapPage, HoldsTheExplanationThatTheObjectHas) {
  const MapReader& map = CampusMap::shared().map();
  std::vector<std::string> reasons;
  for (std::size_t block = 0; reasons.size() < map.objects().size(); ++block)
    for (const std::string& line : linesOf(blockOf(wholePage(), "reasons-" + std::to_string(block))))
      reasons.push_back(line);
  ASSERT_EQ(reasons.size(), map.objects().size());
  std::set<std::string> told;
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (!told.insert(map.objects()[i].class_iri).second) continue;
    ViewDocument expected = ViewDocument::parse(explainThing(map, "#" + std::to_string(i), true));
    expected.erase("number");
    expected.erase("thing");  // history, which a page does not tell
    expectShortened(ViewDocument::parse(reasons[i]), expected);
  }
}

TEST(CampusMapPage, IsTheSameForTheSameMap) {
  EXPECT_EQ(pageOf({.name = "campus"}), wholePage());
}

TEST(CampusMapPage, OfALargeMapHoldsAnEvenSample) {
  const std::uint64_t all = pagePoints(wholePage()).size(), expected = all / 4;
  ViewReport report;
  const std::string page = pageOf({.name = "campus", .max_points = expected, .reasons = false}, &report);
  EXPECT_EQ(report.points_in_map, all);
  EXPECT_EQ(report.points, pagePoints(page).size());
  EXPECT_NEAR(static_cast<double>(report.points), static_cast<double>(expected), 0.03 * static_cast<double>(expected));
  EXPECT_EQ(blockOf(page, "reasons-0"), "");
  std::vector<PagePoint> beyond;
  const std::vector<PagePoint> some = pagePoints(page), whole = pagePoints(wholePage());
  std::set_difference(some.begin(), some.end(), whole.begin(), whole.end(), std::back_inserter(beyond));
  EXPECT_TRUE(beyond.empty()) << "a sample has no points of its own";
}

TEST(CampusMapPage, OfAMapWithManyQuadsLeavesOutPrimitives) {
  ViewReport whole, some;
  pageOf({.name = "campus", .reasons = false}, &whole);
  const std::string page = pageOf({.name = "campus", .max_quads = whole.quads - 1, .reasons = false}, &some);
  EXPECT_EQ(whole.quads_left_out, 0U);
  EXPECT_GT(some.quads_left_out, 0U);
  EXPECT_EQ(some.quads + some.quads_left_out, whole.quads);
  EXPECT_EQ(ViewDocument::parse(blockOf(page, "map")).at("quadsLeftOut"), some.quads_left_out);
  EXPECT_THAT(blockOf(page, "terms"), HasSubstr("/map/object/"));
}

TEST(CampusMapPage, LetsNoTextOfTheMapBecomeMarkup) {
  const std::string page = pageOf({.name = "</script><script>alert(1)</script>"});
  EXPECT_THAT(page, Not(HasSubstr("alert")));
  EXPECT_EQ(ViewDocument::parse(blockOf(page, "map")).at("name"), "</script><script>alert(1)</script>");
  EXPECT_TRUE(page.starts_with("<html><head></head><script type=") && page.ends_with("<body>end</body></html>"));
}

TEST(CampusMapPage, MayAskTheServiceThatItComesFromAndOtherwiseNobody) {
  const std::string policy = "default-src 'none'; script-src 'x'";
  const auto page = [&](bool is_served) {
    std::string text;
    writeViewPage(CampusMap::shared().map(), policy + kEmptyPage, {},
                  {.name = "m", .reasons = false, .is_served = is_served},
                  [&text](std::string_view piece) { text.append(piece); });
    return text;
  };
  EXPECT_TRUE(page(false).starts_with(policy));
  EXPECT_TRUE(page(true).starts_with("default-src 'none'; connect-src 'self'; script-src 'x'"));
  EXPECT_EQ(ViewDocument::parse(blockOf(page(true), "map")).at("served"), true);
  EXPECT_EQ(ViewDocument::parse(blockOf(page(false), "map")).at("served"), false);
}

TEST(CampusMapPage, HoldsTheTasksAndTheRulesOfTheMap) {
  const ViewDocument map = ViewDocument::parse(blockOf(wholePage(), "map"));
  const auto questions = shippedQuestions(DataHome(test::sourceFolder()));
  EXPECT_EQ(map.at("tasks"), ViewDocument::parse(taskListJson(tasksOf(questions))));
  const auto inputs = CampusMap::shared().map().inputs();
  ASSERT_EQ(map.at("rules").size(), inputs.rules.size());
  for (std::size_t i = 0; i < inputs.rules.size(); ++i) EXPECT_EQ(map.at("rules")[i].at("text"), inputs.rules[i].text);
}

TEST(CampusMapPage, TellsClassesOfWhichTheMapHasOneObjectOverAllOfIt) {
  const ViewDocument classes = ViewDocument::parse(blockOf(wholePage(), "objects")).at("classes");
  std::set<std::string> whole;
  for (const ViewDocument& one : classes)
    if (one.value("whole", false)) whole.insert(one.at("iri"));
  EXPECT_EQ(whole, std::set<std::string>{vocabulary::clx("Ground")});
}

TEST(CampusMapPage, NeedsThePagesProgram) {
  const auto write = [](const std::string& page) {
    writeViewPage(CampusMap::shared().map(), page, {}, {}, [](std::string_view) {});
  };
  EXPECT_THROW(write("<html></html>"), Error);
  ScratchFolder folder;
  try {
    viewTemplate(DataHome(folder.path()));
    ADD_FAILURE() << "an absent program was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("./run web"));
  }
}

TEST(PageBlocks, PackBytesThatComeBack) {
  for (const std::size_t size : {0U, 1U, 2U, 3U, 1000U}) {
    std::string bytes;
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<char>(i * 37));
    std::string element;
    writeBlock("x", bytes, [&element](std::string_view piece) { element.append(piece); });
    EXPECT_EQ(blockOf(element, "x"), bytes);
  }
}

}  // namespace
}  // namespace cluxel::tasks
