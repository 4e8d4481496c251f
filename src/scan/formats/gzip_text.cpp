// SPDX-License-Identifier: Apache-2.0
// zlib's inflate over memory, member by member.
#include "scan/formats/gzip_text.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <memory>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

namespace {

constexpr int kGzipOnly = 16 + MAX_WBITS;

struct InflateEnd {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

/// Unpacks one gzip member from the front of `bytes` onto `text`; returns how many bytes it took.
std::size_t unpackMember(std::string_view bytes, const std::string& file, std::uint64_t offset, std::size_t max_bytes,
                         std::string& text) {
  z_stream stream{};
  if (inflateInit2(&stream, kGzipOnly) != Z_OK)
    throw Error(ErrorKind::BudgetExceeded, "no memory left to unpack " + file);
  const std::unique_ptr<z_stream, InflateEnd> guard(&stream);
  std::array<char, 1 << 16> buffer;
  std::size_t taken = 0;
  for (int result = Z_OK; result != Z_STREAM_END;) {
    const std::size_t piece = std::min<std::size_t>(bytes.size() - taken, 1U << 30);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    stream.avail_in = static_cast<uInt>(piece);
    stream.next_out = reinterpret_cast<Bytef*>(buffer.data());
    stream.avail_out = static_cast<uInt>(buffer.size());
    result = inflate(&stream, Z_NO_FLUSH);
    taken += piece - stream.avail_in;
    const std::size_t made = buffer.size() - stream.avail_out;
    if (made > max_bytes - text.size())
      refuseByte(file, offset + taken, "unpacks to more than " + std::to_string(max_bytes) + " bytes");
    text.append(buffer.data(), made);
    if (result == Z_BUF_ERROR) refuseByte(file, offset + taken, "the gzip data are cut off");
    if (result != Z_OK && result != Z_STREAM_END)
      refuseByte(file, offset + taken,
                 std::string("the gzip data are damaged: ") + (stream.msg ? stream.msg : "zlib refuses them"));
  }
  return taken;
}

}  // namespace

std::string unpackedText(std::string_view bytes, const std::string& file, std::size_t max_bytes) {
  if (!bytes.starts_with("\x1f\x8b")) return std::string(bytes);
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) at += unpackMember(bytes.substr(at), file, at, max_bytes, text);
  return text;
}

}  // namespace cluxel::scan
