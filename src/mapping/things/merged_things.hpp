// SPDX-License-Identifier: Apache-2.0
// Merged maps: which names their objects have in them and keep, and what their histories say of things.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mapping/change/object_changes.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// How one map names its objects.
struct NamesOfMap {
  std::set<std::string> activities;             ///< IRIs of all that made the map
  std::map<ContentHash, std::string> thing_of;  ///< by present object
  std::set<std::string> things;                 ///< the same names

  /// Whether the other map holds all that made this one, and more: it says what has become of the names since.
  bool wentInto(const NamesOfMap& other) const;
};
/// Cost: that of the present objects.
NamesOfMap namesOfMap(const rdf::QuadReader& quads, const std::vector<ContentHash>& present);

/// The names that objects have in maps.
struct NamesInMaps {
  std::map<ContentHash, std::set<std::string>> of_object;
  std::set<std::string> outdated;  ///< those that objects have only in maps that went into another one
};
/// A map that went into another one does not count for an object or for a name that the other has.
NamesInMaps namesIn(const std::vector<NamesOfMap>& maps);

/// For each object of a merge the name that it keeps, if it had one. `names`: those of it in the maps. As many objects
/// as can keep one; each name goes to one of them. Of several names the oldest stays. Where two objects have one name
/// alone, and the same, that with most members keeps it (ties: the smallest hash). Cost: n log n in the names.
std::vector<std::optional<Thing>> keptNames(const std::vector<ObjectMembers>& objects,
                                            const std::map<ContentHash, std::vector<Thing>>& names);

/// Adds the histories of maps, which are activities, lineage and things, to `into`, a copy of the map with number
/// `base`. The history of a map that went into another one is left out: the other has it, and what the other does not
/// have of it is out of date.
void copyHistories(const std::vector<NamesOfMap>& names, const std::vector<const rdf::QuadReader*>& maps,
                   std::size_t base, rdf::WriteTransaction& into);
/// Leaves at most one replacement of each thing, and no circle of them: of several the one by which fewest steps lead
/// to a thing that has an object (ties: the smallest IRI). Cost: linear in the things that have ended.
void keepOneReplacementEach(rdf::WriteTransaction& transaction);

}  // namespace cluxel::mapping
