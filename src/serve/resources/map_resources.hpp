// SPDX-License-Identifier: Apache-2.0
// Resources of a map as JSON: its summary, objects, explanations, points, graphs, and the shipped questions.
#pragma once

#include <string>
#include <vector>

#include "serve/http/http_message.hpp"
#include "serve/http/url.hpp"
#include "serve/served_map.hpp"
#include "serve/service_options.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::serve {

/// A request to a resource of a map. Handlers throw Refusal and Error.
struct ResourceRequest {
  const HttpRequest& request;
  const Target& target;
  const RequestLimits& limits;
};

/// Name, numbers and bounds of a map as a JSON object.
std::string mapSummaryJson(const ServedMap& map);

/// Parameters: class, bbox (minX,minY,maxX,maxY, or with heights minX,minY,minZ,maxX,maxY,maxZ), limit, offset.
HttpResponse answerObjects(ServedMap& map, const ResourceRequest& asked);
/// `id`: the object's hash, at least four of its first digits, or its number as "#17".
HttpResponse answerObject(const ServedMap& map, const ResourceRequest& asked, const std::string& id);
/// JSON, or prose when the client wants text/plain.
HttpResponse answerExplanation(ServedMap& map, const ResourceRequest& asked, const std::string& id);
/// JSON with one array a column, or CSV.
HttpResponse answerPoints(ServedMap& map, const ResourceRequest& asked, const std::string& id);

/// All points of one tile of 16 m for the page: a line of JSON, then planes of bytes (tasks/view/point_tiles.hpp).
/// Parameters: state, as the page has it, and intensity=LOW,HIGH. 409 when the map has another state.
HttpResponse answerPointTile(ServedMap& map, const ResourceRequest& asked, const std::string& x, const std::string& y);

/// The shipped questions with parameters and columns.
HttpResponse answerQuestionList(const std::vector<tasks::Question>& questions);
/// Runs a shipped question; its parameters are those of the request.
HttpResponse answerQuestion(const ServedMap& map, const ResourceRequest& asked,
                            const std::vector<tasks::Question>& questions, const std::string& name);
/// The table of tasks as JSON: names, parameters with kinds, units, defaults and ranges, columns.
HttpResponse answerTaskList(const std::vector<tasks::Question>& questions);
/// Runs a task; the parameters are those of the request, beside format (json, geojson, csv, table), frame (degrees,
/// local) and why (true, false).
HttpResponse answerTask(ServedMap& map, const ResourceRequest& asked, const std::vector<tasks::Question>& questions,
                        const std::string& name);
/// POST: tries the rules of the body on the map, which stays as it is, and tells what would change. Needs the token,
/// because reasoning takes as long as it takes.
HttpResponse answerRuleTrial(ServedMap& map, const ResourceRequest& asked, const std::string& token);
/// One graph in Turtle or N-Triples (SPARQL 1.1 Graph Store HTTP Protocol, reading): parameter graph=IRI, or default.
HttpResponse answerGraph(const ServedMap& map, const ResourceRequest& asked);

}  // namespace cluxel::serve
