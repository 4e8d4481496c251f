// SPDX-License-Identifier: Apache-2.0
// Buffers changes and merges them into the indexes on flush().
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/store/geometry_index.hpp"
#include "rdf/store/indexes/index_directories.hpp"
#include "rdf/store/indexes/index_orders.hpp"
#include "rdf/store/indexes/index_writer.hpp"
#include "rdf/store/number_entries.hpp"
#include "rdf/store/quad_reader_impl.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/terms/pending_terms.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

// Queries use ids from here on for computed terms.
constexpr TermId kMaxTerms = 0x8000'0000U;
constexpr std::size_t kMaxPendingQuads = 2'000'000;
constexpr std::size_t kMaxPendingTermBytes = std::size_t{512} << 20U;

}  // namespace

struct QuadChange {
  QuadIds quad;
  bool added = false;
};

/// A small cache of recent IRIs and their ids: predicates, graphs and the subjects of runs of statements repeat.
class RecentIris {
 public:
  struct Entry {
    std::string iri;
    TermId id = kNoTerm;
  };
  Entry& slotOf(std::string_view iri) {
    std::uint64_t tail = iri.size();
    std::memcpy(&tail, iri.data() + (iri.size() < 8 ? 0 : iri.size() - 8), std::min<std::size_t>(8, iri.size()));
    return slots_[(tail * 0x9E3779B97F4A7C15U) >> 56U];
  }

 private:
  std::array<Entry, 256> slots_;
};

/// A change divided by the kind of its objects.
struct QuadsByKind {
  QuadDifference links, numbers;
  QuadDifference others;  ///< than numbers
};

struct QuadWriter::Impl {
  WriteTransaction transaction;  ///< shares the write transaction
  QuadReader reader;
  PendingTerms terms;
  std::vector<QuadChange> changes;  ///< in call order
  std::unordered_map<std::string, TermId> datatypes;
  RecentIris recent;
  TermId next_id = kNoTerm;  ///< kNoTerm while no new term is pending, so that another writer can assign ids
  std::string record;
  ObjectKinds kinds;

  explicit Impl(WriteTransaction& from) : transaction(from), reader(from), kinds(from) {}

  ReadTransaction::Impl& state() const { return transaction.impl(); }
  TermId internIri(const Term& term);
  /// Of the term whose record is in `record`.
  TermId internRecord();
  void write(const std::function<void()>& work);
  void flushTerms();
  void flushGeometries(TermId first, TermId last);
  QuadDifference takeChanges();
  QuadsByKind byKind(const QuadDifference& difference);
  IndexTask taskFor(QuadOrder order);
  void flushQuads(const QuadDifference& difference);
};

TermId QuadWriter::Impl::internRecord() {
  const TermHash hash = hashOfRecord(record);
  if (const auto known = terms.find(hash, record)) return *known;
  StoreSnapshot& snapshot = snapshotOf(state());
  if (const auto stored = snapshot.idOf(hash, record, state())) {
    terms.insert(hash, record, *stored, false);
    return *stored;
  }
  if (next_id == kNoTerm) next_id = static_cast<TermId>(snapshot.termCount() + 1);
  if (next_id == kMaxTerms) throw Error(ErrorKind::StoreUnavailable, "the map is full: it holds 2^31 different terms");
  terms.insert(hash, record, next_id, true);
  return next_id++;
}

TermId QuadWriter::Impl::internIri(const Term& term) {
  if (term.text.empty()) return kNoTerm;
  RecentIris::Entry& slot = recent.slotOf(term.text);
  if (slot.id != kNoTerm && slot.iri == term.text) return slot.id;
  encodeTerm(term, kNoTerm, record);
  slot.id = internRecord();
  slot.iri = term.text;
  return slot.id;
}

/// After an error some tables and indexes have a change that others lack.
void QuadWriter::Impl::write(const std::function<void()>& work) {
  state().requireSound();
  try {
    work();
    ++state().generation;
  } catch (...) {
    state().has_failed = true;
    ++state().generation;
    throw;
  }
}

void QuadWriter::Impl::flushTerms() {
  std::vector<Key128> hashes;
  TermSumWriter sums(transaction);
  TermId first = kNoTerm;
  constexpr TermId kTermsBetweenPolls = 4096;
  for (const PendingTerms::Entry& entry : terms.entries()) {
    if (!entry.is_new) continue;
    if (entry.id % kTermsBetweenPolls == 0 && state().flush_poll) state().flush_poll();
    TermId id = entry.id;
    if (first == kNoTerm) first = id;
    MDB_val key{sizeof id, &id};
    MDB_val value = toVal(terms.record(entry));
    const int code = mdb_put(state().live(), state().table(Table::Terms), &key, &value, MDB_APPEND);
    if (code == MDB_KEYEXIST) throw std::logic_error("two quad writers write in one transaction at once");
    state().check(code, "write a term");
    hashes.push_back(keyOfTerm(entry.hash, id));
    sums.add(entry.hash, id);
  }
  sums.store();
  state().directories->noteTerms(hashes.size());
  std::array<IndexTask, 1> index{IndexTask{.index = Table::TermHashes, .sum = &state().sums.term_hashes}};
  applyTo(state(), index, hashes.size(), [&hashes](IndexTask& task) {
    std::sort(hashes.begin(), hashes.end());
    task.change.added = std::move(hashes);
  });
  if (first != kNoTerm) flushGeometries(first, next_id - 1);
  terms.clear();
  next_id = kNoTerm;
}

/// Adds the geometries among the new terms to the spatial index.
void QuadWriter::Impl::flushGeometries(TermId first, TermId last) {
  GeometryEntries made;
  const auto wkt = datatypes.find(std::string(vocabulary::kGeo) + "wktLiteral");
  for (const PendingTerms::Entry& entry : terms.entries()) {
    if (!entry.is_new || wkt == datatypes.end()) continue;
    const TermRecord term = decodeTerm(terms.record(entry));
    if (term.datatype == wkt->second) made.add(entry.id, term.text);
  }
  ++state().generation;  // the reader sees the new terms
  extendGeometryIndex(transaction, reader, std::move(made), first, last);
}

/// The last word about each quad counts.
QuadDifference QuadWriter::Impl::takeChanges() {
  const auto earlier = [](const QuadChange& a, const QuadChange& b) { return a.quad < b.quad; };
  if (!std::is_sorted(changes.begin(), changes.end(), earlier))
    std::stable_sort(changes.begin(), changes.end(), earlier);
  QuadDifference difference;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const bool last_word = i + 1 == changes.size() || changes[i + 1].quad != changes[i].quad;
    if (last_word) (changes[i].added ? difference.added : difference.removed).push_back(changes[i].quad);
  }
  changes.clear();
  return difference;
}

QuadsByKind QuadWriter::Impl::byKind(const QuadDifference& difference) {
  QuadsByKind divided;
  constexpr std::size_t kQuadsBetweenPolls = 4096;
  std::size_t seen = 0;
  const auto divide = [&](const std::vector<QuadIds>& quads, std::vector<QuadIds> QuadDifference::*list) {
    for (const QuadIds& quad : quads) {
      if (++seen % kQuadsBetweenPolls == 0 && state().flush_poll) state().flush_poll();
      const ObjectKind kind = kinds.of(quad.o);
      if (kind == ObjectKind::Link) (divided.links.*list).push_back(quad);
      (kind == ObjectKind::Number ? divided.numbers.*list : divided.others.*list).push_back(quad);
    }
  };
  divide(difference.added, &QuadDifference::added);
  divide(difference.removed, &QuadDifference::removed);
  return divided;
}

/// Without its change.
IndexTask QuadWriter::Impl::taskFor(QuadOrder order) {
  StoreSums& sums = state().sums;
  IndexTask task{.index = tableOf(order)};
  if (order == QuadOrder::Ospg) task.sum = &sums.links;
  if (order != QuadOrder::Spog) return task;
  task.sum = &sums.quads;
  task.journal = &state().journal;
  if (!state().environment->keepsNumbersApart()) return task;
  task.sum_of_numbers = &sums.numbers;
  task.is_number = [this](TermId object) { return kinds.known(object) == ObjectKind::Number; };
  return task;
}

void QuadWriter::Impl::flushQuads(const QuadDifference& difference) {
  const LmdbEnvironment& environment = *state().environment;
  const QuadsByKind divided = environment.omitsLiterals() ? byKind(difference) : QuadsByKind();
  const bool keeps_numbers_apart = environment.keepsNumbersApart();
  struct Part {
    QuadOrder order;
    const QuadDifference& quads;
  };
  // The longest first, so that no thread waits long.
  std::vector<Part> parts = {{QuadOrder::Posg, keeps_numbers_apart ? divided.others : difference},
                             {QuadOrder::Ospg, environment.omitsLiterals() ? divided.links : difference},
                             {QuadOrder::Gspo, difference},
                             {QuadOrder::Spog, difference}};
  if (keeps_numbers_apart) parts.push_back({QuadOrder::Psog, divided.numbers});
  std::vector<IndexTask> tasks;
  for (const Part& part : parts) tasks.push_back(taskFor(part.order));
  applyTo(state(), tasks, difference.added.size() + difference.removed.size(), [&](IndexTask& task) {
    const Part& part = parts[static_cast<std::size_t>(&task - tasks.data())];
    task.change = {keysOf(part.quads.added, part.order), keysOf(part.quads.removed, part.order)};
  });
}

QuadWriter::QuadWriter(WriteTransaction& transaction) : impl_(std::make_unique<Impl>(transaction)) {}
QuadWriter::~QuadWriter() = default;

TermId QuadWriter::intern(const Term& term) {
  if (term.kind == TermKind::Iri) return impl_->internIri(term);
  TermId datatype = kNoTerm;
  if (needsDatatypeId(term)) {
    const auto known = impl_->datatypes.find(term.datatype);
    datatype = known != impl_->datatypes.end() ? known->second : intern(Term::iri(term.datatype));
    if (known == impl_->datatypes.end()) impl_->datatypes.emplace(term.datatype, datatype);
  }
  encodeTerm(term, datatype, impl_->record);
  return impl_->internRecord();
}

void QuadWriter::add(const QuadIds& quad) {
  impl_->changes.push_back({quad, true});
  if (impl_->changes.size() >= kMaxPendingQuads || impl_->terms.bytes() >= kMaxPendingTermBytes) flush();
}

void QuadWriter::add(const Quad& quad) {
  QuadIds ids;
  ids.s = intern(quad.subject);
  ids.p = intern(quad.predicate);
  ids.o = intern(quad.object);
  ids.g = intern(quad.graph);
  add(ids);
}

void QuadWriter::remove(const QuadIds& quad) {
  impl_->changes.push_back({quad, false});
  if (impl_->changes.size() >= kMaxPendingQuads) flush();
}

void QuadWriter::change(const QuadDifference& difference) {
  flush();
  if (difference.added.empty() && difference.removed.empty()) return;
  if (difference.added.size() + difference.removed.size() < kMaxPendingQuads) {
    impl_->write([&] { impl_->flushQuads(difference); });
    return;
  }
  for (const QuadIds& quad : difference.removed) remove(quad);
  for (const QuadIds& quad : difference.added) add(quad);
  flush();
}

void QuadWriter::clearGraph(TermId graph) {
  flush();
  QuadCursor quads = impl_->reader.scan({.s = {}, .p = {}, .o = {}, .g = graph}, QuadOrder::Gspo);
  std::vector<QuadChange> removals;
  for (QuadIds quad; quads.next(quad);) removals.push_back({quad, false});
  impl_->changes = std::move(removals);
  if (impl_->changes.size() >= kMaxPendingQuads) flush();
}

void QuadWriter::flush() {
  if (impl_->changes.empty() && impl_->terms.entries().empty()) return;
  impl_->write([&] {
    impl_->flushTerms();
    impl_->flushQuads(impl_->takeChanges());
  });
}

}  // namespace cluxel::rdf
