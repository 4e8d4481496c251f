// SPDX-License-Identifier: Apache-2.0
// Blocks as base64 of gzip.
#include "tasks/view/page_blocks.hpp"

#include "base/packing/gzip_bytes.hpp"

namespace cluxel::tasks {

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
