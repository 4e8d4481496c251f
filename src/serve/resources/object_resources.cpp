// SPDX-License-Identifier: Apache-2.0
// Objects, their explanations and their points.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "api/object_query.hpp"
#include "api/point_query.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/map_reader.hpp"
#include "mapping/things/ended_names.hpp"
#include "serve/http/media_types.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"
#include "serve/resources/map_resources.hpp"
#include "serve/resources/object_json.hpp"
#include "tasks/explanation.hpp"
#include "tasks/named_class.hpp"

namespace cluxel::serve {

namespace {

constexpr std::size_t kMinDigits = 4;  ///< of a hash

std::string hashOf(const std::string& iri) {
  return iri.substr(iri.rfind('/') + 1);
}

/// "#17" as a number.
std::optional<std::size_t> numberIn(const std::string& id, std::size_t objects) {
  if (!id.starts_with('#')) return std::nullopt;
  for (std::size_t i = 0; i < objects; ++i)
    if (id.substr(1) == std::to_string(i)) return i;
  throw Refusal(404, "there is no object " + id + ": the map has " + std::to_string(objects) + ", numbered from 0");
}

/// The object that goes on under the name of a thing or of a former object.
const Object& laterObject(const ObjectTable& table, const rdf::QuadReader& quads, const std::string& id) {
  std::vector<ContentHash> present;
  for (const Object& object : table.objects) present.push_back(ContentHash::fromHex(hashOf(object.iri)));
  if (const auto former = mapping::Lineage(quads, present).find(id))
    for (const Object& object : table.objects)
      if (hashOf(object.iri) == former->object.hex()) return object;
  const auto isPresent = [&](const ContentHash& object) {
    return std::find(present.begin(), present.end(), object) != present.end();
  };
  const auto ended = mapping::endOf(quads, isPresent, id);
  throw Refusal(404, "the map has no object '" + id + "'" + (ended ? ": " + textOf(*ended) : ""));
}

const Object& objectNamed(const ObjectTable& table, const rdf::QuadReader& quads, const std::string& id) {
  if (const auto number = numberIn(id, table.objects.size())) return table.objects[*number];
  if (id.size() < kMinDigits)
    throw Refusal(400, "'" + id + "': write at least four digits of the object's hash, or # (as %23) and its number");
  const Object* found = nullptr;
  for (const Object& object : table.objects) {
    if (!hashOf(object.iri).starts_with(id)) continue;
    if (found != nullptr) throw Refusal(404, "'" + id + "' names more than one object; write more digits");
    found = &object;
  }
  return found != nullptr ? *found : laterObject(table, quads, id);
}

struct Box {
  Position min{-INFINITY, -INFINITY, -INFINITY}, max{INFINITY, INFINITY, INFINITY};

  bool meets(const Extent& extent) const {
    return extent.min.x <= max.x && min.x <= extent.max.x && extent.min.y <= max.y && min.y <= extent.max.y &&
           extent.min.z <= max.z && min.z <= extent.max.z;
  }
};

Box boxOf(const Parameters& parameters) {
  const auto text = valueOf(parameters, "bbox");
  if (!text) return {};
  const std::vector<double> n = numbersIn("bbox", *text);
  Box box;
  if (n.size() == 4)
    box = {{n[0], n[1], -INFINITY}, {n[2], n[3], INFINITY}};
  else if (n.size() == 6)
    box = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  else
    throw Refusal(400, "parameter bbox: write minX,minY,maxX,maxY or minX,minY,minZ,maxX,maxY,maxZ in metres");
  if (box.min.x > box.max.x || box.min.y > box.max.y || box.min.z > box.max.z)
    throw Refusal(400, "parameter bbox: a minimum is larger than its maximum");
  return box;
}

std::vector<const Object*> selected(const mapping::MapReader& map, const ObjectTable& table,
                                    const Parameters& parameters) {
  const Box box = boxOf(parameters);
  const auto class_name = valueOf(parameters, "class");
  const auto namespaces = [&] { return tasks::namespacesOf(map.inputs()); };
  const std::string class_iri = class_name ? tasks::classNamed(table.ontology, *class_name, namespaces) : "";
  std::vector<const Object*> objects;
  if (class_name)
    objects = objectsOfClass(table.objects, map.quads(), class_iri);
  else
    for (const Object& object : table.objects) objects.push_back(&object);
  if (class_name && objects.empty()) tasks::requireClassOfObjects(table.ontology, class_iri);
  std::erase_if(objects, [&](const Object* object) { return !box.meets(*object); });
  return objects;
}

HttpResponse jsonResponse(const ObjectJson& json, const RequestLimits& limits) {
  LimitedBody body(limits.max_answer_bytes);
  body.add(json.dump(-1, ' ', false, ObjectJson::error_handler_t::replace) + "\n");
  return {200, "application/json", body.take(), {}};
}

/// The object of the newest commit, which one reader then serves.
Object currentObject(const mapping::MapReader& map, const std::string& id) {
  return objectNamed(*objectsOf(map.quads()), map.quads(), id);
}

std::string csvOf(const PointCloud& points, std::uint64_t max_bytes) {
  LimitedBody body(max_bytes);
  body.add(points.intensity.empty() ? "x,y,z,label\r\n" : "x,y,z,label,intensity\r\n");
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::string line = metres(points.x[i]) + "," + metres(points.y[i]) + "," + metres(points.z[i]) + ",";
    line += nameOf(points.label[i]);
    if (!points.intensity.empty()) line += "," + std::to_string(points.intensity[i]);
    body.add(line + "\r\n");
  }
  return body.take();
}

}  // namespace

HttpResponse answerObjects(ServedMap& map, const ResourceRequest& asked) {
  constexpr std::size_t kDefaultPage = 100, kLargestPage = 10'000;
  const Parameters& parameters = asked.target.parameters;
  requireKnown(parameters, {"class", "bbox", "limit", "offset"});
  const std::size_t limit = std::min(wholeNumberOf(parameters, "limit").value_or(kDefaultPage), kLargestPage);
  const std::size_t offset = wholeNumberOf(parameters, "offset").value_or(0);
  ObjectJson json;
  map.withReader([&](const mapping::MapReader& reader) {  // one commit for all of the answer
    const auto table = objectsOf(reader.quads());
    const std::vector<const Object*> objects = selected(reader, *table, parameters);
    json = {{"total", objects.size()}, {"offset", offset}, {"objects", ObjectJson::array()}};
    for (std::size_t i = offset; i < objects.size() && i - offset < limit; ++i)
      json["objects"].push_back(objectJson(*objects[i], reader.quads(), table->class_names));
    if (limit > 0 && offset < objects.size() && objects.size() - offset > limit) json["nextOffset"] = offset + limit;
  });
  return jsonResponse(json, asked.limits);
}

HttpResponse answerObject(const ServedMap& map, const ResourceRequest& asked, const std::string& id) {
  requireKnown(asked.target.parameters, {});
  const rdf::QuadReader snapshot = map.quads();
  const auto table = objectsOf(snapshot);
  const Object& object = objectNamed(*table, snapshot, id);
  ObjectJson json = objectJson(object, snapshot, table->class_names);
  const auto things = mapping::storedThings(snapshot);
  json["thing"] = thingOf(things, ContentHash::fromHex(hashOf(object.iri))).iri;
  return jsonResponse(json, asked.limits);
}

HttpResponse answerExplanation(ServedMap& map, const ResourceRequest& asked, const std::string& id) {
  const auto chosen = negotiate(asked.request.header("accept"), {"application/json", "text/plain"});
  if (!chosen) throw Refusal(406, "an explanation can be had as application/json or text/plain");
  requireKnown(asked.target.parameters, {"whyNot"});
  const std::optional<std::string> why_not = valueOf(asked.target.parameters, "whyNot");
  tasks::ExplanationTexts texts;
  map.withReader([&](const mapping::MapReader& reader) {
    const std::string iri = currentObject(reader, id).iri;
    texts = why_not ? tasks::explainWhyNot(reader, iri, *why_not) : tasks::explainThing(reader, iri);
  });
  HttpResponse response{200, "application/json", texts.json + "\n", {}};
  if (*chosen == 1) response = textResponse(200, texts.text);
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

HttpResponse answerPoints(ServedMap& map, const ResourceRequest& asked, const std::string& id) {
  const auto chosen = negotiate(asked.request.header("accept"), {"application/json", "text/csv"});
  requireKnown(asked.target.parameters, {});
  if (!chosen) throw Refusal(406, "points can be had as application/json or text/csv");
  PointCloud points;
  map.withReader([&](const mapping::MapReader& reader) {
    mapping::KeptAnswers answers(reader);
    points = pointsOf(reader, answers, currentObject(reader, id).iri);
  });
  HttpResponse response{200, "text/csv; charset=utf-8", {}, {}};
  if (*chosen == 0)
    response = jsonResponse(pointsJson(points), asked.limits);
  else
    response.body = csvOf(points, asked.limits.max_answer_bytes);
  response.headers.emplace_back("Vary", "Accept");
  return response;
}

}  // namespace cluxel::serve
