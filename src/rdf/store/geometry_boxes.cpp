// SPDX-License-Identifier: Apache-2.0
// Packs and reads R-trees of WKT literals.
#include "rdf/store/geometry_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "cluxel/error.hpp"
#include "rdf/wkt_reader.hpp"

namespace cluxel::rdf {
namespace {

constexpr float kFarAway = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kTreeForm = 1;

/// The header of a tree. The boxes of all levels follow, then the literals and the loose ones.
struct TreeHead {
  std::uint32_t form = kTreeForm, boxed = 0, loose = 0, unused = 0;
};

float roundedDown(double value) {
  const auto near = static_cast<float>(value);
  return near > value ? std::nextafter(near, -kFarAway) : near;
}

float roundedUp(double value) {
  const auto near = static_cast<float>(value);
  return near < value ? std::nextafter(near, kFarAway) : near;
}

/// Calls `take(x, y)` for every point.
template <typename Take>
void forEachPoint(const WktShape& shape, const Take& take) {
  const auto walk = [&take](const WktPath& path) {
    for (const auto& [x, y] : path) take(x, y);
  };
  walk(shape.points);
  for (const WktPath& line : shape.lines) walk(line);
  for (const auto& rings : shape.polygons) std::for_each(rings.begin(), rings.end(), walk);
}

FlatBox covering(std::span<const FlatBox> boxes) {
  FlatBox all{kFarAway, kFarAway, -kFarAway, -kFarAway};
  for (const FlatBox& box : boxes)
    all = {std::min(all.min_x, box.min_x), std::min(all.min_y, box.min_y), std::max(all.max_x, box.max_x),
           std::max(all.max_y, box.max_y)};
  return all;
}

/// Sorts into vertical slices of whole nodes, and each slice from bottom to top. Ties go by literal, so that equal
/// entries give equal bytes.
void sortIntoTiles(std::vector<GeometryEntries::Boxed>& boxed) {
  const auto by_x = [](const auto& a, const auto& b) {
    return std::tuple(a.box.min_x, a.literal) < std::tuple(b.box.min_x, b.literal);
  };
  const auto by_y = [](const auto& a, const auto& b) {
    return std::tuple(a.box.min_y, a.literal) < std::tuple(b.box.min_y, b.literal);
  };
  const double nodes = std::ceil(static_cast<double>(boxed.size()) / PackedTree::kFanOut);
  const auto slice = static_cast<std::size_t>(std::ceil(std::sqrt(nodes))) * PackedTree::kFanOut;
  std::sort(boxed.begin(), boxed.end(), by_x);
  for (std::size_t first = 0; first < boxed.size(); first += slice)
    std::sort(boxed.begin() + static_cast<std::ptrdiff_t>(first),
              boxed.begin() + static_cast<std::ptrdiff_t>(std::min(first + slice, boxed.size())), by_y);
}

std::size_t boxesAbove(std::size_t boxes) {
  return (boxes + PackedTree::kFanOut - 1) / PackedTree::kFanOut;
}

template <typename T>
void appendAll(std::string& bytes, std::span<const T> values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

[[noreturn]] void failOnTree() {
  throw Error(ErrorKind::StoreUnavailable,
              "the map is damaged: its index of geometries is malformed; run `cluxel doctor` for the location");
}

template <typename T>
std::span<const T> takeSpan(std::string_view& bytes, std::size_t count) {
  if (bytes.size() / sizeof(T) < count) failOnTree();
  const std::span<const T> values{reinterpret_cast<const T*>(bytes.data()), count};
  bytes.remove_prefix(count * sizeof(T));
  return values;
}

}  // namespace

FlatBox FlatBox::around(double min_x, double min_y, double max_x, double max_y) {
  return {roundedDown(min_x), roundedDown(min_y), roundedUp(max_x), roundedUp(max_y)};
}

double FlatBox::distanceTo(const FlatBox& other) const {
  const double dx = std::max({0.0F, min_x - other.max_x, other.min_x - max_x});
  const double dy = std::max({0.0F, min_y - other.max_y, other.min_y - max_y});
  return std::sqrt(dx * dx + dy * dy) * (1 - 1e-6);  // differences of floats are rounded
}

void GeometryEntries::add(TermId literal, std::string_view wkt) {
  const auto text = splitWkt(wkt);
  const auto shape = text && text->reference_system.empty() ? readWkt(text->shape) : std::nullopt;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  double min_x = kFar, min_y = kFar, max_x = -kFar, max_y = -kFar;
  if (shape) {
    forEachPoint(*shape, [&](double x, double y) {
      min_x = std::min(min_x, x);
      min_y = std::min(min_y, y);
      max_x = std::max(max_x, x);
      max_y = std::max(max_y, y);
    });
  }
  const FlatBox box = FlatBox::around(min_x, min_y, max_x, max_y);
  const bool has_box =
      std::isfinite(box.min_x) && std::isfinite(box.min_y) && std::isfinite(box.max_x) && std::isfinite(box.max_y);
  if (has_box)
    boxed.push_back({box, literal});
  else
    loose.push_back(literal);
}

std::string packedTree(GeometryEntries& entries) {
  sortIntoTiles(entries.boxed);
  std::sort(entries.loose.begin(), entries.loose.end());
  std::string bytes;
  const TreeHead head{kTreeForm, static_cast<std::uint32_t>(entries.boxed.size()),
                      static_cast<std::uint32_t>(entries.loose.size()), 0};
  appendAll(bytes, std::span<const TreeHead>(&head, 1));
  std::vector<FlatBox> level;
  std::vector<TermId> literals;
  for (const GeometryEntries::Boxed& entry : entries.boxed) {
    level.push_back(entry.box);
    literals.push_back(entry.literal);
  }
  while (true) {
    appendAll(bytes, std::span<const FlatBox>(level));
    if (level.size() <= 1) break;
    std::vector<FlatBox> above;
    for (std::size_t i = 0; i < level.size(); i += PackedTree::kFanOut)
      above.push_back(
          covering(std::span<const FlatBox>(level).subspan(i, std::min(PackedTree::kFanOut, level.size() - i))));
    level = std::move(above);
  }
  appendAll(bytes, std::span<const TermId>(literals));
  appendAll(bytes, std::span<const TermId>(entries.loose));
  return bytes;
}

PackedTree::PackedTree(std::string_view bytes) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(FlatBox) != 0) failOnTree();
  const TreeHead head = takeSpan<TreeHead>(bytes, 1).front();
  if (head.form != kTreeForm) failOnTree();
  for (std::size_t boxes = head.boxed; boxes > 0; boxes = boxes == 1 ? 0 : boxesAbove(boxes))
    levels_.push_back(takeSpan<FlatBox>(bytes, boxes));
  literals_ = takeSpan<TermId>(bytes, head.boxed);
  loose_ = takeSpan<TermId>(bytes, head.loose);
  if (!bytes.empty()) failOnTree();
}

std::pair<std::size_t, std::size_t> PackedTree::below(std::size_t n, std::size_t box) const {
  const std::size_t first = box * kFanOut;
  return {first, std::min(first + kFanOut, levels_[n - 1].size())};
}

void PackedTree::meeting(const FlatBox& query_box, std::vector<TermId>& found) const {
  if (levels_.empty() || !levels_.back()[0].meets(query_box)) return;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{levels_.size() - 1, 0}};  // boxes that meet it
  while (!open.empty()) {
    const auto [n, box] = open.back();
    open.pop_back();
    if (n == 0) {
      found.push_back(literals_[box]);
      continue;
    }
    const auto [first, last] = below(n, box);
    for (std::size_t i = first; i < last; ++i) {
      if (levels_[n - 1][i].meets(query_box)) open.emplace_back(n - 1, i);
    }
  }
}

bool PackedTree::isTight() const {
  for (std::size_t n = 1; n < levels_.size(); ++n) {
    for (std::size_t box = 0; box < levels_[n].size(); ++box) {
      const auto [first, last] = below(n, box);
      if (covering(levels_[n - 1].subspan(first, last - first)) != levels_[n][box]) return false;
    }
  }
  return true;
}

void PackedTree::appendTo(GeometryEntries& entries) const {
  for (std::size_t i = 0; i < literals_.size(); ++i) entries.boxed.push_back({levels_[0][i], literals_[i]});
  entries.loose.insert(entries.loose.end(), loose_.begin(), loose_.end());
}

}  // namespace cluxel::rdf
