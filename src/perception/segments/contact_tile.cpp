// SPDX-License-Identifier: Apache-2.0
// Contacts from edges of the cluxel graph and from nearby footprint cells.
#include "perception/segments/contact_tile.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>
#include <unordered_map>

#include "perception/simd_vector.hpp"

namespace cluxel::perception {

namespace {

/// Contacts by key. finish() sorts them, so that the result is independent of the hash table's order.
class ContactCollector {
 public:
  Contact& at(std::uint32_t from, std::uint32_t to_ring, std::uint32_t to) {
    const std::uint64_t key = std::uint64_t{from} << 36U | std::uint64_t{to_ring} << 32U | to;
    if (key == last_key_) return contacts_[last_];  // consecutive edges often connect the same components
    const auto [place, is_new] = number_.try_emplace(key, static_cast<std::uint32_t>(contacts_.size()));
    if (is_new) {
      Contact contact;
      contact.from = from, contact.to_ring = to_ring, contact.to = to;
      contact.gap = std::numeric_limits<double>::infinity();
      contacts_.push_back(contact);
    }
    last_key_ = key, last_ = place->second;
    return contacts_[last_];
  }

  std::vector<Contact> finish() {
    std::sort(contacts_.begin(), contacts_.end(), [](const Contact& a, const Contact& b) {
      return std::tie(a.from, a.to_ring, a.to) < std::tie(b.from, b.to_ring, b.to);
    });
    return std::move(contacts_);
  }

 private:
  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<Contact> contacts_;
  std::uint64_t last_key_ = ~std::uint64_t{0};
  std::uint32_t last_ = 0;
};

/// Whether most of a horizontal plane's footprint lies in the layer of the ground.
bool isFloor(const ComponentTile& tile, std::size_t component, double ground_layer_m) {
  if (tile.components[component].label != static_cast<std::uint32_t>(scan::PrimitiveLabel::HorizontalPlane))
    return false;
  const auto cells = tile.cellsOf(component);
  const auto low = std::count_if(cells.begin(), cells.end(), [&](const FootprintCell& cell) {
    return cell.highest < static_cast<float>(ground_layer_m);
  });
  return 2 * static_cast<std::size_t>(low) > cells.size();
}

/// For each tile of the ring, which of its components are floor.
std::array<std::vector<char>, 9> floorsOf(const Ring<ComponentTile>& components, const ContactParams& params) {
  std::array<std::vector<char>, 9> floors;
  for (std::size_t ring = 0; ring < floors.size(); ++ring)
    for (std::size_t c = 0; components[ring] != nullptr && c < components[ring]->size(); ++c)
      floors[ring].push_back(isFloor(*components[ring], c, params.ground_layer_m) ? 1 : 0);
  return floors;
}

/// The floor of a tile is a primitive of its own: one over the whole map would make every change a change of the map.
void addEdges(const Ring<ComponentTile>& components, const Ring<CluxelTile>& cluxels, const FeatureTile& graph,
              float largest_gap, const ContactParams& params, ContactCollector& contacts) {
  const CluxelTile& own = *cluxels[kRingCentre];
  const ComponentTile& own_components = *components[kRingCentre];
  const auto is_floor = floorsOf(components, params);
  for (std::uint32_t a = 0; a < own.size(); ++a)
    for (std::uint32_t e = graph.edge_offset[a]; e < graph.edge_offset[a + 1]; ++e) {
      const std::size_t ring = graph.edge_target[e].ring;
      const std::uint32_t b = graph.edge_target[e].index;
      const CluxelTile& other = *cluxels[ring];
      const std::uint32_t from = own_components.component_of[a], to = components[ring]->component_of[b];
      if (ring == kRingCentre && from == to) continue;
      if (ring != kRingCentre && is_floor[kRingCentre][from] != 0 && is_floor[ring][to] != 0) continue;
      const Eigen::Vector3f shift = ringShift(static_cast<int>(ring));
      const float gap = gapBetween(own.box_min[a], own.box_max[a], other.box_min[b] + shift, other.box_max[b] + shift);
      const bool same_label = own_components.components[from].label == components[ring]->components[to].label;
      Contact& contact = contacts.at(from, static_cast<std::uint32_t>(ring), to);
      ++contact.edges;
      if (same_label && gap <= largest_gap) ++contact.linked_edges;
      contact.gap = std::min<double>(contact.gap, gap);
    }
}

/// One component's part of a footprint cell, relative to the centre tile.
struct CellEntry {
  std::uint32_t ring = 0, component = 0;
  int x = 0, y = 0;  ///< cell, from the centre tile's corner
  Eigen::Vector3f min, max;
  float mean_z = 0;

  /// The component's number among all of the ring.
  std::int32_t name() const { return static_cast<std::int32_t>(component * 9 + ring); }
};

/// Cells of the ring within reach of the centre tile, as CSR over a padded grid.
class CellGrid {
 public:
  CellGrid(const Ring<ComponentTile>& components, const ContactParams& params)
      : reach_(static_cast<int>(std::ceil(params.near_m / kFootprintCell_m))),
        width_(kFootprintCellsPerTile + 2 * reach_) {
    std::vector<CellEntry> entries;
    for (std::size_t ring = 0; ring < components.size(); ++ring)
      if (components[ring] != nullptr) collect(*components[ring], ring, params, entries);
    offset_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_) + 1, 0);
    for (const CellEntry& entry : entries) ++offset_[slot(entry.x, entry.y) + 1];
    for (std::size_t i = 1; i < offset_.size(); ++i) offset_[i] += offset_[i - 1];
    std::vector<std::uint32_t> next(offset_.begin(), offset_.end() - 1);
    entries_.resize(entries.size());
    for (auto* values : {&low_[0], &low_[1], &low_[2], &high_[0], &high_[1], &high_[2]})
      values->resize(entries.size() + kLanes);
    x_.resize(entries.size() + kLanes);
    name_.resize(entries.size() + kLanes);
    for (const CellEntry& entry : entries) put(entry, next[slot(entry.x, entry.y)]++);
  }

  int reach() const { return reach_; }
  /// The half-open range of entries of the cells from x to last_x of one row.
  std::array<std::uint32_t, 2> range(int x, int last_x, int y) const {
    return {offset_[slot(x, y)], offset_[slot(last_x, y) + 1]};
  }
  const CellEntry& operator[](std::uint32_t entry) const { return entries_[entry]; }

  /// An entry compared with four others.
  struct Pairs {
    Floats gap;         ///< [m]
    Numbers touch;      ///< whether their x ranges touch; y is not tested
    Numbers are_apart;  ///< whether the components differ
  };
  /// Compares with four entries from `others` on; the last ones may be padding.
  [[gnu::always_inline]] Pairs compare(const CellEntry& own, std::uint32_t others) const {
    const auto along = [&](std::size_t axis) {
      const Floats below = own.min[static_cast<int>(axis)] - loadFloats(&high_[axis][others]);
      const Floats above = loadFloats(&low_[axis][others]) - own.max[static_cast<int>(axis)];
      const Floats gap = below > above ? below : above;
      return gap > 0.0F ? gap : Floats{};
    };
    const Floats dx = along(0), dy = along(1), dz = along(2);
    const Numbers step = loadNumbers(&x_[others]) - own.x;
    return {squareRoots(dx * dx + (dy * dy + dz * dz)), (step >= -1) & (step <= 1),
            loadNumbers(&name_[others]) != own.name()};
  }

 private:
  static Numbers loadNumbers(const std::int32_t* from) {
    Numbers four;
    std::memcpy(&four, from, sizeof four);
    return four;
  }

  std::size_t slot(int x, int y) const {
    return static_cast<std::size_t>(y + reach_) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(x + reach_);
  }

  void put(const CellEntry& entry, std::uint32_t place) {
    entries_[place] = entry;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis][place] = entry.min[static_cast<int>(axis)];
      high_[axis][place] = entry.max[static_cast<int>(axis)];
    }
    x_[place] = entry.x;
    name_[place] = entry.name();
  }

  void collect(const ComponentTile& tile, std::size_t ring, const ContactParams& params,
               std::vector<CellEntry>& entries) const {
    const Eigen::Vector3f shift = ringShift(static_cast<int>(ring));
    const int shift_x = (static_cast<int>(ring) % 3 - 1) * kFootprintCellsPerTile;
    const int shift_y = (static_cast<int>(ring) / 3 - 1) * kFootprintCellsPerTile;
    for (std::uint32_t c = 0; c < tile.size(); ++c)
      for (const FootprintCell& cell : tile.cellsOf(c)) {
        const int x = cell.x + shift_x, y = cell.y + shift_y;
        const int end = kFootprintCellsPerTile + reach_;
        if (x < -reach_ || x >= end || y < -reach_ || y >= end) continue;
        const bool is_plane =
            tile.components[c].label == static_cast<std::uint32_t>(scan::PrimitiveLabel::HorizontalPlane);
        if (is_plane && cell.highest < static_cast<float>(params.ground_layer_m)) continue;
        entries.push_back({static_cast<std::uint32_t>(ring), c, x, y, Eigen::Vector3f(cell.min.data()) + shift,
                           Eigen::Vector3f(cell.max.data()) + shift, cell.mean_z});
      }
  }

  int reach_, width_;
  std::vector<std::uint32_t> offset_;
  std::vector<CellEntry> entries_;
  std::array<std::vector<float>, 3> low_,
      high_;                            ///< corners of the entries' boxes, padded for SIMD reads from any entry
  std::vector<std::int32_t> x_, name_;  ///< of the entries, padded likewise
};

void addPair(const CellEntry& own, const CellEntry& other, float gap, bool touch, ContactCollector& contacts) {
  Contact& contact = contacts.at(own.component, other.ring, other.component);
  contact.gap = std::min<double>(contact.gap, gap);
  if (!touch) return;
  ++contact.overlaps;
  contact.height_difference += static_cast<double>(own.mean_z) - static_cast<double>(other.mean_z);
}

/// Compares an entry with the entries of one row of cells, four at a time; few are near.
void addRow(const CellGrid& grid, const CellEntry& own, int y, float near, ContactCollector& contacts) {
  const auto [first, last] = grid.range(own.x - grid.reach(), own.x + grid.reach(), y);
  const Numbers row_touches = Numbers{} - (std::abs(own.y - y) <= 1 ? 1 : 0);
  for (std::uint32_t others = first; others < last; others += kLanes) {
    const auto [gap, stacks_touch, are_apart] = grid.compare(own, others);
    const Numbers touch = stacks_touch & row_touches;
    unsigned found = lanesThatHold((touch | (gap <= near)) & are_apart) & firstLanes(last - others);
    for (; found != 0; found &= found - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(found));
      addPair(own, grid[others + lane], gap[lane], touch[lane] != 0, contacts);
    }
  }
}

void addCells(const CellGrid& grid, const ContactParams& params, ContactCollector& contacts) {
  const auto near = static_cast<float>(params.near_m);
  for (int y = 0; y < kFootprintCellsPerTile; ++y)
    for (int x = 0; x < kFootprintCellsPerTile; ++x) {
      const auto [first, last] = grid.range(x, x, y);
      for (std::uint32_t own = first; own < last; ++own) {
        if (grid[own].ring != kRingCentre) continue;
        for (int other_y = y - grid.reach(); other_y <= y + grid.reach(); ++other_y)
          addRow(grid, grid[own], other_y, near, contacts);
      }
    }
}

}  // namespace

void describe(ContactParams& params, ParameterVisitor& visitor) {
  visitor.real({"contact.near", "m", 0.1, 8, "pairs of primitives farther apart are not looked at"}, params.near_m);
  visitor.real({"contact.ground_layer", "m", 0, 5, "horizontal planes below this height above the ground are ground"},
               params.ground_layer_m);
}

ContactTile contactsOf(const Ring<ComponentTile>& components, const Ring<CluxelTile>& cluxels, const FeatureTile& graph,
                       const ComponentParams& component_params, const ContactParams& params) {
  ContactCollector contacts;
  addEdges(components, cluxels, graph, static_cast<float>(component_params.max_gap_m), params, contacts);
  addCells(CellGrid(components, params), params, contacts);
  ContactTile tile;
  tile.key = graph.key;
  tile.contacts = contacts.finish();
  return tile;
}

}  // namespace cluxel::perception
