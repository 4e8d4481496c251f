// SPDX-License-Identifier: Apache-2.0
// Reads Accept and Content-Type.
#include "serve/http/media_types.hpp"

#include <algorithm>
#include <charconv>

#include "base/ascii.hpp"

namespace cluxel::serve {

namespace {

/// The next part before `separator`, which is cut off `text`.
std::string_view nextPart(std::string_view& text, char separator) {
  const std::size_t cut = text.find(separator);
  const std::string_view part = text.substr(0, cut);
  text.remove_prefix(cut == std::string_view::npos ? text.size() : cut + 1);
  return trimmed(part);
}

std::optional<std::string> parameterOf(std::string_view content_type, std::string_view parameter) {
  nextPart(content_type, ';');
  while (!content_type.empty()) {
    std::string_view value = nextPart(content_type, ';');
    const std::string name = lowerCase(nextPart(value, '='));
    value = trimmed(value);
    if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    if (name == parameter) return lowerCase(value);
  }
  return std::nullopt;
}

struct MediaRange {
  std::string type, subtype;
  double quality = 1;

  /// 0: it does not match; else the larger the more specific.
  int match(std::string_view offer) const {
    const std::size_t cut = offer.find('/');
    if (type == "*" && subtype == "*") return 1;
    if (type != offer.substr(0, cut)) return 0;
    if (subtype == "*") return 2;
    return subtype == offer.substr(cut + 1) ? 3 : 0;
  }
};

/// One element of an Accept header. None when it is malformed; the caller then skips this element only.
std::optional<MediaRange> rangeOf(std::string_view text) {
  MediaRange range;
  const std::string type = mediaTypeOf(text);
  const std::size_t cut = type.find('/');
  if (cut == std::string::npos) return std::nullopt;
  range.type = type.substr(0, cut);
  range.subtype = type.substr(cut + 1);
  const auto quality = parameterOf(text, "q");
  if (!quality) return range;
  const char* end = quality->data() + quality->size();
  const auto [stop, error] = std::from_chars(quality->data(), end, range.quality);
  const bool is_read = error == std::errc() && stop == end && range.quality >= 0 && range.quality <= 1;
  return is_read ? std::optional(range) : std::nullopt;
}

}  // namespace

std::string mediaTypeOf(std::string_view content_type) {
  return lowerCase(nextPart(content_type, ';'));
}

std::string charsetOf(std::string_view content_type) {
  return parameterOf(content_type, "charset").value_or("");
}

std::optional<std::size_t> negotiate(std::string_view accept, const std::vector<std::string>& offers) {
  if (trimmed(accept).empty()) return offers.empty() ? std::nullopt : std::optional<std::size_t>(0);
  std::vector<MediaRange> ranges;
  while (!accept.empty())
    if (const auto range = rangeOf(nextPart(accept, ','))) ranges.push_back(*range);
  std::optional<std::size_t> best;
  double best_quality = 0;
  for (std::size_t i = 0; i < offers.size(); ++i) {
    int specific = 0;
    double quality = 0;
    for (const MediaRange& range : ranges)
      if (const int match = range.match(offers[i]); match > specific) {
        specific = match;
        quality = range.quality;
      }
    if (quality <= best_quality) continue;
    best_quality = quality;
    best = i;
  }
  return best;
}

}  // namespace cluxel::serve
