// SPDX-License-Identifier: Apache-2.0
// One HTTP request and its response as values, so that handlers are tested without sockets.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cluxel::serve {

using HeaderList = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method = "GET";
  std::string target = "/";  ///< path and query as sent: "/maps/campus/sparql?query=…"
  HeaderList headers = {};   ///< names in lower case
  std::string body = {};
  std::string client = {};  ///< the address of the other end
  /// Whether the client has hung up meanwhile, so that nobody waits for the response. Absent: nobody can tell.
  std::function<bool()> has_hung_up = {};

  bool isAbandoned() const { return has_hung_up && has_hung_up(); }

  /// The values of a header, joined by commas; empty when it is absent. `name` is in lower case.
  std::string header(std::string_view name) const {
    std::string joined;
    for (const auto& [key, value] : headers)
      if (key == name) joined += (joined.empty() ? "" : ", ") + value;
    return joined;
  }
};

struct HttpResponse {
  int status = 200;
  std::string content_type = {};  ///< empty: there is no body
  std::string body = {};
  HeaderList headers = {};
};

/// What the access log says about a request.
struct AccessEntry {
  std::string client, method, target;
  int status = 0;
  std::size_t bytes = 0;  ///< of the body
  double seconds = 0;     ///< from the first byte of the request to the response
};

}  // namespace cluxel::serve
