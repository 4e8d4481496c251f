// SPDX-License-Identifier: Apache-2.0
// Things: names that stay while objects gain and lose members. They are history and stand in graph `history`, which
// rules never see.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "mapping/change/object_changes.hpp"
#include "mapping/thing_history.hpp"
#include "mapping/things/merged_things.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// Whether an object that is not listed exists both before and after the change.
using IsInBoth = std::function<bool(const ContentHash& object)>;

/// Gives each object after a change its thing, and records splits, joins and ends. The part with most shared members
/// keeps a name (ties: the smallest hash). A join keeps the older name, of equally old ones that of the object with
/// most shared members, then the smaller. An object that comes back as it was gets its former name, if no other has it.
/// A new thing is named by the hash of its first object. `time` is an xsd:dateTime. Objects that are the same before
/// and after need not be given when `is_in_both` knows them. Cost: that of the objects given and of their history.
void writeThings(rdf::WriteTransaction& transaction, const std::string& time, const std::vector<ObjectMembers>& before,
                 const std::vector<ObjectMembers>& after, const IsInBoth& is_in_both = {});

/// The same of a merge, into which the histories of all maps were copied. `before`: the objects of all maps. `names`:
/// those that they have in the maps; where such an object is in the result, too, it keeps its name before others are
/// handed on (keptNames()).
void writeThingsOfMerge(rdf::WriteTransaction& transaction, const std::string& time,
                        const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after,
                        const NamesInMaps& names);

struct FormerName {
  ContentHash object;   ///< the present object
  std::string meaning;  ///< "was object/HEX" or "is thing/HEX", for people
};
/// Which things and objects continue which, read once for many names.
class Lineage {
 public:
  /// `present` are the objects that there are.
  Lineage(const rdf::QuadReader& quads, const std::vector<ContentHash>& present);

  /// The present object of a thing, or the one that continues a former object. `name`: an IRI, thing/HEX, object/HEX,
  /// or the first digits of a hash (four or more). Absent when there is none, or several. Cost of an IRI: that of its
  /// own lineage; of digits: all things.
  std::optional<FormerName> find(const std::string& name) const;

 private:
  /// What a name may mean: a thing, or a former object.
  struct Meaning {
    std::set<std::string> things;
    std::string text;
  };
  Meaning meaningOf(const std::string& name) const;

  Things things_;
  std::map<std::string, std::string> times_;             ///< of all things
  std::map<std::string, ContentHash> object_of_;         ///< present ones, by thing
  std::multimap<std::string, std::string> later_;        ///< thing → thing that was derived from it
  std::multimap<std::string, std::string> replaced_by_;  ///< thing that has ended → thing that continues it
};

}  // namespace cluxel::mapping
