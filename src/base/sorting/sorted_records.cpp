// SPDX-License-Identifier: Apache-2.0
// A run holds its records in order. Each begins with two numbers: how many bytes it shares with the record before, and
// how many follow.
#include "base/sorting/sorted_records.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>

#include "base/file_bytes.hpp"
#include "base/sorting/nameless_file.hpp"
#include "cluxel/error.hpp"

namespace cluxel {

namespace {

using RecordHead = std::array<std::uint32_t, 2>;
constexpr std::size_t kHeadBytes = sizeof(RecordHead);

[[noreturn]] void failSorting(const std::string& what, int code) {
  throw Error(ErrorKind::StoreUnavailable,
              temporaryFolderPath().string() + ": a temporary file for sorting cannot be " + what + " (" +
                  std::generic_category().message(code) + "); make room there, or set TMPDIR to a folder with more");
}

std::size_t sharedBytes(std::string_view a, std::string_view b) {
  const std::size_t most = std::min(a.size(), b.size());
  return static_cast<std::size_t>(
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(most), b.begin()).first - a.begin());
}

}  // namespace

/// Reads one run from the file, a buffer at a time.
class SortedRecords::RunReader {
 public:
  RunReader(int file, const Run& run, std::size_t buffer_bytes)
      : file_(file), at_(run.begin), end_(run.end), buffer_bytes_(buffer_bytes) {}

  /// False at the end.
  bool next() {
    if (place_ == buffer_.size() && at_ == end_) return false;
    RecordHead head{};
    std::memcpy(head.data(), need(kHeadBytes), kHeadBytes);
    const char* rest = need(head[1]);
    record_.resize(head[0]);
    record_.append(rest, head[1]);
    return true;
  }
  std::string_view record() const { return record_; }

 private:
  /// The next `count` bytes.
  const char* need(std::size_t count) {
    if (buffer_.size() - place_ < count) fill(count);
    const char* bytes = buffer_.data() + place_;
    place_ += count;
    return bytes;
  }

  void fill(std::size_t count) {
    buffer_.erase(0, place_);
    place_ = 0;
    const std::size_t known = buffer_.size();
    buffer_.resize(known + std::min<std::uint64_t>(end_ - at_, std::max(count, buffer_bytes_) - known));
    for (std::size_t done = known; done < buffer_.size();) {
      const ssize_t part = ::pread(file_, buffer_.data() + done, buffer_.size() - done, static_cast<off_t>(at_));
      if (part < 0 && errno == EINTR) continue;
      if (part <= 0) failSorting("read", part < 0 ? errno : EIO);
      done += static_cast<std::size_t>(part);
      at_ += static_cast<std::uint64_t>(part);
    }
  }

  int file_;
  std::uint64_t at_, end_;
  std::size_t buffer_bytes_, place_ = 0;
  std::string buffer_, record_;
};

SortedRecords::~SortedRecords() {
  if (file_ >= 0) ::close(file_);
}

void SortedRecords::add(std::string_view record) {
  const std::size_t held = bytes_.size() + places_.size() * sizeof(Place);
  if (!places_.empty() && held + record.size() + sizeof(Place) > limit_) writeRun();
  places_.push_back({bytes_.size(), static_cast<std::uint32_t>(record.size())});
  bytes_.append(record);
}

void SortedRecords::drain(const std::function<void(std::string_view)>& take) {
  if (runs_.empty()) {
    sortMemory();
    for (const Place& place : places_) take(viewOf(place));
  } else {
    if (!places_.empty()) writeRun();
    mergeRuns(take);
  }
  forget();
}

void SortedRecords::sortMemory() {
  std::sort(places_.begin(), places_.end(), [&](const Place& a, const Place& b) { return viewOf(a) < viewOf(b); });
  const auto is_same = [&](const Place& a, const Place& b) { return viewOf(a) == viewOf(b); };
  places_.erase(std::unique(places_.begin(), places_.end(), is_same), places_.end());
}

void SortedRecords::writeRun() {
  constexpr std::size_t kWriteBytes = std::size_t{1} << 18U;
  if (file_ < 0) file_ = openNamelessFile(temporaryFolderPath());
  if (file_ < 0) failSorting("made", errno);
  sortMemory();
  const std::uint64_t begin = file_bytes_;
  std::string out;
  std::string_view before;
  for (const Place& place : places_) {
    const std::string_view record = viewOf(place);
    const std::size_t shared = sharedBytes(before, record);
    const RecordHead head{static_cast<std::uint32_t>(shared), static_cast<std::uint32_t>(record.size() - shared)};
    out.append(reinterpret_cast<const char*>(head.data()), kHeadBytes).append(record.substr(shared));
    before = record;
    if (out.size() >= kWriteBytes) writeAll(std::exchange(out, {}));
  }
  writeAll(out);
  runs_.push_back({begin, file_bytes_});
  places_.clear();
  bytes_.clear();
}

void SortedRecords::writeAll(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(file_bytes_));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failSorting("written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(count));
    file_bytes_ += static_cast<std::uint64_t>(count);
  }
}

void SortedRecords::mergeRuns(const std::function<void(std::string_view)>& take) {
  constexpr std::size_t kLeastBuffer = std::size_t{1} << 12U, kMostBuffer = std::size_t{1} << 18U;
  std::string().swap(bytes_);  // its room goes to the buffers
  std::vector<Place>().swap(places_);
  const std::size_t buffer = std::clamp(limit_ / runs_.size(), kLeastBuffer, kMostBuffer);
  std::vector<RunReader> readers;
  std::vector<std::size_t> heap;  // of those that have a record, the least first
  for (const Run& run : runs_) {
    readers.emplace_back(file_, run, buffer);
    if (readers.back().next()) heap.push_back(readers.size() - 1);
  }
  const auto comesLater = [&](std::size_t a, std::size_t b) { return readers[a].record() > readers[b].record(); };
  std::make_heap(heap.begin(), heap.end(), comesLater);
  std::optional<std::string> last;
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), comesLater);
    RunReader& reader = readers[heap.back()];
    if (last != reader.record()) take(last.emplace(reader.record()));
    if (reader.next())
      std::push_heap(heap.begin(), heap.end(), comesLater);
    else
      heap.pop_back();
  }
}

void SortedRecords::forget() {
  runs_.clear();
  places_.clear();
  bytes_.clear();
  file_bytes_ = 0;
  if (file_ >= 0 && ::ftruncate(file_, 0) != 0) failSorting("emptied", errno);
}

}  // namespace cluxel
