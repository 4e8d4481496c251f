// SPDX-License-Identifier: Apache-2.0
// The inventory of a generated campus against the truth of its generator, registers, and next views.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/file_bytes.hpp"
#include "mapping/change/map_change.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/search/next_view.hpp"
#include "tasks/search/place_learning.hpp"

namespace cluxel::tasks {
namespace {

/// The campus of CampusMap, made again for its truth.
const Campus& trueCampus() {
  static const Campus campus = buildCampus({.seed = 3, .stops = 4, .size_m = 60, .points_per_stop = 40'000});
  return campus;
}

struct SizeErrors {
  std::size_t truth = 0, found = 0;
  std::vector<double> height_m, crown_share;
};

SizeErrors errorsOf(const std::string& kind, const std::vector<InventoryItem>& items) {
  constexpr double same_m = 1.5;
  SizeErrors errors;
  for (const CampusObject& object : trueCampus().objects) {
    if (object.class_number < 0 || truthClassNames()[static_cast<std::size_t>(object.class_number)] != kind) continue;
    ++errors.truth;
    const InventoryItem* nearest = nullptr;
    double distance = same_m;
    for (const InventoryItem& item : items) {
      const double here = (item.at - object.position.head<2>()).norm();
      if (item.kind != kind || here > distance) continue;
      distance = here;
      nearest = &item;
    }
    if (nearest == nullptr) continue;
    ++errors.found;
    errors.height_m.push_back(std::abs(nearest->height_m - (object.box.max().z() - object.position.z())));
    if (kind == "Tree") errors.crown_share.push_back(std::abs(nearest->crown_m / (2 * object.reach_m) - 1));
  }
  return errors;
}

double medianOfErrors(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 1e300 : values[values.size() / 2];
}

TEST(QuestionsOfACampus, TheInventoryHasTheSizesOfTheGenerator) {
  const std::vector<InventoryItem> items = inventoryOf(CampusMap::shared().map(), {}).items;
  const std::map<std::string, std::size_t> least_found{{"StreetSign", 4}, {"StreetLamp", 5}, {"Tree", 12}};
  for (const auto& [kind, least] : least_found) {
    const SizeErrors errors = errorsOf(kind, items);
    std::printf("%s (generated): %zu of %zu found; median error of heights %.2f m", kind.c_str(), errors.found,
                errors.truth, medianOfErrors(errors.height_m));
    if (kind == "Tree") std::printf(", of crowns %.0f %%", medianOfErrors(errors.crown_share) * 100);
    std::printf("\n");
    EXPECT_GE(errors.found, least) << kind;
    EXPECT_LT(medianOfErrors(errors.height_m), 0.3) << kind;
    EXPECT_TRUE(kind != "Tree" || medianOfErrors(errors.crown_share) < 0.25);
  }
}

TEST(QuestionsOfACampus, TheInventoryHasTheWidthsOfSidewalks) {
  InventoryParams params{.classes = {}, .with_rows = false};
  const std::vector<InventoryItem> items = inventoryOf(CampusMap::shared().map(), params).items;
  constexpr double walk_m = 6.5 - 4.15;  // of the generator: from the kerb's stone to the outer edge
  double length_m = 0;
  for (const InventoryItem& item : items) {
    EXPECT_EQ(item.kind, "Sidewalk");
    EXPECT_NE(item.object, "");
    ASSERT_GE(item.line.size(), 2U);
    length_m += item.length_m;
    if (item.length_m >= 8) {
      EXPECT_NEAR(item.width_m, walk_m, 0.6);
    }
    std::printf("sidewalk (generated): %.1f m long, %.2f m wide\n", item.length_m, item.width_m);
  }
  EXPECT_GT(length_m, 8);
  params.with_sidewalks = false;
  EXPECT_TRUE(inventoryOf(CampusMap::shared().map(), params).items.empty());
}

TEST(QuestionsOfACampus, TheInventoryRefusesClassesWhoseThingsAreNoObjects) {
  const MapReader& map = CampusMap::shared().map();
  for (const char* kind : {"Way", "TreeTrunk", "Place"})
    EXPECT_THROW(inventoryOf(map, inventoryOfKinds(map, {kind})), Error) << kind;
  for (const char* kind : {"Object", "Sidewalk", "ParkingRow", "TrafficLight"})
    EXPECT_NO_THROW(inventoryOf(map, inventoryOfKinds(map, {kind}))) << kind;
}

TEST(QuestionsOfACampus, TheInventoryTellsWhichRulesOfPlacesAreMissing) {
  const auto notes = [](const MapReader& map) {
    std::string all;
    for (const std::string& note : inventoryAnswer(map, {.classes = {}}, {}).notes) all += note + "\n";
    return all;
  };
  EXPECT_EQ(notes(CampusMap::shared().map()).find("not listed"), std::string::npos);
  const ScratchFolder folder;
  const auto file = folder.path() / "bare.clx";
  std::filesystem::copy_file(CampusMap::shared().file(), file);
  ProgressSink silence;
  const auto without = [](MapInputs inputs) {
    inputs.sparql_rules.clear();
    return inputs;
  };
  applyInputs(file, without, {}, silence);
  EXPECT_NE(notes(MapReader(file)).find("parking rows and sidewalks are not listed"), std::string::npos);
}

/// The rows of a register in the map, by status; each is named by its class and place.
std::map<std::string, std::vector<std::string>> statusesOf(const std::string& name, const std::string& text,
                                                           const InventoryParams& params = {}) {
  const MapReader& map = CampusMap::shared().map();
  const ScratchFolder folder;
  writeFile(folder.path() / name, text);
  const auto entries = readRegister(folder.path() / name, map.inputs(), ontologyViewOf(map.quads()));
  std::map<std::string, std::vector<std::string>> found;
  for (const TaskRow& row : registerAnswer(map, params, entries, {.within_m = 0.5}).rows)
    found[std::get<std::string>(row.cells[0])].push_back(std::get<std::string>(row.cells[3]) + " at " +
                                                         std::to_string(std::get<double>(row.cells[4])) + ", " +
                                                         std::to_string(std::get<double>(row.cells[5])));
  return found;
}

/// The line of an entry.
std::string lineFor(const std::string& class_name, const Eigen::Vector2d& at) {
  return class_name + "," + std::to_string(at.x()) + "," + std::to_string(at.y()) + "\n";
}

TEST(QuestionsOfACampus, ARegisterOfTheMapItselfMatchesWhole) {
  const MapReader& map = CampusMap::shared().map();
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "register.csv";
  std::vector<InventoryItem> items;
  for (const InventoryItem& item : inventoryOf(map, {}).items)
    if (!item.object.empty()) items.push_back(item);
  ASSERT_GE(items.size(), 10U);
  std::string text = "id,class,x,y,height\n";
  for (std::size_t i = 1; i < items.size(); ++i)  // the first is not in it
    text += "no " + std::to_string(i) + "," + items[i].kind + "," + std::to_string(items[i].at.x()) + "," +
            std::to_string(items[i].at.y()) + "," +
            (std::isnan(items[i].height_m) ? "" : std::to_string(items[i].height_m - 0.5)) + "\n";
  text += "far,StreetSign,5000,5000,\nnear,UtilityPole," + std::to_string(items[1].at.x() + 4) + "," +
          std::to_string(items[1].at.y()) + ",\n";
  writeFile(file, text);
  const auto entries = readRegister(file, map.inputs(), ontologyViewOf(map.quads()));
  ASSERT_EQ(entries.size(), items.size() + 1);
  const auto things = registerItems(map, {.with_rows = false}, entries).items;
  ASSERT_EQ(things.size(), items.size());
  const auto rows = compareWith(entries, things, {.within_m = 1});
  std::map<RegisterStatus, std::size_t> counts;
  for (const RegisterRow& row : rows) ++counts[row.status];
  EXPECT_EQ(counts[RegisterStatus::Matched], items.size() - 1);
  EXPECT_EQ(counts[RegisterStatus::NotInRegister], 1U);
  EXPECT_EQ(counts[RegisterStatus::NotObserved], 2U);
  const TaskAnswer answer = registerAnswer(map, {}, entries, {.within_m = 1});
  EXPECT_EQ(std::get<std::string>(answer.rows[0].cells[0]), "matched");
  EXPECT_NEAR(std::get<double>(answer.rows[0].cells[7]), 0.5, 1e-3);
}

TEST(QuestionsOfACampus, AnInventoryIsARegisterOfItsMapInEveryFormat) {
  const MapReader& map = CampusMap::shared().map();
  const TaskAnswer inventory = inventoryAnswer(map, {});
  const auto is_line = [](const TaskRow& row) { return row.shape.kind == TaskShape::Kind::Line; };
  ASSERT_GE(std::count_if(inventory.rows.begin(), inventory.rows.end(), is_line), 1) << "a sidewalk";
  for (const auto& [name, format] :
       {std::pair("full.csv", AnswerFormat::Csv), {"full.geojson", AnswerFormat::GeoJson}}) {
    const auto found = statusesOf(name, answerText(map, inventory, format, ExportFrame::Local));
    ASSERT_EQ(found.size(), 1U) << name << ": " << found.begin()->first << " " << found.begin()->second.front();
    EXPECT_EQ(found.at("matched").size(), inventory.rows.size()) << name;
  }
}

TEST(QuestionsOfACampus, EntriesOfClassesThatAreNotListedAreLookedForAll) {
  const MapReader& map = CampusMap::shared().map();
  std::string text = "class,x,y\n";
  std::size_t entries = 0;
  for (const InventoryItem& item : inventoryOf(map, {.classes = {"Building", "Vehicle", "Barrier"}}).items) {
    if (item.kind == "ParkingRow" || item.kind == "Sidewalk") continue;
    text += lineFor(item.kind, item.at), ++entries;
  }
  const std::size_t objects = entries;
  ASSERT_GE(objects, 3U);
  const auto derived =
      evaluateQuery(map.quads(), "PREFIX clx: <" + std::string(vocabulary::kClx) +
                                     "> SELECT DISTINCT ?x ?y { ?way a clx:Way ; clx:x ?x ; clx:y ?y }")
          .table;
  for (std::size_t row = 0; row < derived.row_count; ++row, ++entries)
    text += lineFor("Way", {numberAt(derived, row, "x"), numberAt(derived, row, "y")});
  ASSERT_GT(entries, objects);
  const auto found =
      statusesOf("other.csv", text, {.classes = {"StreetLamp"}, .with_rows = false, .with_sidewalks = false});
  ASSERT_TRUE(found.contains("matched"));
  EXPECT_EQ(found.at("matched").size(), entries);
  EXPECT_FALSE(found.contains("missing in the map")) << found.at("missing in the map").front();
  ASSERT_TRUE(found.contains("not in the register"));
  for (const std::string& row : found.at("not in the register")) EXPECT_TRUE(row.starts_with("StreetLamp at")) << row;
}

TEST(QuestionsOfACampus, ARegisterWritesClassesAsOtherPlacesDo) {
  const MapReader& map = CampusMap::shared().map();
  const InventoryParams signs{.classes = {"StreetSign"}, .with_rows = false, .with_sidewalks = false};
  const std::vector<InventoryItem> items = inventoryOf(map, signs).items;
  ASSERT_GE(items.size(), 4U);
  for (const std::string& written : {std::string("street sign"), std::string("clx:StreetSign"),
                                     vocabulary::clx("StreetSign"), std::string("StreetFurniture")}) {
    std::string text = "kind,x,y\n";
    for (const InventoryItem& item : items) text += lineFor(written, item.at);
    const auto found = statusesOf("signs.csv", text, signs);
    ASSERT_EQ(found.size(), 1U) << written;
    EXPECT_EQ(found.begin()->first, "matched") << written;
  }
}

TEST(Register, FaultsNameTheirLine) {
  const ScratchFolder folder;
  OntologyView ontology;
  ontology.classes.emplace_back().iri = vocabulary::clx("Tree");
  const auto refusal = [&](const std::string& name, const std::string& text) -> std::string {
    writeFile(folder.path() / name, text);
    try {
      readRegister(folder.path() / name, {}, ontology);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  };
  EXPECT_EQ(refusal("good.csv", "class,x,y\nTree,1,2\r\n\n\"Tree\",3,4\n"), "read");
  EXPECT_NE(refusal("head.csv", "class,easting\n").find(":1:1"), std::string::npos);
  EXPECT_NE(refusal("number.csv", "class,x,y\nTree,1,2\nTree,1;2,3\n").find(":3:1"), std::string::npos);
  EXPECT_NE(refusal("degrees.csv", "class,lon,lat\nTree,8,50\n").find("coordinate system"), std::string::npos);
  EXPECT_NE(refusal("x.geojson", "[1]").find("FeatureCollection"), std::string::npos);
  EXPECT_NE(refusal("y.geojson", R"({"frame":"m","features":[{"properties":{"class":"Tree"}}]})").find("feature 1"),
            std::string::npos);
  EXPECT_EQ(refusal("z.geojson", R"({"frame":"m","features":[{"properties":{"class":"Tree"},
            "geometry":{"type":"Point","coordinates":[1,2]}}]})"),
            "read");
  EXPECT_NE(refusal("register.txt", "x").find("NAME.csv"), std::string::npos);
  const std::string classes = refusal("class.csv", "class,x,y\nTree,1,2\nTrea,1,2\n");
  EXPECT_NE(classes.find(":3:1"), std::string::npos) << classes;
  EXPECT_NE(classes.find("did you mean 'Tree'"), std::string::npos) << classes;
  const std::string heights = refusal("height.csv", "class,x,y,height\nTree,1,2,\nTree,1,2,4.5\nTree,1,2,tall\n");
  EXPECT_NE(heights.find(":4:1"), std::string::npos) << heights;
  EXPECT_NE(heights.find("'tall' is no number"), std::string::npos) << heights;
  const auto feature = [&](const std::string& properties, const std::string& geometry) {
    return refusal("f.geojson",
                   R"({"frame":"m","features":[{"properties":{)" + properties + R"(},"geometry":)" + geometry + "}]}");
  };
  const std::string point = R"({"type":"Point","coordinates":[1,2]})";
  EXPECT_EQ(feature(R"("kind":"Tree","height":null)", point), "read");
  EXPECT_EQ(feature(R"("kind":"Tree")", R"({"type":"LineString","coordinates":[[1,2],[3,4]]})"), "read");
  EXPECT_NE(feature(R"("kind":"Trea")", point).find("feature 1: the map's ontology has no class"), std::string::npos);
  EXPECT_NE(feature(R"("kind":"Tree","height":"tall")", point).find("feature 1: the height"), std::string::npos);
  EXPECT_NE(feature(R"("kind":"Tree")", "[]").find("feature 1: it has no class or no place"), std::string::npos);
}

RegisterItem thingAt(const std::string& object, double x, std::set<std::string> classes) {
  RegisterItem item;
  item.thing.object = object;
  item.thing.class_iri = *classes.begin();
  item.thing.at = {x, 0};
  item.classes = std::move(classes);
  return item;
}

TEST(Register, PairsAreOneToOneAndNearestFirst) {
  const std::vector<RegisterEntry> entries{{"1", "Tree", {1, 0}, {}}, {"2", "Tree", {0.9, 0}, {}}};
  const auto rows = compareWith(entries, {thingAt("a", 0, {"Tree"}), thingAt("b", 1.5, {"Tree"})}, {.within_m = 3});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].item, 1U);
  EXPECT_EQ(rows[1].item, 0U);
}

TEST(Register, AnEntryOfTheVeryClassComesBeforeOneOfASuperclass) {
  const std::vector<RegisterEntry> entries{{"1", "Furniture", {0, 0}, {}}, {"2", "Bench", {2, 0}, {}}};
  const auto rows = compareWith(entries, {thingAt("a", 0.5, {"Bench", "Furniture"})}, {.within_m = 3});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].status, RegisterStatus::NotObserved);
  EXPECT_EQ(rows[1].status, RegisterStatus::Matched);
}

TEST(QuestionsOfACampus, NextViewsSeeWhatIsNotObservedOnceAndInOrder) {
  const MapReader& map = CampusMap::shared().map();
  NextViewRequest request;
  request.from = placeOfAStop(map);
  request.tour.max_stops = 4;
  const NextViewAnswer answer = nextViews(map, request);
  ASSERT_GE(answer.views.size(), 2U);
  double area_m2 = 0, so_far = 0;
  for (const NextView& view : answer.views) {
    EXPECT_GT(view.area_m2, 0);
    EXPECT_GT(view.stop.so_far, so_far);
    so_far = view.stop.so_far;
    area_m2 += view.area_m2;
  }
  EXPECT_LE(area_m2, answer.unobserved_m2);
  request.is_doubtful = true;
  request.below = 0.9;
  std::vector<std::uint32_t> seen;
  for (const NextView& view : nextViews(map, request).views)
    for (const std::uint32_t object : view.objects) {
      EXPECT_LT(map.objects()[object].confidence, 0.9);
      seen.push_back(object);
    }
  EXPECT_FALSE(seen.empty());
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end()) << "an object counts once";
}

TEST(QuestionsOfACampus, LearnedPlacesAreCountsThatTheOntologyCanRead) {
  const MapReader& map = CampusMap::shared().map();
  PlaceLearner learner;
  learner.add(map);
  const std::vector<LearnedPlace> places = learner.learn();
  ASSERT_FALSE(places.empty());
  std::map<std::string, double> sums;
  for (const LearnedPlace& place : places) {
    sums[place.class_iri] += place.probability;
    EXPECT_LE(place.near, place.objects);
    EXPECT_GE(place.probability, 0.03);
    std::size_t objects = 0;
    for (const rules::SemanticObject& object : map.objects()) objects += object.class_iri == place.class_iri ? 1 : 0;
    EXPECT_EQ(place.objects, objects);
  }
  for (const auto& [class_iri, sum] : sums) EXPECT_LE(sum, 1 + 1e-9) << class_iri;
  const ScratchFolder folder;
  writeFile(folder.path() / "places.ttl", placesTurtle(places, 1));
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const auto read = usualPlacesOf(ontology, places[0].class_iri, folder.path() / "places.ttl");
  EXPECT_EQ(read[0].near_class, places[0].near_class);
  EXPECT_NEAR(read[0].probability, places[0].probability, 1e-4);
}

}  // namespace
}  // namespace cluxel::tasks
