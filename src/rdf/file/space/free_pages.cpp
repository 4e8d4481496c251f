// SPDX-License-Identifier: Apache-2.0
// Punches holes where LMDB's list of free pages has runs of them.
#include "rdf/file/space/free_pages.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>
#include <string_view>
#include <vector>

#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/opening/newest_commit.hpp"
#include "rdf/file/space/table_entries.hpp"

namespace cluxel::rdf {

namespace {

constexpr MDB_dbi kFreePages = 0;  // LMDB's own table of free pages
constexpr std::uint64_t kShortestRun = 16U << 10U;

/// While it lives, no other process or thread commits.
class WritersTurn {
 public:
  explicit WritersTurn(LmdbEnvironment& environment) : environment_(environment) { environment_.enterWriting(); }
  WritersTurn(const WritersTurn&) = delete;
  WritersTurn& operator=(const WritersTurn&) = delete;
  ~WritersTurn() { environment_.leaveWriting(); }

 private:
  LmdbEnvironment& environment_;
};

/// An entry holds the number of its pages, then their numbers.
std::uint64_t countIn(std::string_view entry) {
  std::uint64_t count = 0;
  if (entry.size() < sizeof count) return 0;
  std::memcpy(&count, entry.data(), sizeof count);
  return std::min<std::uint64_t>(count, entry.size() / sizeof count - 1);
}

/// The commit that a line of LMDB's table of readers ends with; absent where the line is of another form.
std::optional<std::uint64_t> commitIn(std::string_view line) {
  while (line.ends_with('\n') || line.ends_with(' ')) line.remove_suffix(1);
  line.remove_prefix(line.rfind(' ') + 1);
  std::uint64_t commit = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), commit);
  if (error != std::errc() || end != line.data() + line.size()) return std::nullopt;
  return commit;
}

/// The oldest commit that a snapshot of any process reads; 0 when that is not known.
std::uint64_t oldestRead(const LmdbEnvironment& environment) {
  std::uint64_t oldest = std::numeric_limits<std::uint64_t>::max();
  const auto visit = [](const char* text, void* context) {
    auto& least = *static_cast<std::uint64_t*>(context);
    const std::string_view line = text;
    const bool has_no_snapshot = line.find(" -") != std::string_view::npos;
    const bool is_heading = line.find("txnid") != std::string_view::npos || line.starts_with("(no active readers)");
    if (!has_no_snapshot && !is_heading) least = std::min(least, commitIn(line).value_or(0));
    return 0;
  };
  environment.check(std::min(0, mdb_reader_list(environment.handle(), visit, &oldest)), "list the readers");
  return oldest;
}

/// Of the commits up to `last`: what they left free is in no newer snapshot.
std::vector<std::uint64_t> freePagesUpTo(std::uint64_t last, const ReadTransaction::Impl& state) {
  std::vector<std::uint64_t> pages;
  forEachEntry(state, kFreePages, [&](std::string_view key, std::string_view entry) {
    std::uint64_t commit = 0;
    if (key.size() != sizeof commit) return;
    std::memcpy(&commit, key.data(), sizeof commit);
    if (commit > last) return;
    const std::size_t before = pages.size(), count = countIn(entry);
    pages.resize(before + count);
    if (count > 0) std::memcpy(pages.data() + before, entry.data() + sizeof count, count * sizeof count);
  });
  std::sort(pages.begin(), pages.end());
  return pages;
}

}  // namespace

std::uint64_t freePageCount(const ReadTransaction& transaction) {
  std::uint64_t count = 0;
  forEachEntry(transaction.impl(), kFreePages,
               [&](std::string_view, std::string_view entry) { count += countIn(entry); });
  return count;
}

std::uint64_t releaseFreePages(Environment& environment) {
  auto& lmdb = dynamic_cast<LmdbEnvironment&>(environment);
  const WritersTurn turn(lmdb);
  if (lmdb.hasOtherNames()) return 0;  // whoever reads by another name is in another table of readers
  const ReadTransaction newest = lmdb.read();
  // A writer that was killed at the end of its commit leaves its number to the next writer. That commit may use what
  // was free before.
  if (newest.commitNumber() != newestCommit(lmdb.handle())) return 0;
  MDB_stat stat;
  newest.impl().check(mdb_stat(newest.impl().live(), lmdb.mainTable(), &stat), "read the map");
  const std::vector<std::uint64_t> pages = freePagesUpTo(oldestRead(lmdb), newest.impl());
  const std::uint64_t written = lmdb.fileSize() / stat.ms_psize;
  std::uint64_t released = 0;
  for (std::size_t first = 0, end = 0; first < pages.size(); first = end) {
    while (end < pages.size() && pages[end] - pages[first] == end - first) ++end;
    const std::uint64_t bytes = (end - first) * stat.ms_psize;
    if (bytes < kShortestRun || pages[first] >= written) continue;
    if (!lmdb.punchHole(pages[first] * stat.ms_psize, bytes)) break;
    released += bytes;
  }
  return released;
}

}  // namespace cluxel::rdf
