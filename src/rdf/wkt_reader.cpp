// SPDX-License-Identifier: Apache-2.0
// A recursive descent parser of well-known text.
#include "rdf/wkt_reader.hpp"

#include <charconv>
#include <cmath>
#include <string>

namespace cluxel::rdf {
namespace {

constexpr int kMaxWktNesting = 16;

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  bool geometry(WktShape& out, int depth = 0) {
    if (depth > kMaxWktNesting) return false;
    const std::string tag = word();
    std::string next = peekWord();
    if (next == "Z" || next == "M" || next == "ZM") word(), next = peekWord();
    if (next == "EMPTY") return !word().empty() && isTag(tag);
    if (tag == "POINT") return open() && coordinate(out.points) && close();
    if (tag == "LINESTRING") return path(out.lines.emplace_back()) && out.lines.back().size() >= 2;
    if (tag == "POLYGON") return polygon(out);
    if (tag == "MULTIPOINT") return list([&] { return multiPoint(out.points); });
    if (tag == "MULTILINESTRING") return list([&] { return path(out.lines.emplace_back()); });
    if (tag == "MULTIPOLYGON") return list([&] { return polygon(out); });
    if (tag == "GEOMETRYCOLLECTION") return list([&] { return geometry(out, depth + 1); });
    return false;
  }

  bool done() {
    space();
    return text_.empty();
  }
  bool hasHeight() const { return has_height_; }

 private:
  static bool isTag(const std::string& tag) {
    return tag == "POINT" || tag == "LINESTRING" || tag == "POLYGON" || tag.starts_with("MULTI") ||
           tag == "GEOMETRYCOLLECTION";
  }
  void space() {
    while (!text_.empty() && (text_[0] == ' ' || text_[0] == '\t' || text_[0] == '\n' || text_[0] == '\r')) {
      text_.remove_prefix(1);
    }
  }
  bool take(char c) {
    space();
    if (text_.empty() || text_[0] != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  bool open() { return take('('); }
  bool close() { return take(')'); }
  std::string peekWord() {
    space();
    std::string result;
    for (const char c : text_) {
      if (c >= 'a' && c <= 'z') {
        result += static_cast<char>(c - 'a' + 'A');
      } else if (c >= 'A' && c <= 'Z') {
        result += c;
      } else {
        break;
      }
    }
    return result;
  }
  std::string word() {
    std::string result = peekWord();
    text_.remove_prefix(result.size());
    return result;
  }
  bool number(double& out) {
    space();
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), out);
    if (error != std::errc{} || !std::isfinite(out)) return false;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return true;
  }
  /// x y and up to two more coordinates, which are dropped.
  bool coordinate(WktPath& out) {
    double x = 0, y = 0, dropped = 0;
    if (!number(x) || !number(y)) return false;
    space();
    for (int i = 0; i < 2 && !text_.empty() && text_[0] != ',' && text_[0] != ')'; ++i) {
      if (!number(dropped)) return false;
      has_height_ = true;
      space();
    }
    out.emplace_back(x, y);
    return true;
  }
  template <typename Item>
  bool list(Item item) {
    if (!open()) return false;
    do {
      if (!item()) return false;
    } while (take(','));
    return close();
  }
  bool path(WktPath& out) {
    return list([&] { return coordinate(out); });
  }
  bool polygon(WktShape& out) {
    std::vector<WktPath>& rings = out.polygons.emplace_back();
    return list([&] {
      if (!path(rings.emplace_back())) return false;
      return rings.back().size() >= 4 && rings.back().front() == rings.back().back();
    });
  }
  bool multiPoint(WktPath& out) {
    if (!open()) return coordinate(out);
    return coordinate(out) && close();
  }

  std::string_view text_;
  bool has_height_ = false;
};

std::string_view withoutSpace(std::string_view text) {
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<WktText> splitWkt(std::string_view text) {
  std::string_view rest = withoutSpace(text);
  if (!rest.starts_with('<')) return WktText{{}, rest};
  const std::size_t end = rest.find('>');
  if (end == std::string_view::npos) return std::nullopt;
  return WktText{rest.substr(0, end + 1), withoutSpace(rest.substr(end + 1))};
}

std::optional<WktShape> readWkt(std::string_view text) {
  Reader reader(text);
  WktShape shape;
  if (!reader.geometry(shape) || !reader.done()) return std::nullopt;
  shape.has_height = reader.hasHeight();
  return shape;
}

}  // namespace cluxel::rdf
