// SPDX-License-Identifier: Apache-2.0
// Any bytes as what a client sends: the stream gives them to the HTTP parser unchanged but for question marks in the
// request line, of which all but the first become %3F, and never more of a header than is allowed.
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "serve/http/http_stream.hpp"

namespace {

using namespace cluxel::serve;

constexpr std::size_t kMaxInput = 60'000;  // fits into the buffer of a socket

void require(bool holds) {
  if (!holds) std::abort();
}

std::string expectedFrom(std::string_view sent) {
  std::string expected;
  bool is_request_line = true, has_query = false;
  for (const char c : sent) {
    if (c == '?' && is_request_line && has_query)
      expected += "%3F";
    else
      expected += c;
    has_query = has_query || c == '?';
    is_request_line = is_request_line && c != '\n';
  }
  return expected;
}

std::string readAll(HttpStream& stream, std::size_t chunk) {
  std::string text;
  std::vector<char> bytes(chunk);
  while (true) {
    const ssize_t count = stream.read(bytes.data(), bytes.size());
    if (count <= 0) return text;
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || size > kMaxInput) return 0;
  const std::size_t chunk = 1 + data[0] % 97U;
  const std::string_view sent(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::array<int, 2> ends{};
  require(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
  require(::send(ends[0], sent.data(), sent.size(), 0) == static_cast<ssize_t>(sent.size()));
  require(::shutdown(ends[0], SHUT_WR) == 0);
  const int stop_event = ::eventfd(0, 0);
  HttpOptions options;
  options.max_header_bytes = 512;
  HttpStream stream(ends[1], stop_event, options);
  require(stream.awaitRequest() == !sent.empty());
  const std::string expected = expectedFrom(sent), got = sent.empty() ? "" : readAll(stream, chunk);
  require(expected.starts_with(got) && got.size() <= options.max_header_bytes + chunk);
  require(got == expected || stream.fault() == HttpStream::Fault::HeaderTooLarge);
  require(stream.mustClose());
  for (const int open : {ends[0], ends[1], stop_event}) ::close(open);
  return 0;
}
