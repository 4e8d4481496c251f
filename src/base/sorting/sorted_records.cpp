// SPDX-License-Identifier: Apache-2.0
// A run holds its records in order. Each begins with two numbers: how many bytes it shares with the record before, and
// how many follow.
#include "base/sorting/sorted_records.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

namespace cluxel {

namespace {

using RecordHead = std::array<std::uint32_t, 2>;
constexpr std::size_t kHeadBytes = sizeof(RecordHead);

std::size_t sharedBytes(std::string_view a, std::string_view b) {
  const std::size_t most = std::min(a.size(), b.size());
  return static_cast<std::size_t>(
      std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(most), b.begin()).first - a.begin());
}

}  // namespace

/// Reads one run from the file, a buffer at a time.
class SortedRecords::RunReader {
 public:
  RunReader(const TemporaryBytes& file, const Run& run, std::size_t buffer_bytes)
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
    const std::size_t more = buffer_.size() - known;
    file_.read(at_, buffer_.data() + known, more);
    at_ += more;
  }

  const TemporaryBytes& file_;
  std::uint64_t at_, end_;
  std::size_t buffer_bytes_, place_ = 0;
  std::string buffer_, record_;
};

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
  sortMemory();
  const std::uint64_t begin = file_.size();
  std::string out;
  std::string_view before;
  for (const Place& place : places_) {
    const std::string_view record = viewOf(place);
    const std::size_t shared = sharedBytes(before, record);
    const RecordHead head{static_cast<std::uint32_t>(shared), static_cast<std::uint32_t>(record.size() - shared)};
    out.append(reinterpret_cast<const char*>(head.data()), kHeadBytes).append(record.substr(shared));
    before = record;
    if (out.size() >= kWriteBytes) file_.append(std::exchange(out, {}));
  }
  file_.append(out);
  runs_.push_back({begin, file_.size()});
  places_.clear();
  bytes_.clear();
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
  file_.clear();
}

}  // namespace cluxel
