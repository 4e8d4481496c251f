// SPDX-License-Identifier: Apache-2.0
// Routes and common checks of requests.
#include "serve/map_service.hpp"

#include <algorithm>
#include <array>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"
#include "serve/resources/map_resources.hpp"
#include "serve/resources/sparql_endpoint.hpp"
#include "serve/resources/start_page.hpp"

namespace cluxel::serve {

namespace {

/// The first segments of resources of a map.
const std::array<std::string, 8> kMapResources{"sparql", "graph", "objects", "questions",
                                               "tasks",  "page",  "rules",   "tiles"};

bool isMapResource(const std::string& segment) {
  return std::find(kMapResources.begin(), kMapResources.end(), segment) != kMapResources.end();
}

/// "localhost" of "localhost:8080", "[::1]" of "[::1]:8080".
std::string hostNameOf(const std::string& host) {
  const std::size_t bracket = host.find(']');
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  return lowerCase(host.substr(0, colon));
}

void requireMethod(const HttpRequest& request, bool may_post) {
  if (request.method == "GET" || request.method == "HEAD" || (may_post && request.method == "POST")) return;
  const std::string allowed = may_post ? "GET, HEAD, POST" : "GET, HEAD";
  throw Refusal(405, request.method + " is not allowed here; use " + allowed, {{"Allow", allowed}});
}

/// The name of the commit that an answer is of, from those of the newest before and after it was made.
std::string stateOfAnswer(const std::string& before, const std::string& after) {
  if (before == after) return after;
  return before == kUnknownState || after == kUnknownState ? kUnknownState : kChangedState;
}

/// A host that can stand in a URL; a client may send anything.
std::string urlHostOf(const HttpRequest& request) {
  const std::string host = request.header("host");
  const bool is_plain = !host.empty() && std::all_of(host.begin(), host.end(), [](char c) {
    return isAsciiAlphanumeric(c) || std::string_view(".-:[]").find(c) != std::string_view::npos;
  });
  return is_plain ? host : "localhost";
}

}  // namespace

MapService::MapService(const std::vector<MapArgument>& maps, const DataHome& home, ServiceOptions options)
    : options_(std::move(options)),
      questions_(tasks::shippedQuestions(home)),
      rate_(options_.load.per_second),
      slots_(options_.load.running, options_.load.waiting, options_.load.patience) {
  for (const MapArgument& map : maps) maps_.push_back(std::make_unique<ServedMap>(map.name, map.file));
}

std::vector<std::filesystem::path> MapService::unfinishedMaps() const {
  std::vector<std::filesystem::path> files;
  for (const auto& map : maps_)
    if (map->isUnfinished()) files.push_back(map->file());
  return files;
}

void MapService::tidy() {
  for (const auto& map : maps_) {
    try {
      map->releaseOldCommit();
    } catch (const std::exception&) {
      map->release();  // the file is gone or being replaced; the next request reports it
    }
  }
}

HttpResponse MapService::handle(const HttpRequest& request) {
  HttpResponse response;
  try {
    response = dispatch(request);
  } catch (...) {
    response = responseTo(std::current_exception());
  }
  allowOrigin(request, response);
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  response.headers.emplace_back("Cache-Control", "no-cache");
  return response;
}

HttpResponse MapService::dispatch(const HttpRequest& request) {
  requireHost(request);
  if (!rate_.admit(request.client))
    throw Refusal(429, "too many requests from this client; wait a second", {{"Retry-After", "1"}});
  if (request.method == "OPTIONS") return preflight(request);
  const Target target = parseTarget(request.target);
  return answerRoute(routeOf(target), request, target);
}

void MapService::requireHost(const HttpRequest& request) const {
  if (options_.host_names.empty()) return;
  const std::string name = hostNameOf(request.header("host"));
  const auto& known = options_.host_names;
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  throw Refusal(421, "this service is for its own machine only and does not answer for host '" + name + "'");
}

HttpResponse MapService::preflight(const HttpRequest& request) const {
  HttpResponse response{204, {}, {}, {{"Allow", "GET, HEAD, POST, OPTIONS"}}};
  if (request.header("access-control-request-method").empty()) return response;
  response.headers.emplace_back("Access-Control-Allow-Methods", "GET, HEAD, POST");
  response.headers.emplace_back("Access-Control-Allow-Headers", "Accept, Authorization, Content-Type");
  response.headers.emplace_back("Access-Control-Max-Age", "600");
  return response;
}

void MapService::allowOrigin(const HttpRequest& request, HttpResponse& response) const {
  const auto& allowed = options_.allowed_origins;
  if (allowed.empty()) {  // without an allowed origin the headers of preflight() have no use
    std::erase_if(response.headers, [](const auto& header) { return header.first.starts_with("Access-Control-"); });
    return;
  }
  const std::string origin = request.header("origin");
  const bool is_open = std::find(allowed.begin(), allowed.end(), "*") != allowed.end();
  const bool is_known = std::find(allowed.begin(), allowed.end(), origin) != allowed.end();
  if (is_open || is_known) {
    response.headers.emplace_back("Access-Control-Allow-Origin", is_open ? "*" : origin);
    response.headers.emplace_back("Access-Control-Expose-Headers", std::string(kWarningHeader) + ", " + kStateHeader);
  }
  response.headers.emplace_back("Vary", "Origin");
}

MapService::Route MapService::routeOf(const Target& target) {
  const std::vector<std::string>& path = target.segments;
  if (path.size() >= 2 && path[0] == "maps") {
    std::vector<std::string> known;
    for (const auto& map : maps_) {
      if (map->name() == path[1]) return {map.get(), {path.begin() + 2, path.end()}};
      known.push_back(map->name());
    }
    const std::string hint = suggestion(path[1], known);
    throw Refusal(404, "no map named '" + path[1] + "' is served" + (hint.empty() ? "" : "; " + hint));
  }
  if (path.empty() || !isMapResource(path[0])) return {nullptr, path};
  if (maps_.size() == 1) return {maps_.front().get(), path};
  throw Refusal(404, "several maps are served: write /maps/NAME/" + path[0] + "; /maps lists the names");
}

HttpResponse MapService::answerRoute(const Route& route, const HttpRequest& request, const Target& target) {
  const bool is_trial = route.map != nullptr && route.segments == std::vector<std::string>{"rules", "trial"};
  const bool may_post = route.map != nullptr && route.segments == std::vector<std::string>{"sparql"};
  if (is_trial && request.method != "POST")
    throw Refusal(405, request.method + " is not allowed here; send rules by POST", {{"Allow", "POST"}});
  requireMethod(request, may_post || is_trial);
  const WorkSlots::Slot slot = slots_.take(request.has_hung_up);
  if (route.map == nullptr) return answerOwn(route);
  const std::string before = route.map->state();
  bool is_unfinished = false;
  HttpResponse response;
  try {
    is_unfinished = options_.warns_of_unfinished && route.map->isUnfinished();
    response = answerMap(route, request, target);
  } catch (...) {
    response = responseTo(std::current_exception());
  }
  response.headers.emplace_back(kStateHeader, stateOfAnswer(before, route.map->state()));
  if (is_unfinished && response.status < 400)
    response.headers.emplace_back(kWarningHeader,
                                  "the build of this map is unfinished: the answer is that of some of its scans");
  return response;
}

HttpResponse MapService::answerOwn(const Route& route) const {
  const std::vector<std::string>& path = route.segments;
  if (path.empty()) {
    std::vector<std::string> names;
    for (const auto& map : maps_) names.push_back(map->name());
    return startPage(names);
  }
  if (path != std::vector<std::string>{"maps"}) throw Refusal(404, "there is no such resource; / lists what there is");
  std::string body = R"({"maps":[)";
  for (std::size_t i = 0; i < maps_.size(); ++i) body += (i == 0 ? "" : ",") + mapSummaryJson(*maps_[i]);
  return {200, "application/json", body + "]}\n", {}};
}

HttpResponse MapService::pageOf(ServedMap& map) const {
  if (!options_.page) return startPage({map.name()});
  std::shared_ptr<const std::string> page;
  map.withReader([&](const mapping::MapReader& reader) {
    const auto make = [&] { return std::make_shared<const std::string>(options_.page(reader, map.name())); };
    page = std::static_pointer_cast<const std::string>(map.keptOrMade(reader.quads(), "page of " + map.name(), make));
  });
  return {200, "text/html; charset=utf-8", *page, {}};
}

HttpResponse MapService::answerMap(const Route& route, const HttpRequest& request, const Target& target) {
  const ResourceRequest asked{request, target, options_.request};
  const std::vector<std::string>& path = route.segments;
  ServedMap& map = *route.map;
  if (path.empty()) return {200, "application/json", mapSummaryJson(map) + "\n", {}};
  const std::string& first = path[0];
  const std::string second = path.size() > 1 ? path[1] : "", third = path.size() > 2 ? path[2] : "";
  if (path.size() == 1) {
    const std::string endpoint = "http://" + urlHostOf(request) + "/maps/" + percentEncoded(map.name()) + "/sparql";
    if (first == "sparql") return answerSparql(map, request, target, endpoint, options_);
    if (first == "graph") return answerGraph(map, asked);
    if (first == "objects") return answerObjects(map, asked);
    if (first == "questions") return answerQuestionList(questions_);
    if (first == "tasks") return answerTaskList(questions_);
    if (first == "page") return pageOf(map);
  }
  if (path.size() == 2 && first == "objects") return answerObject(map, asked, second);
  if (path.size() == 2 && first == "questions") return answerQuestion(map, asked, questions_, second);
  if (path.size() == 2 && first == "rules" && second == "trial") return answerRuleTrial(map, asked, options_.token);
  if (path.size() == 2 && first == "tasks") return answerTask(map, asked, questions_, second);
  if (path.size() == 3 && first == "objects" && third == "explanation") return answerExplanation(map, asked, second);
  if (path.size() == 3 && first == "tiles") return answerPointTile(map, asked, second, third);
  if (path.size() == 3 && first == "objects" && third == "points") return answerPoints(map, asked, second);
  throw Refusal(404, "a map has no such resource; /maps/NAME/page lists what there is");
}

}  // namespace cluxel::serve
