// SPDX-License-Identifier: Apache-2.0
// Every way to ask for the objects of a class gives the answer of a query: with the shipped rules, which tell fences
// from walls, and with rules of one's own.
#include "tasks/objects_of_class.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cluxel/map.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"
#include "serve/resources/map_resources.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/explanation.hpp"
#include "tasks/inventory/inventory.hpp"
#include "tasks/search/place_learning.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/ways/class_cells.hpp"

namespace cluxel::serve {
namespace {

using Names = std::set<std::string>;

constexpr const char* kOak = "http://e.org/Oak";

mapping::MapInputs inputsWithOwnRules() {
  mapping::MapInputFiles files;
  files.model = "campus";
  mapping::MapInputs inputs = readMapInputs(files, DataHome(test::sourceFolder()));
  const std::string prefixes = "PREFIX clx: <https://w3id.org/cluxel/ontology#> ";
  inputs.ontology.push_back({"own.ttl",
                             "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix rdfs: "
                             "<http://www.w3.org/2000/01/rdf-schema#> . <http://e.org/Oak> a owl:Class ; "
                             "rdfs:subClassOf <https://w3id.org/cluxel/ontology#Tree> ; rdfs:label \"oak\"@en ."});
  inputs.sparql_rules.push_back(
      {"own_oaks.rq",
       prefixes + "CONSTRUCT { ?t a <http://e.org/Oak> } WHERE { ?t a clx:Tree ; clx:height ?h FILTER(?h > 5) }"});
  inputs.sparql_rules.push_back(
      {"own_vehicles.rq",
       prefixes + "CONSTRUCT { ?t a clx:Vehicle } WHERE { ?t a clx:Barrier ; clx:height ?h FILTER(?h > 0.5) }"});
  return inputs;
}

/// A map in which the shipped rules say of barriers that they are fences.
class ObjectsOfAClass : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new rdf::ScratchFolder;
    const mapping::SmallCampus campus({.seed = 3, .stops = 4, .size_m = 60, .points_per_stop = 50'000});
    buildMap(mapping::scansOf(campus.files()), inputsWithOwnRules(), folder->path() / "map.clx", {.threads = 2},
             mapping::silence());
  }
  static void TearDownTestSuite() { delete folder; }

  Names namesOf(const std::vector<std::uint32_t>& numbers) const {
    Names names;
    for (const std::uint32_t number : numbers) names.insert(rdf::iriOfObject(map.objectIds()[number]));
    return names;
  }

  /// The objects that a query finds.
  Names asked(const std::string& class_iri) const {
    const sparql::ResultTable table =
        sparql::evaluateQuery(
            map.quads(), "SELECT ?o { ?o a <" + class_iri + "> . ?o <https://w3id.org/cluxel/ontology#confidence> ?c }")
            .table;
    Names names;
    for (std::size_t row = 0; row < table.row_count; ++row) names.insert(table.at(row, 0)->text);
    return names;
  }

  static Names listed(const mapping::MapReader& map, const std::string& class_iri) {
    Names names;
    for (const auto& item :
         tasks::inventoryOf(map, {.classes = {class_iri}, .with_rows = false, .with_sidewalks = false}).items)
      names.insert(item.object);
    return names;
  }

  Names leftOutOf(const std::string& class_iri) const {
    const std::vector<bool> is_left_out = tasks::leftOut(map, {.without = {class_iri}, .with_gone = true, .near = {}});
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < is_left_out.size(); ++i)
      if (is_left_out[i]) numbers.push_back(i);
    return namesOf(numbers);
  }

  /// What a task answers; nothing where it refuses a class of which no object can be.
  template <typename Ask>
  static Names unlessRefused(const Ask& ask) {
    try {
      return ask();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument) << error.what();
      return {};
    }
  }

  Eigen::Vector2d placeOf(const rules::SemanticObject& object) const {
    return mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(object)).centroid.head<2>();
  }

  static Names served(ServedMap& map, const std::string& class_iri) {
    const HttpRequest request;
    const Target target{{}, true, {{"class", class_iri}, {"limit", "10000"}}};
    const auto json = nlohmann::json::parse(answerObjects(map, {request, target, {}}).body);
    Names names;
    for (const auto& object : json["objects"]) names.insert(object["iri"].get<std::string>());
    EXPECT_EQ(json["total"], names.size());
    return names;
  }

  static inline rdf::ScratchFolder* folder = nullptr;
  const std::filesystem::path file = folder->path() / "map.clx";
  const mapping::MapReader map{file};
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const std::string fence = rdf::vocabulary::clx("Fence"), vehicle = rdf::vocabulary::clx("Vehicle");
};

TEST_F(ObjectsOfAClass, AreThoseOfAQueryWhoeverAsks) {
  ASSERT_FALSE(asked(fence).empty());
  ASSERT_FALSE(asked(kOak).empty());
  ASSERT_GT(asked(vehicle).size(), 1U);
  ServedMap served_map("map", file);
  const Map facade = Map::open(file);
  for (const rdf::OntologyClass& known : ontology.classes) {
    const Names expected = asked(known.iri);
    EXPECT_EQ(namesOf(tasks::objectsOfClass(map, known.iri)), expected) << known.iri;
    EXPECT_EQ(listed(map, known.iri), expected) << known.iri;
    EXPECT_EQ(leftOutOf(known.iri), expected) << known.iri;
    EXPECT_EQ(tasks::hasObjectOfClass(map, known.iri), !expected.empty()) << known.iri;
    for (const ContentHash& object : map.objectIds())
      EXPECT_EQ(tasks::isOfClass(map.quads(), object, known.iri), expected.contains(rdf::iriOfObject(object)));
    EXPECT_EQ(unlessRefused([&] { return served(served_map, known.iri); }), expected) << known.iri;
    const auto ofFacade = [&] {
      Names names;
      for (const Object& object : facade.objects(known.iri)) names.insert(object.iri);
      return names;
    };
    EXPECT_EQ(unlessRefused(ofFacade), expected) << known.iri;
  }
}

TEST_F(ObjectsOfAClass, AreKnownToASearchAndStandWhereAWayIsNearThem) {
  const tasks::TerrainGrid terrain = tasks::terrainOf(map);
  const std::vector<bool> none(map.objectIds().size(), false);
  for (const std::string& class_iri : {fence, vehicle, std::string(kOak), rdf::vocabulary::clx("Barrier")}) {
    tasks::SearchRequest request;
    request.class_name = class_iri;
    const Eigen::Vector3d stop = map.clouds().front().T_map_sensor.translation();
    request.from = std::to_string(stop.x()) + "," + std::to_string(stop.y());
    request.ways.with_gone = true;
    request.tour.max_stops = 1;
    std::vector<std::uint32_t> known;
    for (const tasks::KnownObject& object : searchFor(map, request).known) known.push_back(object.object);
    EXPECT_EQ(namesOf(known), asked(class_iri)) << class_iri;
    const Names expected = asked(class_iri);
    const auto marked = cellsWith(map, terrain, class_iri, none);
    for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
      for (const std::uint32_t thing : terrain.thingsIn(cell))
        if (thing != tasks::kUnnamedThing && expected.contains(rdf::iriOfObject(map.objectIds()[thing]))) {
          EXPECT_EQ(marked[cell], 1) << class_iri;
        }
  }
}

/// Lamps are poles: near a pole is where another pole or lamp is near.
TEST_F(ObjectsOfAClass, AreThoseNearWhichPlacesAreLearned) {
  tasks::PlaceLearner learner({.distances_m = {6}, .least_probability = 0, .least_objects = 2});
  learner.add(map);
  std::size_t derived = 0;
  for (const tasks::LearnedPlace& place : learner.learn()) {
    const Names near = asked(place.near_class);
    std::size_t least = 0, inside = 0, of_class = 0;
    for (const rules::SemanticObject& object : map.objects()) {
      if (object.class_iri != place.class_iri) continue;
      ++of_class;
      if (!near.contains(rdf::iriOfObject(object.id))) continue;
      ++inside;
      double nearest_m = 1e300;
      for (const rules::SemanticObject& other : map.objects())
        if (other.id != object.id && near.contains(rdf::iriOfObject(other.id)))
          nearest_m = std::min(nearest_m, (placeOf(other) - placeOf(object)).norm());
      least += nearest_m <= place.within_m ? 1 : 0;
    }
    EXPECT_EQ(place.objects, of_class);
    EXPECT_GE(place.near, least) << place.class_iri << " near " << place.near_class;
    if (inside == of_class) {
      EXPECT_EQ(place.near, least) << place.class_iri << " near " << place.near_class;
    }
    derived += inside > 0 && place.class_iri != place.near_class ? 1 : 0;
  }
  EXPECT_GT(derived, 0U);
}

TEST_F(ObjectsOfAClass, AreListedAsTheClassThatWasAskedFor) {
  for (const auto& item : tasks::inventoryOf(map, tasks::inventoryOfKinds(map, {fence, vehicle})).items) {
    const auto number = std::lower_bound(map.objectIds().begin(), map.objectIds().end(),
                                         ContentHash::fromHex(item.object.substr(item.object.rfind('/') + 1)));
    const std::string own = map.classOf(static_cast<std::uint32_t>(number - map.objectIds().begin()));
    const std::string& other = asked(fence).contains(item.object) ? fence : vehicle;
    EXPECT_EQ(item.class_iri, ontology.isA(own, vehicle) ? own : other);
  }
}

/// A tree that a rule calls an oak is measured as the tree that it is.
TEST_F(ObjectsOfAClass, AreMeasuredAsWhatTheyAre) {
  std::map<std::string, double> crowns;
  for (const auto& item : tasks::inventoryOf(map, tasks::inventoryOfKinds(map, {"Tree"})).items)
    crowns[item.object] = item.crown_m;
  std::size_t oaks = 0;
  for (const auto& item : tasks::inventoryOf(map, tasks::inventoryOfKinds(map, {kOak})).items) {
    ASSERT_EQ(item.class_iri, kOak);
    EXPECT_GT(item.crown_m, 0);
    EXPECT_EQ(item.crown_m, crowns.at(item.object));
    ++oaks;
  }
  EXPECT_GT(oaks, 0U);
}

TEST_F(ObjectsOfAClass, AreExplainedWithTheRulesThatSaySo) {
  for (const std::string& iri : asked(fence)) {
    const tasks::ExplanationTexts texts = tasks::explainThing(map, iri);
    EXPECT_NE(texts.text.find("also clx:Fence, by SPARQL rule 35_fences.rq\n"), std::string::npos) << texts.text;
    bool is_told = false;
    const auto json = nlohmann::json::parse(texts.json);
    for (const auto& derived : json["derived"])
      is_told = is_told || (derived["class"] == "clx:Fence" && derived["rule"] == "35_fences.rq");
    EXPECT_TRUE(is_told) << texts.json;
    const tasks::ExplanationTexts why_not = tasks::explainWhyNot(map, iri, "clx:Fence");
    EXPECT_NE(why_not.text.find("it is clx:Fence already\n"), std::string::npos) << why_not.text;
    EXPECT_TRUE(nlohmann::json::parse(why_not.json)["is_of_class"].get<bool>());
  }
  for (const std::string& iri : asked(rdf::vocabulary::clx("Barrier")))
    if (!asked(fence).contains(iri)) {
      const std::string why_not = tasks::explainWhyNot(map, iri, "clx:Fence").text;
      EXPECT_EQ(why_not.find("already"), std::string::npos) << why_not;
      EXPECT_NE(why_not.find("SPARQL rule 35_fences.rq can say clx:Fence of an object, and does not of this one\n"),
                std::string::npos)
          << why_not;
      break;
    }
}

/// An object that is named by a rule and is not in the map, and names that are no hash, make no trouble.
TEST_F(ObjectsOfAClass, AreThoseThatTheMapHolds) {
  const auto environment = rdf::Environment::temporary();
  {
    rdf::WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    const auto add = [&](const Term& subject, const std::string_view graph) {
      writer.add({subject, Term::iri(rdf::vocabulary::rdf("type")), Term::iri("http://e.org/C"),
                  graph.empty() ? Term::iri("") : Term::iri(std::string(graph))});
    };
    const ContentHash one = ContentHash::fromHex("00000000000000000000000000000001");
    const ContentHash two = ContentHash::fromHex("00000000000000000000000000000002");
    add(Term::iri(rdf::iriOfObject(two)), rdf::vocabulary::kGraphInferred);
    add(Term::iri(rdf::iriOfObject(two)), rdf::vocabulary::kGraphOperator);
    add(Term::iri(rdf::iriOfObject(one)), rdf::vocabulary::kGraphObserved);
    add(Term::iri(rdf::iriOfObject(ContentHash::fromHex("00000000000000000000000000000003"))),
        rdf::vocabulary::kGraphHistory);
    add(Term::iri(rdf::mapIri("object", "short")), rdf::vocabulary::kGraphInferred);
    add(Term::iri(rdf::mapIri("object", "0000000000000000000000000000000g")), rdf::vocabulary::kGraphInferred);
    add(Term::iri(rdf::mapIri("way", one.hex())), rdf::vocabulary::kGraphInferred);
    add(Term::blank("object"), rdf::vocabulary::kGraphInferred);
    writer.flush();
    transaction.commit();
    const rdf::QuadReader quads(environment->read());
    EXPECT_EQ(tasks::objectsOfClass(quads, "http://e.org/C"), (std::vector{one, two}));
    EXPECT_TRUE(tasks::objectsOfClass(quads, "http://e.org/D").empty());
    const ContentHash three = ContentHash::fromHex("00000000000000000000000000000003");
    EXPECT_TRUE(tasks::isOfClass(quads, two, "http://e.org/C"));
    EXPECT_FALSE(tasks::isOfClass(quads, three, "http://e.org/C")) << "history tells what was";
  }
}

}  // namespace
}  // namespace cluxel::serve
