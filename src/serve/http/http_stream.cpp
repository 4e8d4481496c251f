// SPDX-License-Identifier: Apache-2.0
// Reads and writes of a socket with deadlines.
#include "serve/http/http_stream.hpp"

#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

namespace cluxel::serve {

namespace {

int waitFor(int socket, short events, HttpStream::Clock::time_point deadline) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - HttpStream::Clock::now());
    pollfd entry{socket, events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
    if (ready >= 0 || errno != EINTR) return ready;
  }
}

using NameOf = int (*)(int, sockaddr*, socklen_t*);

void addressOf(int socket, NameOf name_of, std::string& ip, int& port) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  std::array<char, NI_MAXHOST> host{};
  std::array<char, NI_MAXSERV> service{};
  auto* plain = reinterpret_cast<sockaddr*>(&address);
  if (name_of(socket, plain, &length) != 0 || ::getnameinfo(plain, length, host.data(), host.size(), service.data(),
                                                            service.size(), NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return;
  ip = host.data();
  port = std::atoi(service.data());
}

}  // namespace

HttpStream::HttpStream(int socket, int stop_event, const HttpOptions& options)
    : socket_(socket), stop_event_(stop_event), options_(options), begun_(Clock::now()) {
  const int yes = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

bool HttpStream::awaitRequest() {
  const auto idle_end = Clock::now() + options_.idle_time;
  while (begin_ == end_) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(idle_end - Clock::now());
    if (left.count() <= 0) return false;
    std::array<pollfd, 2> entries{{{socket_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
    const int ready = ::poll(entries.data(), entries.size(), static_cast<int>(left.count()));
    if (ready < 0 && errno != EINTR) return false;
    if (ready > 0 && entries[0].revents == 0) return false;  // the server stops
    if (ready > 0) break;
  }
  is_header_ = is_request_line_ = true;
  has_query_ = false;
  header_bytes_ = escape_at_ = range_name_ = 0;
  begun_ = Clock::now();
  deadline_ = begun_ + options_.header_time;
  return begin_ < end_ || fill();
}

void HttpStream::beginBody() {
  is_header_ = false;
  deadline_ = Clock::now() + options_.body_time;
}

/// Reads what is there into the empty buffer; false at the end of the stream and when the time is over.
bool HttpStream::fill() {
  if (waitFor(socket_, POLLIN, deadline_) <= 0) {
    fault_ = Fault::TooSlow;
    must_close_ = true;
    return false;
  }
  const ssize_t got = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
  begin_ = 0;
  end_ = got > 0 ? static_cast<std::size_t>(got) : 0;
  if (got <= 0) must_close_ = true;
  return got > 0;
}

ssize_t HttpStream::read(char* out, std::size_t size) {
  if (is_header_ && header_bytes_ >= options_.max_header_bytes) {
    fault_ = Fault::HeaderTooLarge;
    must_close_ = true;
    return -1;
  }
  if (begin_ == end_ && !fill()) return fault_ == Fault::TooSlow ? -1 : 0;
  if (is_request_line_) return readRequestLine(out);
  if (is_header_) return readHeaderLine(out);
  const std::size_t count = std::min(size, end_ - begin_);
  std::memcpy(out, buffer_.data() + begin_, count);
  begin_ += count;
  return static_cast<ssize_t>(count);
}

/// One byte. A query may hold question marks, which cpp-httplib refuses: all but the first are passed on as %3F.
ssize_t HttpStream::readRequestLine(char* out) {
  constexpr std::string_view escaped = "%3F";
  const char byte = buffer_[begin_];
  const bool is_escaped = byte == '?' && has_query_;
  *out = is_escaped ? escaped[escape_at_] : byte;
  ++header_bytes_;
  escape_at_ = is_escaped ? (escape_at_ + 1) % escaped.size() : 0;
  if (escape_at_ > 0) return 1;
  ++begin_;
  has_query_ = has_query_ || byte == '?';
  is_request_line_ = byte != '\n';
  return 1;
}

/// One byte. cpp-httplib refuses ranges that it cannot read, where RFC 9110 has them ignored, and one answer asked for
/// in many ranges would be large: the header Range is passed on as "Range-".
ssize_t HttpStream::readHeaderLine(char* out) {
  constexpr std::string_view name = "range";
  const char byte = buffer_[begin_];
  ++header_bytes_;
  if (byte == ':' && range_name_ == name.size()) {
    range_name_ = kOtherName;
    *out = '-';
    return 1;
  }
  *out = byte;
  ++begin_;
  if (byte == '\n')
    range_name_ = 0;
  else
    range_name_ = range_name_ < name.size() && (byte | 0x20) == name[range_name_] ? range_name_ + 1 : kOtherName;
  return 1;
}

ssize_t HttpStream::write(const char* bytes, std::size_t size) {
  std::size_t written = 0;
  while (written < size) {
    if (waitFor(socket_, POLLOUT, Clock::now() + options_.write_time) <= 0) {
      must_close_ = true;
      return -1;
    }
    const ssize_t count = ::send(socket_, bytes + written, size - written, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (count <= 0) {
      must_close_ = true;
      return -1;
    }
    written += static_cast<std::size_t>(count);
  }
  return static_cast<ssize_t>(written);
}

bool HttpStream::hasHungUp() const {
  pollfd entry{socket_, POLLRDHUP, 0};
  return ::poll(&entry, 1, 0) > 0;
}

/// Closing a socket with unread bytes resets the connection, and the client may then lose the response. What is still
/// sent is read for a moment.
void HttpStream::close() {
  constexpr std::chrono::milliseconds linger{200};
  constexpr int max_pieces = 64;
  ::shutdown(socket_, SHUT_WR);
  const auto end = Clock::now() + linger;
  for (int i = 0; must_close_ && i < max_pieces && waitFor(socket_, POLLIN, end) > 0; ++i)
    if (::recv(socket_, buffer_.data(), buffer_.size(), MSG_DONTWAIT) <= 0) break;
  ::close(socket_);
}

void HttpStream::get_remote_ip_and_port(std::string& ip, int& port) const {
  addressOf(
      socket_, [](int s, sockaddr* a, socklen_t* l) { return ::getpeername(s, a, l); }, ip, port);
}

void HttpStream::get_local_ip_and_port(std::string& ip, int& port) const {
  addressOf(
      socket_, [](int s, sockaddr* a, socklen_t* l) { return ::getsockname(s, a, l); }, ip, port);
}

}  // namespace cluxel::serve
