// SPDX-License-Identifier: Apache-2.0
// Reads and extends the stored spatial index.
#include "rdf/store/geometry_index.hpp"

#include <algorithm>
#include <cstring>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

constexpr std::string_view kGeometryTable = "geometries", kIndexHead = "head";
constexpr std::uint32_t kIndexForm = 1;
/// A run of at most this many literals is always merged with the next one.
constexpr std::size_t kSmallRun = 64;

/// A stored tree: its key and its number of literals.
struct StoredRun {
  std::uint32_t number = 0, literals = 0;
};

/// The block that lists the trees. All terms up to `covered` are in them.
struct IndexHead {
  std::uint32_t covered = 0, next_number = 1;
  std::vector<StoredRun> runs;
};

std::string keyOfRun(std::uint32_t number) {
  return "run " + std::to_string(number);
}

IndexHead storedHead(const ReadTransaction& transaction) {
  IndexHead head;
  const auto bytes = transaction.block(kGeometryTable, kIndexHead);
  if (!bytes) return head;
  std::vector<std::uint32_t> words(bytes->size() / sizeof(std::uint32_t));
  if (!words.empty()) std::memcpy(words.data(), bytes->data(), words.size() * sizeof(std::uint32_t));
  // An index of a later version is made anew in memory.
  if (words.size() < 3 || words.size() % 2 == 0 || words[0] != kIndexForm) return head;
  head.covered = words[1];
  head.next_number = words[2];
  for (std::size_t i = 3; i < words.size(); i += 2) head.runs.push_back({words[i], words[i + 1]});
  return head;
}

void storeHead(WriteTransaction& transaction, const IndexHead& head) {
  std::vector<std::uint32_t> words = {kIndexForm, head.covered, head.next_number};
  for (const StoredRun& run : head.runs) words.insert(words.end(), {run.number, run.literals});
  transaction.putBlock(kGeometryTable, kIndexHead,
                       {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint32_t)});
}

std::string_view requireRun(const ReadTransaction& transaction, std::uint32_t number) {
  if (const auto bytes = transaction.block(kGeometryTable, keyOfRun(number))) return *bytes;
  throw Error(ErrorKind::StoreUnavailable,
              "the map is damaged: a part of its index of geometries is missing; run `cluxel doctor` for the location");
}

std::vector<std::uint32_t> copied(std::string_view bytes) {
  std::vector<std::uint32_t> words((bytes.size() + 3) / 4);
  if (!bytes.empty()) std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

/// Adds the geometries among the terms `first` to `last`. Cost: 20 ns a term and 0.5 us a geometry.
void addTerms(const QuadReader& reader, TermId first, TermId last, GeometryEntries& entries) {
  const auto datatype = reader.idOf(Term::iri(std::string(vocabulary::kGeo) + "wktLiteral"));
  if (!datatype) return;
  for (TermId id = first; id <= last; ++id) {
    if (reader.valueOf(id).datatype == *datatype) entries.add(id, reader.viewOf(id).text);
  }
}

}  // namespace

GeometryIndex::GeometryIndex(const QuadReader& reader, const ReadTransaction& transaction) {
  const auto terms = static_cast<TermId>(reader.termCount());
  IndexHead head = storedHead(transaction);
  if (head.covered > terms) head = {};
  for (const StoredRun& run : head.runs) open(requireRun(transaction, run.number));
  GeometryEntries rest;
  addTerms(reader, head.covered + 1, terms, rest);
  made_ = rest.size();
  if (made_ > 0) {
    copies_.push_back(copied(packedTree(rest)));
    const auto& words = copies_.back();
    open({reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint32_t)});
  }
  std::sort(loose_.begin(), loose_.end());
}

void GeometryIndex::open(std::string_view bytes) {
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(FlatBox) != 0) {
    copies_.push_back(copied(bytes));
    bytes = {reinterpret_cast<const char*>(copies_.back().data()), bytes.size()};
  }
  trees_.emplace_back(bytes);
  boxed_ += trees_.back().size();
  loose_.insert(loose_.end(), trees_.back().loose().begin(), trees_.back().loose().end());
}

std::vector<TermId> GeometryIndex::meeting(const FlatBox& query_box) const {
  std::vector<TermId> found = loose_;
  for (const PackedTree& tree : trees_) tree.meeting(query_box, found);
  std::sort(found.begin(), found.end());
  return found;
}

namespace {

constexpr auto isFartherOpen = [](const auto& a, const auto& b) { return a.distance > b.distance; };

}  // namespace

NearestGeometries::NearestGeometries(std::shared_ptr<const GeometryIndex> index, const FlatBox& from)
    : index_(std::move(index)), from_(from) {
  for (const PackedTree& tree : index_->trees()) {
    if (tree.levelCount() > 0) push(tree, tree.levelCount() - 1, 0);
  }
}

void NearestGeometries::push(const PackedTree& tree, std::size_t level, std::size_t box) {
  open_.push_back({from_.distanceTo(tree.level(level)[box]), &tree, level, box});
  std::push_heap(open_.begin(), open_.end(), isFartherOpen);
}

bool NearestGeometries::next(Found& found) {
  while (!open_.empty()) {
    std::pop_heap(open_.begin(), open_.end(), isFartherOpen);
    const Open next = open_.back();
    open_.pop_back();
    if (next.level == 0) {
      found = {next.tree->literals()[next.box], next.distance};
      return true;
    }
    const auto [first, last] = next.tree->below(next.level, next.box);
    for (std::size_t i = first; i < last; ++i) push(*next.tree, next.level - 1, i);
  }
  return false;
}

namespace {

/// The entries by literal, so that two lists can be compared.
std::vector<GeometryEntries::Boxed> byLiteral(std::vector<GeometryEntries::Boxed> boxed) {
  std::sort(boxed.begin(), boxed.end(), [](const auto& a, const auto& b) { return a.literal < b.literal; });
  return boxed;
}

bool areSame(const GeometryEntries& a, const GeometryEntries& b) {
  const auto isSame = [](const GeometryEntries::Boxed& one, const GeometryEntries::Boxed& other) {
    return one.literal == other.literal && one.box == other.box;
  };
  const auto left = byLiteral(a.boxed), right = byLiteral(b.boxed);
  std::vector<TermId> loose_left = a.loose, loose_right = b.loose;
  std::sort(loose_left.begin(), loose_left.end());
  std::sort(loose_right.begin(), loose_right.end());
  return std::equal(left.begin(), left.end(), right.begin(), right.end(), isSame) && loose_left == loose_right;
}

}  // namespace

std::vector<std::string> faultsOfGeometryIndex(const QuadReader& reader, const ReadTransaction& transaction) {
  const IndexHead head = storedHead(transaction);
  std::vector<std::string> faults;
  if (head.covered > reader.termCount()) {
    faults.push_back("the index of geometries names more terms than there are");
    return faults;
  }
  GeometryEntries stored, expected;
  for (const StoredRun& run : head.runs) {
    const std::vector<std::uint32_t> words = copied(requireRun(transaction, run.number));
    const PackedTree tree({reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint32_t)});
    const std::string name = "part " + std::to_string(run.number) + " of the index of geometries";
    if (tree.size() + tree.loose().size() != run.literals) faults.push_back(name + " has a wrong count");
    if (!tree.isTight()) faults.push_back(name + " has boxes that do not fit those below them");
    tree.appendTo(stored);
  }
  addTerms(reader, 1, head.covered, expected);
  if (!areSame(stored, expected))
    faults.push_back("the index of geometries holds " + std::to_string(stored.size()) +
                     " entries that are not those of the " + std::to_string(expected.size()) +
                     " geometries of the map");
  return faults;
}

void extendGeometryIndex(WriteTransaction& transaction, const QuadReader& reader, GeometryEntries made, TermId first,
                         TermId last) {
  IndexHead head = storedHead(transaction);
  if (head.covered >= first) {  // not an index of these terms
    for (const StoredRun& run : head.runs) transaction.eraseBlock(kGeometryTable, keyOfRun(run.number));
    head.runs.clear();
    head.covered = 0;
  }
  if (made.size() == 0 && head.covered == 0) return;  // there are no geometries yet
  if (head.covered + 1 < first) addTerms(reader, head.covered + 1, first - 1, made);
  head.covered = last;
  if (made.size() > 0) {
    while (!head.runs.empty() && head.runs.back().literals <= std::max(kSmallRun, 2 * made.size())) {
      const std::vector<std::uint32_t> words = copied(requireRun(transaction, head.runs.back().number));
      PackedTree({reinterpret_cast<const char*>(words.data()), words.size() * sizeof(std::uint32_t)}).appendTo(made);
      transaction.eraseBlock(kGeometryTable, keyOfRun(head.runs.back().number));
      head.runs.pop_back();
    }
    transaction.putBlock(kGeometryTable, keyOfRun(head.next_number), packedTree(made));
    head.runs.push_back({head.next_number++, static_cast<std::uint32_t>(made.size())});
  }
  storeHead(transaction, head);
}

}  // namespace cluxel::rdf
