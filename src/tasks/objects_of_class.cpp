// SPDX-License-Identifier: Apache-2.0
// Reads the facts of rdf:type that have the class, in every graph that queries see.
#include "tasks/objects_of_class.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

/// A rule or an update may make any name below that of objects.
std::optional<ContentHash> objectOfIri(std::string_view iri) {
  static const std::string path = rdf::mapIri("object", "");
  if (!iri.starts_with(path)) return std::nullopt;
  const std::string_view digits = iri.substr(path.size());
  const bool is_hash = digits.size() == 2 * ContentHash{}.bytes.size() &&
                       digits.find_first_not_of("0123456789abcdef") == std::string_view::npos;
  return is_hash ? std::optional(ContentHash::fromHex(digits)) : std::nullopt;
}

}  // namespace

std::vector<ContentHash> objectsOfClass(const rdf::QuadReader& quads, const std::string& class_iri) {
  const auto type = quads.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto class_id = quads.idOf(Term::iri(class_iri));
  if (!type || !class_id) return {};
  const auto history = quads.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  std::vector<ContentHash> objects;
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = type, .o = class_id, .g = {}}, rdf::QuadOrder::Posg);
  for (rdf::QuadIds quad; cursor.next(quad);) {
    if (history && quad.g == *history) continue;
    const rdf::TermView subject = quads.viewOf(quad.s);
    if (subject.kind != TermKind::Iri) continue;
    if (const auto object = objectOfIri(subject.text)) objects.push_back(*object);
  }
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  return objects;
}

std::vector<std::uint32_t> objectsOfClass(const mapping::MapReader& map, const std::string& class_iri) {
  const std::vector<ContentHash>& held = map.objectIds();
  std::vector<std::uint32_t> numbers;
  for (const ContentHash& object : objectsOfClass(map.quads(), class_iri)) {
    const auto place = std::lower_bound(held.begin(), held.end(), object);
    if (place != held.end() && *place == object) numbers.push_back(static_cast<std::uint32_t>(place - held.begin()));
  }
  return numbers;
}

}  // namespace cluxel::tasks
