// SPDX-License-Identifier: Apache-2.0
// Names that the map had and that lead to no present object, or to several: what has become of them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

struct EndedName {
  std::string meaning;                  ///< "object/HEX" or "thing/HEX"
  bool went_on = false;                 ///< under other names
  std::string time = {};                ///< xsd:dateTime of the last change that ended it; empty when it is not known
  std::string operation = {};           ///< of this change, such as "extend"; empty when it is not known
  std::vector<ContentHash> later = {};  ///< the present objects that came from it, ascending: none, or several
};

/// Whether an object is there now.
using IsPresent = std::function<bool(const ContentHash& object)>;

/// What became of a name: the IRI of a thing or of an object, or as people write it: thing/HEX, object/HEX, or the
/// first digits of a hash. Absent when the map never had it, when one present object has it or continues it
/// (Lineage::find()), and when digits mean several things. Cost of an IRI: that of its own lineage; of digits: all
/// names of the history.
std::optional<EndedName> endOf(const rdf::QuadReader& quads, const IsPresent& is_present, const std::string& name);

/// "object/HEX ended at TIME by `extend`, and nothing that there is continues it".
std::string textOf(const EndedName& name);

}  // namespace cluxel::mapping
