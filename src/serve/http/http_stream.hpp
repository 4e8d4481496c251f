// SPDX-License-Identifier: Apache-2.0
// One connection as a stream that bounds what a client may send and how long it may take.
#pragma once

#include <httplib.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <string>

#include "serve/http/http_server.hpp"

namespace cluxel::serve {

class HttpStream : public httplib::Stream {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Fault { None, HeaderTooLarge, TooSlow };

  /// `stop_event` becomes readable when the server stops.
  HttpStream(int socket, int stop_event, const HttpOptions& options);

  /// Waits until a request begins; false when the client has gone, was idle for too long, or the server stops.
  bool awaitRequest();
  void beginBody();
  /// Nothing more is read as a request: what the client still sends belongs to one that was refused.
  void closeAfterResponse() { must_close_ = true; }
  bool mustClose() const { return must_close_; }
  Fault fault() const { return fault_; }
  /// cpp-httplib has read no request line then, and sends no response.
  bool hasOverlongRequestLine() const { return fault_ == Fault::HeaderTooLarge && is_request_line_; }
  /// The other end has closed the connection, or its sending half, which is taken for the same. Never blocks.
  bool hasHungUp() const;
  double secondsSinceBegin() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }
  /// Closes the connection such that the client can still read the response.
  void close();

  bool is_readable() const override { return begin_ < end_; }
  bool is_writable() const override { return true; }
  ssize_t read(char* out, std::size_t size) override;
  ssize_t write(const char* bytes, std::size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  static constexpr std::size_t kOtherName = 99;
  bool fill();
  ssize_t readRequestLine(char* out);
  ssize_t readHeaderLine(char* out);

  int socket_, stop_event_;
  const HttpOptions& options_;
  std::array<char, 16384> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
  std::size_t header_bytes_ = 0;
  std::size_t escape_at_ = 0;   ///< bytes already passed on of "%3F", which replaces a second question mark
  std::size_t range_name_ = 0;  ///< bytes of "range" that the header line began with; kOtherName: with something else
  bool is_header_ = true, is_request_line_ = true, has_query_ = false, must_close_ = false;
  Fault fault_ = Fault::None;
  Clock::time_point begun_, deadline_;
};

}  // namespace cluxel::serve
