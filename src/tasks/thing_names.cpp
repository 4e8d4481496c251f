// SPDX-License-Identifier: Apache-2.0
// Names are looked up among the ids of objects and primitives; nothing else of the map is read.
#include "tasks/thing_names.hpp"

#include <algorithm>
#include <charconv>

#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/statements/overruled_objects.hpp"
#include "mapping/thing_history.hpp"
#include "mapping/things/ended_names.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rules/language/rule_condition.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::size_t kMinDigits = 4;  ///< of a hash

/// The name without what tables and other formats write around it: <IRI>, map:object/HEX.
std::string plainName(const std::string& written) {
  std::string_view name = trimmed(written);  // lines of CSV end in CR LF
  if (name.starts_with('<') && name.ends_with('>')) name = name.substr(1, name.size() - 2);
  if (name.starts_with("map:")) name.remove_prefix(4);
  return std::string(name);
}

bool isNamed(const std::string& kind, const ContentHash& id, const std::string& name) {
  const std::string hex = id.hex(), path = kind + "/" + hex;
  return path.starts_with(name) || hex.starts_with(name) || name.ends_with("/map/" + path);
}

/// The place of the only item that has the name; none when there is none.
std::optional<std::size_t> findOne(const std::vector<ContentHash>& ids, const std::string& kind,
                                   const std::string& name) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!isNamed(kind, ids[i], name)) continue;
    if (found) throw Error(ErrorKind::NotFound, "'" + name + "' names more than one " + kind + "; write more digits");
    found = i;
  }
  return found;
}

std::optional<std::size_t> numberIn(std::string_view digits) {
  std::size_t number = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool is_number = fault == std::errc() && end == digits.data() + digits.size();
  return is_number ? std::optional(number) : std::nullopt;
}

/// "#17", or "17" where it is too short for a hash.
std::optional<std::size_t> objectNumber(const std::string& name, std::size_t objects) {
  const bool is_marked = name.starts_with('#');
  if (!is_marked && name.size() >= kMinDigits) return std::nullopt;
  const auto number = numberIn(std::string_view(name).substr(is_marked ? 1 : 0));
  if (number && *number >= objects)
    throw Error(ErrorKind::NotFound, "there is no object #" + std::to_string(*number) + ": the map has " +
                                         std::to_string(objects) + " objects, numbered from 0");
  if (!number && is_marked) throw Error(ErrorKind::InvalidArgument, "'" + name + "' is not the number of an object");
  return number;
}

std::optional<mapping::FormerName> formerName(const mapping::MapReader& map, const std::string& name) {
  return mapping::Lineage(map.quads(), map.objectIds()).find(name);
}

/// The most special class of a resource that is neither object nor primitive, such as a place or a way; empty when
/// there is none.
std::string classOfOther(const mapping::MapReader& map, const std::string& name) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  std::string found;
  for (const std::string& iri : {name, std::string(rdf::vocabulary::kMap) + name})
    for (const std::string_view graph : {rdf::vocabulary::kGraphObserved, rdf::vocabulary::kGraphInferred})
      for (const Quad& quad : mapping::quadsAbout(map.quads(), iri, graph))
        if (quad.predicate.text == rdf::vocabulary::rdf("type") &&
            (found.empty() || ontology.isA(quad.object.text, found)))
          found = quad.object.text;
  return mapping::localName(found);
}

[[noreturn]] void failUnknown(const mapping::MapReader& map, const std::string& name) {
  for (const mapping::OverruledObject& overruled : map.overruled())
    if (!overruled.now && isNamed("object", overruled.by_rules.id, name))
      throw Error(ErrorKind::NotFound, "object/" + overruled.by_rules.id.hex() +
                                           " was removed by an operator statement; it is back once that is withdrawn");
  if (const std::string class_name = classOfOther(map, name); !class_name.empty())
    throw Error(ErrorKind::NotFound, "'" + name + "' is " + rules::withArticle(class_name) +
                                         ", neither an object nor a primitive: no rule for objects decided about it; "
                                         "a query tells its facts");
  const std::vector<ContentHash>& objects = map.objectIds();
  const auto isPresent = [&](const ContentHash& id) { return std::binary_search(objects.begin(), objects.end(), id); };
  if (const auto ended = mapping::endOf(map.quads(), isPresent, name)) throw Error(ErrorKind::NotFound, textOf(*ended));
  throw Error(ErrorKind::NotFound, "nothing in the map is named '" + name + "'; the question objects.rq lists objects");
}

NamedThing find(const mapping::MapReader& map, const std::string& name) {
  const std::vector<ContentHash>& objects = map.objectIds();
  NamedThing named;
  const auto take = [&](std::size_t number) { named.object = objects[number], named.number = number; };
  if (const auto number = objectNumber(name, objects.size())) {
    take(*number);
    return named;
  }
  if (name.size() < kMinDigits)
    throw Error(ErrorKind::InvalidArgument,
                "'" + name + "' is too short: write the number of an object, or at least four digits of a hash");
  if (const auto number = findOne(objects, "object", name)) take(*number);
  const bool is_whole_hash = name.size() >= 2 * sizeof(ContentHash::bytes);  // names one thing
  if (!named.object || !is_whole_hash)
    if (const auto number = findOne(map.primitiveIds(), "primitive", name))
      named.primitive = map.primitiveIds()[*number];
  // Four digits or more may be meant as a number too; a hash that begins so comes first, "#" makes it a number.
  if (!named.object && !named.primitive)
    if (const auto number = numberIn(name); number && *number < objects.size()) take(*number);
  if (!named.object && !named.primitive)
    if (const auto former = formerName(map, name)) take(*findOne(objects, "object", former->object.hex()));
  if (named.object && named.primitive)
    throw Error(ErrorKind::NotFound, "'" + name + "' names an object and a primitive; write more digits, or object/" +
                                         name + " or primitive/" + name);
  if (!named.object && !named.primitive) failUnknown(map, name);
  return named;
}

}  // namespace

NamedThing thingNamed(const mapping::MapReader& map, const std::string& written) {
  return find(map, plainName(written));
}

std::string nameNote(const mapping::MapReader& map, const std::string& written) {
  const std::string name = plainName(written);
  if (name.size() < kMinDigits || name.starts_with('#') || findOne(map.objectIds(), "object", name)) return {};
  if (findOne(map.primitiveIds(), "primitive", name)) return {};
  const auto former = formerName(map, name);
  return former ? former->meaning + " is now object/" + former->object.hex() : "";
}

std::size_t objectNamed(const mapping::MapReader& map, const std::string& name) {
  const NamedThing named = thingNamed(map, name);
  if (!named.object) throw Error(ErrorKind::NotFound, "'" + name + "' names a primitive, not an object");
  return named.number;
}

}  // namespace cluxel::tasks
