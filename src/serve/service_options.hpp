// SPDX-License-Identifier: Apache-2.0
// What the service allows: limits, updates, other origins, and the page.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::serve {

/// The limits of one request.
struct RequestLimits {
  std::chrono::milliseconds deadline{30'000};                ///< of a query, from its start
  std::uint64_t max_rows = 0;                                ///< 0: no limit
  std::uint64_t max_memory_bytes = std::uint64_t{1} << 30U;  ///< held by a query
  std::uint64_t max_answer_bytes = std::uint64_t{1} << 28U;  ///< of the body of a response
};

/// The limits of all requests.
struct LoadLimits {
  std::size_t running = 2;  ///< requests that compute at once
  std::size_t waiting = 128;
  std::chrono::milliseconds patience{10'000};  ///< how long a request waits for its turn
  double per_second = 0;                       ///< requests of one client; 0: no limit
};

struct ServiceOptions {
  RequestLimits request = {};
  LoadLimits load = {};
  std::string token = {};                         ///< permits updates to who sends it; empty: no updates
  std::vector<std::string> allowed_origins = {};  ///< other web sites whose pages may read answers; "*": all
  /// The accepted values of Host without port. Empty: all. It keeps web sites from reading a service on this machine
  /// under a name of theirs.
  std::vector<std::string> host_names = {};
  bool warns_of_unfinished = true;  ///< by a header of answers from a map whose build is not finished
  /// The HTML text of a map's page, made once for each commit; absent: a plain page that lists what the service
  /// answers.
  std::function<std::string(const mapping::MapReader& map, const std::string& map_name)> page = {};
};

}  // namespace cluxel::serve
