// SPDX-License-Identifier: Apache-2.0
// What the facts of primitives and objects followed from when they were written: a change computes them anew only where
// that differs.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Relations change with the neighbours of a thing, and the rest of its facts does not.
enum class Facet : std::uint8_t {
  Self,       ///< facts of all properties but relations
  Relations,  ///< facts of the properties of perception::relationInfos()
};

struct FactUnitKey {
  ContentHash id;  ///< of the primitive, object or cloud; zero: the facts of no other unit
  Facet facet = Facet::Self;
  auto operator<=>(const FactUnitKey&) const = default;
};

/// The facts about some resources that are computed together: those of a primitive, a cloud or a ground patch, or of an
/// object with its parts and observations. The unit of zero has all other facts, of every facet.
struct FactUnit {
  FactUnitKey key;
  ContentHash cause;                  ///< hash of all that the facts follow from; zero: they are always compared
  std::vector<rdf::TermId> subjects;  ///< ascending
};

/// Whether the stored units are those of the quads that the graph holds now.
bool haveFactUnits(const rdf::ReadTransaction& transaction, const rdf::QuadReader& quads, rdf::TermId graph);
/// Notes that they are; the graph's quads must be flushed.
void stampFactUnits(rdf::WriteTransaction& transaction, const rdf::QuadReader& quads, rdf::TermId graph);

std::optional<FactUnit> storedFactUnit(const rdf::ReadTransaction& transaction, const FactUnitKey& key);
/// All that are stored, ascending. Cost: about 1 us a unit.
std::vector<FactUnitKey> storedFactUnitKeys(const rdf::ReadTransaction& transaction);
void storeFactUnit(rdf::WriteTransaction& transaction, const FactUnit& unit);
void eraseFactUnit(rdf::WriteTransaction& transaction, const FactUnitKey& key);

/// The next computation compares all facts: others than those of the units were written.
void forgetFactUnits(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
