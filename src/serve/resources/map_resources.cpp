// SPDX-License-Identifier: Apache-2.0
// A map's summary, its graphs, and the shipped questions.
#include "serve/resources/map_resources.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"

namespace cluxel::serve {

namespace {

using Json = nlohmann::ordered_json;

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string questionName(const tasks::Question& question) {
  return question.file.stem().string();
}

Json questionJson(const tasks::Question& question) {
  Json json{{"name", questionName(question)},
            {"title", question.title},
            {"parameters", Json::array()},
            {"columns", Json::array()},
            {"text", question.text}};
  for (const tasks::QueryParameter& p : question.parameters)
    json["parameters"].push_back({{"name", p.name}, {"unit", p.unit}, {"default", p.default_value}, {"help", p.help}});
  for (const tasks::QueryColumn& c : question.columns)
    json["columns"].push_back({{"name", c.name}, {"unit", c.unit}, {"help", c.help}});
  return json;
}

const tasks::Question& questionNamed(const std::vector<tasks::Question>& questions, const std::string& name) {
  std::vector<std::string> known;
  for (const tasks::Question& question : questions) {
    if (questionName(question) == name) return question;
    known.push_back(questionName(question));
  }
  const std::string hint = suggestion(name, known);
  throw Refusal(404, "there is no question '" + name + "'" + (hint.empty() ? "" : "; " + hint));
}

void addBounds(Json& json, const std::vector<Object>& objects) {
  if (objects.empty()) return;
  Position min = objects.front().min, max = objects.front().max;
  for (const Object& object : objects) {
    min = {std::min(min.x, object.min.x), std::min(min.y, object.min.y), std::min(min.z, object.min.z)};
    max = {std::max(max.x, object.max.x), std::max(max.y, object.max.y), std::max(max.z, object.max.z)};
  }
  json["objectBounds"] = {{"min", {min.x, min.y, min.z}}, {"max", {max.x, max.y, max.z}}};
}

}  // namespace

std::string mapSummaryJson(const ServedMap& map) {
  const rdf::QuadReader snapshot = map.quads();
  const auto table = objectsOf(snapshot);
  std::map<std::string, std::size_t> by_class;
  for (const Object& object : table->objects) ++by_class[table->class_names.nameOf(object.class_iri)];
  const std::string base = "/maps/" + percentEncoded(map.name());
  Json json{{"name", map.name()},
            {"sparql", base + "/sparql"},
            {"quads", snapshot.size()},
            {"objects", table->objects.size()},
            {"objectsByClass", by_class}};
  addBounds(json, table->objects);
  return textOf(json);
}

HttpResponse answerQuestionList(const std::vector<tasks::Question>& questions) {
  Json json{{"questions", Json::array()}};
  for (const tasks::Question& question : questions) json["questions"].push_back(questionJson(question));
  return {200, "application/json", textOf(json) + "\n", {}};
}

HttpResponse answerQuestion(const ServedMap& map, const ResourceRequest& asked,
                            const std::vector<tasks::Question>& questions, const std::string& name) {
  const tasks::Question& question = questionNamed(questions, name);
  std::vector<std::string> given;
  for (const auto& [parameter, value] : asked.target.parameters)
    if (parameter != "format") given.push_back(parameter + "=" + value);
  return answerQuery(map.quads(), question.text, queryOptions(asked.limits, asked.request),
                     bindingsFor(question, given), formatRequestOf(asked.request, asked.target.parameters),
                     asked.limits);
}

HttpResponse answerGraph(const ServedMap& map, const ResourceRequest& asked) {
  const Parameters& parameters = asked.target.parameters;
  requireKnown(parameters, {"graph", "default", "format"});
  const auto graph = valueOf(parameters, "graph");
  if (graph.has_value() == valueOf(parameters, "default").has_value())
    throw Refusal(400, "name one graph: graph=IRI, or default for the union of all graphs but history");
  const rdf::QuadReader snapshot = map.quads();
  sparql::QueryOptions options = queryOptions(asked.limits, asked.request);
  if (graph) {
    if (!snapshot.idOf(Term::iri(*graph))) throw Refusal(404, "the map has no graph <" + *graph + ">");
    options.default_graphs = {*graph};
  }
  return answerQuery(snapshot, "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }", options, {},
                     formatRequestOf(asked.request, parameters), asked.limits);
}

}  // namespace cluxel::serve
