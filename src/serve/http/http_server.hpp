// SPDX-License-Identifier: Apache-2.0
// An HTTP/1.1 server: sockets, connections and their limits. What requests mean is the handler's.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "serve/http/http_message.hpp"

namespace cluxel::serve {

struct HttpOptions {
  std::string host = "127.0.0.1";
  int port = 0;                       ///< 0: a free one
  std::size_t max_connections = 256;  ///< at once; more get status 503
  std::size_t max_body_bytes = 1U << 20U;
  std::size_t max_header_bytes = 1U << 16U;       ///< of request line and headers
  std::chrono::milliseconds header_time{10'000};  ///< for request line and headers
  std::chrono::milliseconds body_time{30'000};    ///< for the body
  std::chrono::milliseconds write_time{30'000};   ///< without progress
  std::chrono::milliseconds idle_time{15'000};    ///< between requests
};

using HttpHandler = std::function<HttpResponse(const HttpRequest&)>;
using AccessLog = std::function<void(const AccessEntry&)>;  ///< called from several threads

/// Bound when it is made; answers while run() runs. `handler` must not throw. cpp-httplib parses and writes messages.
class HttpServer {
 public:
  /// Throws Error: InvalidArgument when the address cannot be used, StoreUnavailable when too many files are open.
  HttpServer(const HttpOptions& options, HttpHandler handler, AccessLog log = {});
  ~HttpServer();

  int port() const;
  /// Returns after stop(), when the requests in flight are answered. While the system is short of files or memory it
  /// takes no connections, and goes on after that. Throws Error (StoreUnavailable) when the system has closed the
  /// socket, when the requests in flight are answered. May be called once.
  void run();
  /// Takes no more connections, and ends idle ones. May be called from any thread, before run(), and again.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::serve
