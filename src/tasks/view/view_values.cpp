// SPDX-License-Identifier: Apache-2.0
// Numbers are rounded to a millimetre: more digits say nothing and cost bytes.
#include "tasks/view/view_values.hpp"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "mapping/clouds/ray_starts.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/regions/object_extents.hpp"
#include "rdf/file/check/commit_name.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/objects/finished_objects.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {

namespace {

using ViewJson = nlohmann::ordered_json;

double toMillimetre(double value) {
  return std::round(value * 1e3) / 1e3;
}

ViewJson vectorJson(const Eigen::Vector3d& v) {
  return {toMillimetre(v.x()), toMillimetre(v.y()), toMillimetre(v.z())};
}

ViewJson cloudsJson(const mapping::MapReader& map) {
  ViewJson all = ViewJson::array();
  for (const mapping::Cloud& cloud : cloudsByTime(map)) {
    ViewJson json{{"id", cloud.id.hex()}, {"points", cloud.point_count}};
    json["source"] = std::filesystem::path(cloud.source).filename().string();
    if (cloud.time_s) json["time"] = *cloud.time_s;
    if (const auto place = mapping::sensorPlaceOf(cloud)) json["position"] = vectorJson(*place);
    all.push_back(std::move(json));
  }
  return all;
}

ViewJson tilesJson(const PointTiles& tiles) {
  ViewJson all = ViewJson::array();
  for (const PointTile& tile : tiles.tiles)
    all.push_back({{"origin", vectorJson(tile.origin)},
                   {"size", vectorJson(tile.size)},
                   {"zQuantum", tile.z_quantum_m},
                   {"pointsTo", tile.points_to}});
  return all;
}

ViewJson questionsJson(const std::vector<Question>& questions) {
  ViewJson all = ViewJson::array();
  for (const Question& question : questions) {
    ViewJson json{{"file", question.file.filename().string()},
                  {"title", question.title},
                  {"text", question.text},
                  {"parameters", ViewJson::array()},
                  {"columns", ViewJson::array()}};
    for (const QueryParameter& p : question.parameters)
      json["parameters"].push_back({{"name", p.name}, {"unit", p.unit}, {"value", p.default_value}, {"help", p.help}});
    for (const QueryColumn& column : question.columns)
      json["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"help", column.help}});
    all.push_back(std::move(json));
  }
  return all;
}

/// The files that are loaded first; what they include is found by the service.
ViewJson rulesJson(const mapping::MapInputs& inputs) {
  ViewJson all = ViewJson::array();
  for (std::size_t i = 0; i < inputs.rules.size(); ++i)
    all.push_back({{"name", std::filesystem::path(inputs.rules[i].name).filename().string()},
                   {"text", inputs.rules[i].text},
                   {"root", i < inputs.rule_roots}});
  return all;
}

/// SPARQL rules, in the order in which they run: their texts tell why a place is what it is.
ViewJson sparqlRulesJson(const mapping::MapInputs& inputs) {
  ViewJson all = ViewJson::array();
  for (const mapping::NamedText& rule : inputs.sparql_rules)
    all.push_back({{"name", std::filesystem::path(rule.name).filename().string()}, {"text", rule.text}});
  return all;
}

ViewJson visitsJson(const mapping::MapReader& map) {
  ViewJson all = ViewJson::array();
  for (const Visit& visit : visitsOf(map.clouds()))
    all.push_back({{"begin", visit.begin_s}, {"end", visit.end_s}, {"scans", visit.scans}});
  return all;
}

ViewJson propertiesJson(const rdf::OntologyView& ontology) {
  ViewJson all = ViewJson::array();
  for (const rdf::OntologyProperty& property : ontology.properties)
    all.push_back({{"iri", property.iri}, {"label", property.label}, {"unit", property.unit}});
  return all;
}

ViewJson classesJson(const mapping::MapReader& map) {
  std::set<std::string> whole;
  for (std::size_t i = 0; i < map.objectIds().size(); ++i)
    if (const std::string& iri = map.objectClasses()[i]; map.objectIds()[i] == rules::idOfClassWide(iri))
      whole.insert(iri);
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  ViewJson all = ViewJson::array();
  for (const rdf::OntologyClass& known : ontology.classes) {
    all.push_back({{"iri", known.iri},
                   {"label", known.label()},
                   {"comment", known.comment},
                   {"color", known.color},
                   {"movable", known.mobility == rdf::Mobility::Movable},
                   {"ancestors", known.ancestors}});
    if (whole.contains(known.iri)) all.back()["whole"] = true;
  }
  return all;
}

ViewJson boxJson(const perception::UprightBox& box) {
  ViewJson json = vectorJson(box.center);
  for (const double value : {box.size.x(), box.size.y(), box.size.z(), box.yaw_rad})
    json.push_back(toMillimetre(value));
  return json;
}

ViewJson partsJson(const std::string& class_iri, const std::vector<mapping::PartExtents>& parts) {
  ViewJson all = ViewJson::array();
  for (const mapping::PartExtents& part : parts)
    if (part.part_class != class_iri)
      all.push_back({{"class", part.part_class}, {"box", boxJson(mapping::geometryOf(part.sums).box)}});
  return all;
}

mapping::ObjectGeometry geometryOf(const std::vector<mapping::PartExtents>& parts) {
  mapping::ExtentSums sums;
  for (const mapping::PartExtents& part : parts) sums.add(part.sums);
  return mapping::geometryOf(std::move(sums));
}

}  // namespace

std::string mapValuesJson(const mapping::MapReader& map, const PointTiles& tiles, std::uint64_t quads_left_out,
                          const ViewOptions& options, const std::vector<Question>& questions) {
  const mapping::MapInputs inputs = map.inputs();
  ViewJson json{{"name", options.name},
                {"served", options.is_served},
                {"finished", map.isFinished()},
                {"crs", inputs.crs},
                {"origin", vectorJson(inputs.map_origin)},
                {"points", tiles.points},
                {"pointsInMap", tiles.points_in_map},
                {"quadsLeftOut", quads_left_out},
                {"quantum", kViewQuantum_m},
                {"lowestHeight", kLowestHeight_m},
                {"heightStep", kShownHeightStep_m},
                {"intensity", tiles.intensity}};
  if (options.is_served) json["state"] = rdf::commitName(map.transaction());
  if (options.is_served) json["tileState"] = tileStateOf(map);
  json["labels"] = scan::kPrimitiveLabelNames;
  json["clouds"] = cloudsJson(map);
  json["tiles"] = tilesJson(tiles);
  json["questions"] = questionsJson(questions);
  json["tasks"] = ViewJson::parse(taskListJson(tasksOf(questions)));
  json["rules"] = rulesJson(inputs);
  json["sparqlRules"] = sparqlRulesJson(inputs);
  json["visits"] = visitsJson(map);
  json["properties"] = propertiesJson(ontologyViewOf(map.quads()));
  return json.dump(-1, ' ', false, ViewJson::error_handler_t::replace);
}

std::string visitChangesJson(const mapping::MapReader& map, unsigned threads) {
  std::string all = "[";
  for (const SiteChanges& changes : changesOfVisits(map, threads))
    all += (all.size() > 1 ? "," : "") + changesJson(map, changes);
  return all + "]";
}

std::string lineageJson(const mapping::MapReader& map) {
  std::map<std::string, std::string> number_of;
  for (std::size_t i = 0; i < map.objectIds().size(); ++i)
    number_of[rdf::iriOfObject(map.objectIds()[i])] = std::to_string(i);
  const std::string query = "PREFIX prov: <http://www.w3.org/ns/prov#> PREFIX clx: <" +
                            std::string(rdf::vocabulary::kClx) + "> SELECT ?object ?from ?operation ?time { GRAPH <" +
                            std::string(rdf::vocabulary::kGraphHistory) +
                            "> { ?object prov:wasDerivedFrom ?from OPTIONAL { ?object prov:wasGeneratedBy ?run . "
                            "?run clx:operation ?operation ; prov:endedAtTime ?time } } } ORDER BY ?object ?time ?from";
  const sparql::ResultTable table = sparql::evaluateQuery(map.quads(), query).table;
  const auto textAt = [&](std::size_t row, std::size_t column) {
    const Term* term = table.at(row, column);
    return term == nullptr ? std::string() : term->text;
  };
  ViewJson json = ViewJson::object();
  for (std::size_t row = 0; row < table.row_count; ++row)
    if (const auto known = number_of.find(textAt(row, 0)); known != number_of.end())
      json[known->second].push_back(
          {{"from", textAt(row, 1)}, {"operation", textAt(row, 2)}, {"time", textAt(row, 3)}});
  return json.dump(-1, ' ', false, ViewJson::error_handler_t::replace);
}

std::string objectValuesJson(const mapping::MapReader& map) {
  const std::vector<std::vector<mapping::PartExtents>> extents = mapping::extentsOfObjects(map);
  ViewJson json{{"classes", classesJson(map)}};
  for (const char* column : {"id", "class", "confidence", "rule", "box", "bottom", "top", "points", "parts"})
    json[column] = ViewJson::array();
  mapping::forEachRecord(map.transaction(), [&](const ContentHash& id, const mapping::ObjectRecord& object) {
    const std::vector<mapping::PartExtents>& parts = extents.at(json["id"].size());
    const mapping::ObjectGeometry geometry = geometryOf(parts);
    json["id"].push_back(id.hex());
    json["class"].push_back(object.class_iri);
    json["confidence"].push_back(toMillimetre(object.confidence));
    json["rule"].push_back(object.rule_id);
    json["box"].push_back(boxJson(geometry.box));
    json["bottom"].push_back(toMillimetre(geometry.bottom_m));
    json["top"].push_back(toMillimetre(geometry.top_m));
    json["points"].push_back(geometry.point_count);
    json["parts"].push_back(partsJson(object.class_iri, parts));
  });
  return json.dump(-1, ' ', false, ViewJson::error_handler_t::replace);
}

}  // namespace cluxel::tasks
