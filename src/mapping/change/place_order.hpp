// SPDX-License-Identifier: Apache-2.0
// The order in which scans of a large area are changed: a batch should change few tiles that others change, too.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

namespace cluxel::mapping {

/// Sorts items from one end of the longer side of their area to the other, and those at one place by id.
template <typename Item, typename PlaceOf, typename IdOf>
void sortAlongLongerSide(std::vector<Item>& items, const PlaceOf& place_of, const IdOf& id_of) {
  Eigen::AlignedBox2d area;
  for (const Item& item : items) area.extend(Eigen::Vector2d(place_of(item)));
  const Eigen::Index axis = !items.empty() && area.sizes().y() > area.sizes().x() ? 1 : 0;
  const auto key = [&](const Item& item) { return std::pair(Eigen::Vector2d(place_of(item))[axis], id_of(item)); };
  std::sort(items.begin(), items.end(), [&](const Item& a, const Item& b) { return key(a) < key(b); });
}

}  // namespace cluxel::mapping
