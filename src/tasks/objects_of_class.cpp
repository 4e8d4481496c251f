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

/// Visits the objects of the class as the graphs name them, until `visit` returns false. One may come more than once.
template <typename Visit>
void forEachOfClass(const rdf::QuadReader& quads, const std::string& class_iri, const Visit& visit) {
  const auto type = quads.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto class_id = quads.idOf(Term::iri(class_iri));
  if (!type || !class_id) return;
  const auto history = quads.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  rdf::QuadCursor cursor = quads.scan({.s = {}, .p = type, .o = class_id, .g = {}}, rdf::QuadOrder::Posg);
  for (rdf::QuadIds quad; cursor.next(quad);) {
    if (history && quad.g == *history) continue;
    const rdf::TermView subject = quads.viewOf(quad.s);
    if (subject.kind != TermKind::Iri) continue;
    if (const auto object = objectOfIri(subject.text); object && !visit(*object)) return;
  }
}

}  // namespace

std::vector<ContentHash> objectsOfClass(const rdf::QuadReader& quads, const std::string& class_iri) {
  std::vector<ContentHash> objects;
  forEachOfClass(quads, class_iri, [&](const ContentHash& object) {
    objects.push_back(object);
    return true;
  });
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  return objects;
}

bool isOfClass(const rdf::QuadReader& quads, const ContentHash& object, const std::string& class_iri) {
  const auto subject = quads.idOf(Term::iri(rdf::iriOfObject(object)));
  const auto type = quads.idOf(Term::iri(rdf::vocabulary::rdf("type")));
  const auto class_id = quads.idOf(Term::iri(class_iri));
  if (!subject || !type || !class_id) return false;
  const auto history = quads.idOf(Term::iri(rdf::vocabulary::kGraphHistory));
  rdf::QuadCursor cursor = quads.scan({.s = subject, .p = type, .o = class_id, .g = {}});
  for (rdf::QuadIds quad; cursor.next(quad);)
    if (!history || quad.g != *history) return true;
  return false;
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

bool hasObjectOfClass(const mapping::MapReader& map, const std::string& class_iri) {
  const std::vector<ContentHash>& held = map.objectIds();
  bool is_found = false;
  forEachOfClass(map.quads(), class_iri, [&](const ContentHash& object) {
    is_found = std::binary_search(held.begin(), held.end(), object);
    return !is_found;
  });
  return is_found;
}

}  // namespace cluxel::tasks
