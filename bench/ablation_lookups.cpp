// SPDX-License-Identifier: Apache-2.0
// Optimisations of the quad store: the page directory against LMDB cursors, and lookups prefetched in batches.
#include <lmdb.h>
#include <stdlib.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <random>
#include <stdexcept>

#include "ablation.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::bench {

namespace {

namespace fs = std::filesystem;
using rdf::QuadKey;
using rdf::TermId;

constexpr TermId kSubjects = 250'000;
constexpr TermId kNear = 2;

/// A folder that is removed when the process ends.
class Scratch {
 public:
  Scratch() {
    std::string name = (fs::temp_directory_path() / "cluxel-bench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder can be made");
    path_ = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const Scratch& scratch() {
  static const Scratch folder;
  return folder;
}

/// A million quads: four predicates for each subject.
fs::path generatedStore() {
  const fs::path file = scratch().path() / "quads.clx";
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::Create);
  rdf::WriteTransaction transaction = environment->write();
  rdf::QuadWriter writer(transaction);
  std::mt19937 random(1);
  for (TermId s = 1; s <= kSubjects; ++s)
    for (TermId p = 1; p <= 4; ++p) writer.add(rdf::QuadIds{s, p, 1 + static_cast<TermId>(random() % kSubjects), 0});
  writer.flush();
  transaction.commit();
  return file;
}

void require(int code) {
  if (code != MDB_SUCCESS) throw std::runtime_error(std::string("LMDB: ") + mdb_strerror(code));
}

/// The index "spog" of a copy of the store, read through an LMDB cursor. Left open until the process ends.
class LmdbIndex {
 public:
  explicit LmdbIndex(const fs::path& file) {
    require(mdb_env_create(&environment_));
    require(mdb_env_set_maxdbs(environment_, 8));
    require(mdb_env_set_mapsize(environment_, std::size_t{1} << 32U));
    require(mdb_env_open(environment_, file.c_str(), MDB_NOSUBDIR | MDB_RDONLY, 0644));
    require(mdb_txn_begin(environment_, nullptr, MDB_RDONLY, &transaction_));
    MDB_dbi table = 0;
    require(mdb_dbi_open(transaction_, "spog", 0, &table));
    require(mdb_cursor_open(transaction_, table, &cursor_));
    MDB_val value;
    require(mdb_cursor_get(cursor_, &key_, &value, MDB_FIRST));
  }

  /// The sum of the objects of one subject and predicate.
  std::size_t sumOf(TermId subject, TermId predicate) const {
    QuadKey from{};
    const std::array<std::uint32_t, 2> prefix{__builtin_bswap32(subject), __builtin_bswap32(predicate)};
    std::memcpy(from.bytes.data(), prefix.data(), sizeof prefix);
    MDB_val key = key_, value{sizeof from, from.bytes.data()};
    std::size_t sum = 0;
    for (int code = mdb_cursor_get(cursor_, &key, &value, MDB_GET_BOTH_RANGE);
         code == MDB_SUCCESS && std::memcmp(value.mv_data, prefix.data(), sizeof prefix) == 0;
         code = mdb_cursor_get(cursor_, &key, &value, MDB_NEXT_DUP))
      sum += static_cast<const QuadKey*>(value.mv_data)->at(2);
    return sum;
  }

 private:
  MDB_env* environment_ = nullptr;
  MDB_txn* transaction_ = nullptr;
  MDB_cursor* cursor_ = nullptr;
  MDB_val key_{};
};

std::size_t sumThrough(rdf::PrefixLookup& lookup, TermId subject) {
  std::size_t sum = 0;
  for (const QuadKey& key : lookup.find(std::array{subject, kNear})) sum += key.at(2);
  return sum;
}

std::size_t byDirectory(const rdf::QuadReader& reader, const std::vector<TermId>& subjects) {
  rdf::PrefixLookup lookup = reader.lookup(rdf::QuadOrder::Spog);
  std::size_t sum = 0;
  for (const TermId subject : subjects) sum += sumThrough(lookup, subject);
  return sum;
}

std::size_t byAnnouncement(const rdf::QuadReader& reader, const std::vector<TermId>& subjects) {
  constexpr std::size_t kTogether = 64;
  rdf::PrefixLookup lookup = reader.lookup(rdf::QuadOrder::Spog);
  std::vector<TermId> prefixes;
  std::size_t sum = 0;
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    if (i % kTogether == 0) {
      prefixes.clear();
      for (std::size_t k = i; k < std::min(i + kTogether, subjects.size()); ++k)
        prefixes.insert(prefixes.end(), {subjects[k], kNear});
      lookup.expect(prefixes, 2);
    }
    sum += sumThrough(lookup, subjects[i]);
  }
  return sum;
}

}  // namespace

std::vector<Comparison> lookupComparisons() {
  const fs::path file = generatedStore(), copy = scratch().path() / "copy.clx";
  fs::copy_file(file, copy);
  const auto& environment = kept(rdf::Environment::open(file, rdf::OpenMode::ReadOnly));
  const auto& reader = kept(rdf::QuadReader(environment->read()));
  const auto& index = kept(LmdbIndex(copy));
  std::vector<TermId> random(100'000), ascending(100'000);
  std::mt19937 numbers(5);
  for (TermId& subject : random) subject = 1 + static_cast<TermId>(numbers() % kSubjects);
  ascending = random;
  std::sort(ascending.begin(), ascending.end());
  std::vector<Comparison> comparisons;
  for (const auto& [name, subjects] : {std::pair{"random", &kept(random)}, std::pair{"ascending", &kept(ascending)}})
    comparisons.push_back(
        {std::string("100 thousand lookups, ") + name + " subjects",
         "join",
         0,
         {{"page directory, announced", [&reader, s = subjects] { return byAnnouncement(reader, *s); }},
          {"page directory", [&reader, s = subjects] { return byDirectory(reader, *s); }},
          {"LMDB cursor", [&index, s = subjects] {
             std::size_t sum = 0;
             for (const TermId subject : *s) sum += index.sumOf(subject, kNear);
             return sum;
           }}}});
  return comparisons;
}

}  // namespace cluxel::bench
