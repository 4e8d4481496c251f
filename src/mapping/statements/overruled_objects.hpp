// SPDX-License-Identifier: Apache-2.0
// Objects that a statement changed or removed, as the rules made them: stored by object, with the cluxels of each tile,
// so that a change elsewhere leaves them as they are.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/statements/applied_statements.hpp"
#include "perception/segments/scene.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

struct OverruledRecord {
  struct Part {
    std::string part_class;
    std::vector<ContentHash> primitives;
    std::map<perception::TileKey, std::vector<std::uint32_t>> cluxels;  ///< numbers within the tile, ascending
  };

  ContentHash by_rules;            ///< its name by the rules
  std::optional<ContentHash> now;  ///< its name in the map; none when it was removed
  std::string class_iri, rule_id;
  double confidence = 0;
  bool is_class_wide = false;
  std::vector<Part> parts;
};

/// Those with cluxels of it.
perception::TileSet tilesOf(const OverruledRecord& record);
OverruledRecord recordOf(const OverruledObject& object, const perception::Scene& scene);

/// Ascending by the names that the rules gave. Throws Error (StoreUnavailable) when they cannot be read.
std::vector<OverruledRecord> overruledRecords(const rdf::ReadTransaction& transaction);
void putOverruled(rdf::WriteTransaction& transaction, const OverruledRecord& record);
void eraseOverruled(rdf::WriteTransaction& transaction, const ContentHash& by_rules);

/// Makes the map hold these, and no others.
void storeOverruled(rdf::WriteTransaction& transaction, const std::vector<OverruledObject>& overruled,
                    const perception::Scene& scene);
/// With the numbers of the scene of the whole map. Cost, where there are any: about 5 us a tile of the map.
std::vector<OverruledObject> storedOverruled(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
