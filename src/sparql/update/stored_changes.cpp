// SPDX-License-Identifier: Apache-2.0
// Compares the changes of an operation with what the store holds.
#include "sparql/update/stored_changes.hpp"

#include <algorithm>

#include "rdf/vocabulary.hpp"

namespace cluxel::sparql {
namespace {

/// Memory that a change occupies until the writer's flush: the quad, and its entry in the lists.
constexpr std::size_t kBytesOfPending = 64;
/// Texts that the writer collects before they go to the store's pages.
constexpr std::size_t kPendingTexts = std::size_t{16} << 20U;

/// Shorter ones are part of kBytesOfPending.
constexpr std::size_t kLongTexts = 4096;

std::size_t bytesOfTexts(const Quad& quad) {
  return quad.subject.text.size() + quad.predicate.text.size() + quad.object.text.size();
}

std::optional<rdf::QuadIds> storedIds(const rdf::QuadReader& reader, const Quad& quad) {
  const auto s = reader.idOf(quad.subject), p = reader.idOf(quad.predicate), o = reader.idOf(quad.object);
  const auto g = quad.graph.text.empty() ? std::optional<rdf::TermId>(rdf::kNoTerm) : reader.idOf(quad.graph);
  if (!s || !p || !o || !g) return std::nullopt;
  const rdf::QuadIds ids{*s, *p, *o, *g};
  return reader.contains(ids) ? std::optional(ids) : std::nullopt;
}

std::vector<rdf::QuadIds> storedRemovals(const rdf::QuadReader& reader, const std::vector<ChangedQuad>& removed,
                                         Guard& guard) {
  std::vector<rdf::QuadIds> ids;
  guard.charge(removed.size() * kBytesOfPending);
  for (const ChangedQuad& change : removed) {
    guard.work(1);
    if (const auto stored = storedIds(reader, change.quad)) ids.push_back(*stored);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// The first graph with the triple that is neither writable nor outside the union; absent when there is none.
std::optional<rdf::TermId> lockedGraph(const rdf::QuadReader& reader, const Quad& quad,
                                       const std::vector<rdf::TermId>& open) {
  const auto s = reader.idOf(quad.subject), p = reader.idOf(quad.predicate), o = reader.idOf(quad.object);
  if (!s || !p || !o) return std::nullopt;
  rdf::QuadCursor cursor = reader.scan({.s = s, .p = p, .o = o, .g = {}}, rdf::QuadOrder::Spog);
  for (rdf::QuadIds found; cursor.next(found);)
    if (std::find(open.begin(), open.end(), found.g) == open.end()) return found.g;
  return std::nullopt;
}

}  // namespace

ChangeCounts applyChanges(const rdf::QuadReader& reader, rdf::QuadWriter& writer, const Changes& changes,
                          Guard& guard) {
  const std::vector<rdf::QuadIds> removed = storedRemovals(reader, changes.removed, guard);
  guard.charge(changes.inserted.size() * kBytesOfPending);
  std::vector<bool> stays(removed.size(), false);
  for (const ChangedQuad& change : changes.inserted) {
    guard.work(1);
    const auto stored = storedIds(reader, change.quad);
    if (!stored) continue;
    const auto at = std::lower_bound(removed.begin(), removed.end(), *stored);
    if (at != removed.end() && *at == *stored) stays[static_cast<std::size_t>(at - removed.begin())] = true;
  }
  const std::uint64_t before = reader.size();
  ChangeCounts counts;
  for (std::size_t i = 0; i < removed.size(); ++i) {
    if (stays[i]) continue;
    writer.remove(removed[i]);
    ++counts.deleted;
  }
  std::size_t pending = 0;
  for (const ChangedQuad& change : changes.inserted) {
    guard.work(1);
    const std::size_t bytes = bytesOfTexts(change.quad);
    if (bytes >= kLongTexts) guard.charge(bytes);  // the pages are held until the commit
    pending += bytes;
    writer.add(change.quad);
    if (pending < kPendingTexts) continue;
    writer.flush();
    pending = 0;
  }
  writer.flush();
  counts.inserted = reader.size() + counts.deleted - before;
  return counts;
}

std::optional<LockedTriples> lockedTriples(const rdf::QuadReader& reader, std::span<const ChangedQuad> removals,
                                           const std::vector<std::string>& writable_graphs, Guard& guard) {
  std::vector<rdf::TermId> open;
  if (const auto history = reader.idOf(Term::iri(rdf::vocabulary::kGraphHistory))) open.push_back(*history);
  for (const std::string& graph : writable_graphs)
    if (graph.empty())
      open.push_back(rdf::kNoTerm);
    else if (const auto id = reader.idOf(Term::iri(graph)))
      open.push_back(*id);
  LockedTriples locked;
  for (const ChangedQuad& removal : removals) {
    guard.work(1);
    if (removal.names_graph) continue;
    const auto graph = lockedGraph(reader, removal.quad, open);
    if (!graph) continue;
    if (locked.count++ > 0) continue;
    locked.first = removal.quad;
    locked.first.graph = reader.termOf(*graph);
  }
  locked.of = removals.size();
  return locked.count > 0 ? std::optional(locked) : std::nullopt;
}

}  // namespace cluxel::sparql
