// SPDX-License-Identifier: Apache-2.0
// What people call things of a map.
#pragma once

#include <optional>
#include <string>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// An object or a primitive.
struct NamedThing {
  std::optional<ContentHash> object, primitive;
  std::size_t number = 0;  ///< of the object in MapReader::objectIds(), which is that in objects()
};

/// The object or primitive that has the name: its IRI (also in <> or as map:…), "object/…" or "primitive/…", the first
/// digits of its hash (four or more), the name of a thing, or an object's number ("17" or "#17"). Throws Error
/// (NotFound) when nothing or more than one resource has the name.
NamedThing thingNamed(const mapping::MapReader& map, const std::string& name);
/// The number in MapReader::objects() of the object that has the name. Throws Error (NotFound) when there is none.
std::size_t objectNamed(const mapping::MapReader& map, const std::string& name);
/// "thing/HEX is now object/HEX" for a name that is not the object's own; empty otherwise.
std::string nameNote(const mapping::MapReader& map, const std::string& name);

}  // namespace cluxel::tasks
