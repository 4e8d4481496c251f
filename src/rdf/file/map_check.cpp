// SPDX-License-Identifier: Apache-2.0
// The checks of `cluxel doctor` on blocks, dictionary and indexes.
#include "rdf/file/map_check.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/geometry_index.hpp"
#include "rdf/store/number_entries.hpp"
#include "rdf/store/quad_reader_impl.hpp"
#include "rdf/store/store_snapshot.hpp"
#include "rdf/terms/term_record.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::size_t kMaxFaults = 40;

void checkStructure(const std::filesystem::path& file) {
  refusePipe(file);
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (descriptor.get() < 0) failStore(file, errno, "open the map");
  constexpr int kAttempts = 5;
  for (int attempt = 1;; ++attempt) {
    const MapFileHead head = readMapFileHead(descriptor.get(), file);
    try {
      if (head.file_size > 0) checkMapStructure(descriptor.get(), file, head.transaction, MapScope::Whole);
      return;
    } catch (const Error&) {
      // No reader pins the pages: a writer may have reused them meanwhile.
      if (attempt == kAttempts || readMapFileHead(descriptor.get(), file).transaction == head.transaction) throw;
    }
  }
}

/// A 64-bit hash of a quad. The sum over an index is independent of its order and identifies the set of quads.
std::uint64_t mixed(const QuadIds& quad) {
  std::uint64_t high = (std::uint64_t{quad.s} << 32U | quad.p) * 0x9E3779B97F4A7C15U;
  high = (high ^ (high >> 29U)) + (std::uint64_t{quad.o} << 32U | quad.g);
  high *= 0xBF58476D1CE4E5B9U;
  high = (high ^ (high >> 32U)) * 0x94D049BB133111EBU;
  return high ^ (high >> 29U);
}

class Check {
 public:
  explicit Check(const Environment& environment) : transaction_(environment.read()), reader_(transaction_) {}

  MapCheck run() {
    guarded([&] { checkBlocks(); });
    guarded([&] { checkBlockKeys(); });
    guarded([&] { checkTerms(); });
    guarded([&] {
      for (std::string& what : faultsOfGeometryIndex(reader_, transaction_)) fault(std::move(what));
    });
    for (const QuadOrder order : kQuadOrders)
      if (order != QuadOrder::Psog || state().environment->keepsNumbersApart()) guarded([&] { checkIndex(order); });
    return std::move(result_);
  }

 private:
  template <typename Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const Error& error) {
      fault(error.what());
    }
  }

  void fault(std::string what) {
    if (result_.faults.size() < kMaxFaults) result_.faults.push_back(std::move(what));
  }

  /// Lists keys without reading values, so that a wrong checksum does not end the check.
  void checkBlocks() {
    MDB_cursor* raw = nullptr;
    state().check(mdb_cursor_open(state().live(), state().table(Table::Blocks), &raw), "read the blocks");
    const CursorHandle cursor(raw);
    MDB_val key;
    MDB_val value;
    for (int code = mdb_cursor_get(raw, &key, &value, MDB_FIRST); code == MDB_SUCCESS;
         code = mdb_cursor_get(raw, &key, &value, MDB_NEXT)) {
      const std::string_view full = toView(key);
      const std::size_t zero = full.find('\0');
      ++result_.blocks;
      if (zero == std::string_view::npos)
        fault("a block has no table");
      else
        guarded([&] { transaction_.block(full.substr(0, zero), full.substr(zero + 1)); });
    }
  }

  void checkBlockKeys() {
    for (const std::string& table : BlockKeys::tablesOf(state()))
      guarded([&] { state().block_keys.verify(state(), table); });
  }

  void checkTerms() {
    const std::uint64_t count = reader_.termCount();
    const PageDirectory& hashes = snapshotOf(state()).directory(Table::TermHashes, state());
    const std::uint64_t hash_count = hashes.distance(hashes.begin(), hashes.end());
    if (hash_count != count)
      fault("there are " + std::to_string(count) + " terms, but " + std::to_string(hash_count) + " in their index");
    for (std::uint64_t id = 1; id <= count; ++id, ++result_.terms)
      guarded([&] { checkTerm(static_cast<TermId>(id), hashes); });
  }

  void checkTerm(TermId id, const PageDirectory& hashes) {
    const std::string_view record = snapshotOf(state()).record(id, state());
    const TermRecord term = decodeTerm(record);
    const TermHash hash = hashOfRecord(record);
    const Key128 key = (Key128{hash.high} << 64U) | (Key128{hash.low} << 32U) | id;
    const auto at = hashes.lowerBound(key);
    if (at.page == hashes.pageCount() || toNumber(hashes.page(at.page)[at.index]) != key)
      fault("term " + std::to_string(id) + " is not in the index of terms, or has changed");
    if (term.datatype >= id) fault("term " + std::to_string(id) + " has an unknown datatype");
  }

  void checkIndex(QuadOrder order) {
    const std::string name = kTableNames[static_cast<std::size_t>(tableOf(order))];
    const PageDirectory& directory = snapshotOf(state()).directory(tableOf(order), state());
    const std::uint64_t terms = reader_.termCount();
    std::uint64_t count = 0;
    std::uint64_t sum = 0;
    Key128 last = 0;
    for (std::size_t page = 0; page < directory.pageCount(); ++page)
      for (const QuadKey& key : directory.page(page)) {
        const QuadIds quad = toQuad(key, order);
        if (count > 0 && toNumber(key) <= last) fault("index " + name + " is out of order");
        if (quad.s == 0 || quad.p == 0 || quad.o == 0 || std::max({quad.s, quad.p, quad.o, quad.g}) > terms)
          fault("index " + name + " holds a quad of unknown terms");
        last = toNumber(key);
        sum += mixed(quad);
        ++count;
        if (order == QuadOrder::Spog) noteInParts(quad);
      }
    if (order == QuadOrder::Spog) {
      result_.quads = count;
      sums_.quads = {count, sum};
    }
    if (EntrySum{count, sum} != sums_.of(tableOf(order))) fault("index " + name + " holds other quads than index spog");
    if (order == QuadOrder::Spog && count != reader_.size()) fault("index " + name + " has a wrong count");
  }

  void noteInParts(const QuadIds& quad) {
    const LmdbEnvironment& environment = *state().environment;
    const ObjectKind kind = NumberEntries(transaction_).kindOf(quad.o);
    const auto note = [&](EntrySum& part) {
      ++part.count;
      part.hash += mixed(quad);
    };
    if (kind == ObjectKind::Link || !environment.omitsLiterals()) note(sums_.links);
    if (kind == ObjectKind::Number && environment.keepsNumbersApart()) note(sums_.numbers);
  }

  ReadTransaction::Impl& state() const { return transaction_.impl(); }

  ReadTransaction transaction_;
  QuadReader reader_;
  MapCheck result_;
  StoreSums sums_;  ///< of what the indexes should hold, with hashes of mixed()
};

}  // namespace

MapCheck checkMap(const std::filesystem::path& file) {
  try {
    checkStructure(file);
  } catch (const Error& error) {
    if (std::error_code ignored; !std::filesystem::is_regular_file(file, ignored)) throw;
    MapCheck broken;
    broken.faults.emplace_back(error.what());
    return broken;
  }
  const auto environment = Environment::open(file, OpenMode::ReadOnly);
  try {
    return Check(*environment).run();
  } catch (const Error& error) {
    return {.faults = {error.what()}};
  }
}

}  // namespace cluxel::rdf
