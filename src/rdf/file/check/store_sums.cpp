// SPDX-License-Identifier: Apache-2.0
// Reads and writes the sums of quads and terms.
#include "rdf/file/check/store_sums.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/lmdb_environment.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::string_view kSumsKey = "cluxel-sums", kTermSumTable = "term sums";
/// A block of sums is short enough to lie within a page.
constexpr TermId kSumsOfBlock = 128;

/// The bytes of the sums in the record, before their checksum. Maps whose ospg holds all quads have no sum of it, and
/// those without psog none of that.
std::size_t sizeOfSums(const ReadTransaction::Impl& transaction) {
  if (transaction.environment->keepsNumbersApart()) return sizeof(StoreSums);
  return transaction.environment->omitsLiterals() ? offsetof(StoreSums, numbers) : offsetof(StoreSums, links);
}

std::string keyOfSums(TermId block) {
  const TermId big_endian = __builtin_bswap32(block);
  return {reinterpret_cast<const char*>(&big_endian), sizeof big_endian};
}

std::vector<std::uint64_t> sumsOfBlock(ReadTransaction::Impl& transaction, TermId block) {
  std::vector<std::uint64_t> sums;
  if (const auto bytes = readBlock(transaction, kTermSumTable, keyOfSums(block))) {
    sums.resize(bytes->size() / sizeof(std::uint64_t));
    if (!sums.empty()) std::memcpy(sums.data(), bytes->data(), sums.size() * sizeof(std::uint64_t));
  }
  return sums;
}

}  // namespace

EntrySum sumOf(const PageDirectory& directory, Table index, const std::filesystem::path& file) {
  EntrySum sum;
  Key128 last = 0;
  withKeysOfSum(index, [&](const auto& key_in_sum) {
    for (std::size_t i = 0; i < directory.pageCount(); ++i) {
      const std::span<const QuadKey> keys = directory.page(i);
      bool in_order = !keys.empty() && toNumber(keys.front()) >= directory.lower(i) &&
                      (i == 0 || (last < directory.lower(i) && last < toNumber(keys.front())));
      if (in_order) last = toNumber(keys.front()) - 1;
      for (const QuadKey& key : keys) {
        const Key128 number = toNumber(key);
        in_order = in_order && number > last;
        last = number;
        sum.add(key_in_sum(number));
      }
      if (!in_order)
        refuseDamaged(file, std::string("the keys of index ") + kTableNames[static_cast<std::size_t>(index)] +
                                " are out of order");
    }
  });
  return sum;
}

std::optional<StoreSums> storedSums(const ReadTransaction::Impl& transaction, std::uint64_t commit) {
  const std::filesystem::path& file = transaction.environment->file();
  MDB_val key = toVal(kSumsKey);
  MDB_val value;
  const int code = mdb_get(transaction.live(), transaction.environment->mainTable(), &key, &value);
  if (code == MDB_NOTFOUND && transaction.environment->isOfFirstFormat()) return std::nullopt;
  if (code == MDB_NOTFOUND) refuseDamaged(file, "the sums of its quads are missing");
  transaction.check(code, "read the sums of quads");
  StoreSums sums;
  std::uint64_t checksum = 0;
  const std::size_t size = sizeOfSums(transaction);
  const bool is_whole = value.mv_size == size + sizeof checksum;
  if (is_whole) {
    std::memcpy(&sums, value.mv_data, size);
    std::memcpy(&checksum, static_cast<const char*>(value.mv_data) + size, sizeof checksum);
  }
  if (!is_whole || checksum != XXH3_64bits(&sums, size))
    refuseDamaged(file, "the sums of its quads have a wrong checksum");
  if (sums.transaction != commit) refuseDamaged(file, "the sums of its quads are those of another commit");
  if (!transaction.environment->omitsLiterals()) sums.links = sums.quads;
  return sums;
}

void storeSums(const ReadTransaction::Impl& transaction, const StoreSums& sums) {
  const std::size_t size = sizeOfSums(transaction);
  const std::uint64_t checksum = XXH3_64bits(&sums, size);
  std::array<char, sizeof sums + sizeof checksum> record{};
  std::memcpy(record.data(), &sums, size);
  std::memcpy(record.data() + size, &checksum, sizeof checksum);
  MDB_val key = toVal(kSumsKey);
  MDB_val value{size + sizeof checksum, record.data()};
  transaction.check(mdb_put(transaction.live(), transaction.environment->mainTable(), &key, &value, 0),
                    "write the sums of quads");
}

void TermSumWriter::add(const TermHash& hash, TermId id) {
  sums_[id / kTermsOfSum] += hashOfKey(keyOfTerm(hash, id));
}

void TermSumWriter::store() {
  for (auto first = sums_.begin(); first != sums_.end();) {
    const TermId block = first->first / kSumsOfBlock;
    std::vector<std::uint64_t> sums = sumsOfBlock(transaction_.impl(), block);
    for (; first != sums_.end() && first->first / kSumsOfBlock == block; ++first) {
      const std::size_t place = first->first % kSumsOfBlock;
      if (sums.size() <= place) sums.resize(place + 1);
      sums[place] += first->second;
    }
    transaction_.putBlock(kTermSumTable, keyOfSums(block),
                          {reinterpret_cast<const char*>(sums.data()), sums.size() * sizeof(std::uint64_t)});
  }
  sums_.clear();
}

std::vector<std::uint64_t> storedTermSums(ReadTransaction::Impl& transaction, std::uint64_t terms) {
  const std::size_t wanted = terms / kTermsOfSum + 1;
  std::vector<std::uint64_t> sums;
  sums.reserve(wanted);
  for (TermId block = 0; sums.size() < wanted && terms > 0; ++block) {
    const std::vector<std::uint64_t> more = sumsOfBlock(transaction, block);
    if (more.size() != std::min<std::size_t>(kSumsOfBlock, wanted - sums.size()))
      refuseDamaged(transaction.environment->file(), "some of the sums of its terms are missing");
    sums.insert(sums.end(), more.begin(), more.end());
  }
  return sums;
}

}  // namespace cluxel::rdf
