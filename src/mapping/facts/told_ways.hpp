// SPDX-License-Identifier: Apache-2.0
// What the stored facts about ways followed from: a change names and compares only those that follow from something
// else.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

enum class WayKind : std::uint8_t { Region, Junction, Way, Kerb };

struct ToldWay {
  ContentHash cause;  ///< hash of its kind and of all that its facts follow from
  ContentHash name;   ///< its IRI is made of it
  WayKind kind = WayKind::Way;
  auto operator<=>(const ToldWay&) const = default;
};

/// Absent when the map has no list, one of another version, or one of an earlier commit, after which another program
/// may have told other facts. Throws Error (StoreUnavailable) when the block is malformed.
std::optional<std::vector<ToldWay>> storedToldWays(const rdf::ReadTransaction& transaction);
void storeToldWays(rdf::WriteTransaction& transaction, const std::vector<ToldWay>& ways);
/// To be called before each other commit that changes the map and leaves the facts about ways as they are, and the
/// freed ground that they follow from. A commit without it makes the next change tell all ways.
void keepToldWays(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
