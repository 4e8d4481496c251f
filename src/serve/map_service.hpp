// SPDX-License-Identifier: Apache-2.0
// The service: routes requests to the resources of maps, within its limits. It knows no sockets.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/installation/data_home.hpp"
#include "serve/http/http_message.hpp"
#include "serve/http/rate_limit.hpp"
#include "serve/http/url.hpp"
#include "serve/http/work_slots.hpp"
#include "serve/served_map.hpp"
#include "serve/service_options.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::serve {

/// Thread-safe. Every request reads one snapshot: the newest commit at its begin.
///
///   /                                    what there is, as a plain page
///   /maps                                the maps
///   /maps/NAME                           one of them
///   /maps/NAME/page                      its page
///   /maps/NAME/sparql                    SPARQL 1.1 Protocol and Service Description
///   /maps/NAME/graph                     Graph Store Protocol, reading
///   /maps/NAME/objects[/ID[/explanation|/points]]
///   /maps/NAME/questions[/QUESTION]
///   /maps/NAME/tasks[/TASK]
///   /maps/NAME/tiles/X/Y                 all points of a tile of the page
///   /maps/NAME/rules/trial               what posted rules would change
/// When one map is served, what follows /maps/NAME may stand alone: /sparql.
class MapService {
 public:
  /// Throws Error when a map cannot be read.
  MapService(const std::vector<MapArgument>& maps, const DataHome& home, ServiceOptions options);

  /// Never throws.
  HttpResponse handle(const HttpRequest& request);
  /// Files of maps whose build is not finished.
  std::vector<std::filesystem::path> unfinishedMaps() const;
  /// Releases old commits, so that writers can reuse their pages. To be called now and then.
  void tidy();

 private:
  struct Route {
    ServedMap* map = nullptr;           ///< none: a resource of the service
    std::vector<std::string> segments;  ///< below the map, or all of them
  };
  HttpResponse dispatch(const HttpRequest& request);
  void requireHost(const HttpRequest& request) const;
  HttpResponse preflight(const HttpRequest& request) const;
  void allowOrigin(const HttpRequest& request, HttpResponse& response) const;
  Route routeOf(const Target& target);
  HttpResponse answerRoute(const Route& route, const HttpRequest& request, const Target& target);
  HttpResponse answerOwn(const Route& route) const;
  HttpResponse answerMap(const Route& route, const HttpRequest& request, const Target& target);
  HttpResponse pageOf(ServedMap& map) const;

  ServiceOptions options_;
  std::vector<tasks::Question> questions_;
  std::vector<std::unique_ptr<ServedMap>> maps_;
  RateLimit rate_;
  WorkSlots slots_;
};

}  // namespace cluxel::serve
