// SPDX-License-Identifier: Apache-2.0
// gzip by zlib, base64 by hand.
#include "tasks/view/page_blocks.hpp"

#include <zlib.h>

#include <limits>

#include "cluxel/error.hpp"

namespace cluxel::tasks {

std::string gzipped(std::string_view bytes) {
  constexpr int kGzip = 16, kWindow = 15, kLevel = 6, kMemory = 8;
  z_stream stream{};
  if (bytes.size() > std::numeric_limits<uInt>::max() ||
      deflateInit2(&stream, kLevel, Z_DEFLATED, kGzip + kWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ErrorKind::BudgetExceeded, "a block of " + std::to_string(bytes.size()) +
                                               " bytes cannot be compressed; take fewer points or free memory");
  std::string packed(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text.push_back(k <= count ? kDigits[group >> (18 - 6 * k) & 63U] : '=');
  }
  return text;
}

std::uint64_t writeBlock(const std::string& name, std::string_view bytes, const ByteSink& out) {
  const std::string element =
      "<script type=\"application/gzip+base64\" id=\"" + name + "\">" + base64(gzipped(bytes)) + "</script>\n";
  out(element);
  return element.size();
}

}  // namespace cluxel::tasks
