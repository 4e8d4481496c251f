// SPDX-License-Identifier: Apache-2.0
// A cause is written as bytes in which cluxels and sources have their numbers within the group.
#include "rules/objects/known_splits.hpp"

#include <numeric>
#include <utility>

#include "base/packing/zstd_packing.hpp"

namespace cluxel::rules {

namespace {

/// The version of the splitting. A new number invalidates every stored outcome.
constexpr std::uint32_t kSplitVersion = 1;
constexpr std::uint64_t kMaxStoredBytes = std::uint64_t{1} << 32U;
/// Ends a list in the bytes of a cause.
constexpr std::uint32_t kEndOfList = 0xFFFFFFFFU;

class CauseBytes {
 public:
  CauseBytes(const CrownParts& parts, const SourceGroup& group, std::uint32_t number,
             const std::vector<SearchPlace>& places)
      : all_(parts.all), number_(number), places_(places) {
    add(kSplitVersion);
    add(static_cast<std::uint32_t>(group.sources.size()));
    for (const std::uint32_t source : group.sources) addSource(parts.sources[source]);
    for (const std::uint32_t cluxel : group.cluxels) addCluxel(cluxel);
    bytes_.append(reinterpret_cast<const char*>(group.takers.data()), group.takers.size() * sizeof(std::uint32_t));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void add(std::uint32_t value) { append(&value, sizeof value); }
  void append(const void* from, std::size_t size) { bytes_.append(static_cast<const char*>(from), size); }

  void addSource(const CrownSource& source) {
    for (const double measure : {source.reach_m, source.jump_m, source.start_m, source.clearance_m})
      append(&measure, sizeof measure);
    for (const std::uint32_t cluxel : source.trunk) {
      append(&all_.height_above_ground[cluxel], sizeof(float));
      addCluxel(cluxel);
    }
    add(kEndOfList);
  }

  /// Its box, and its neighbours in the group.
  void addCluxel(std::uint32_t cluxel) {
    append(all_.center[cluxel].data(), 3 * sizeof(double));
    append(all_.extent[cluxel].data(), 3 * sizeof(float));
    for (const std::uint32_t neighbour : all_.neighbours(cluxel))
      if (const SearchPlace& place = places_[neighbour]; place.group == number_) add(place.at);
    add(kEndOfList);
  }

  const perception::SceneCluxels& all_;
  std::uint32_t number_;
  const std::vector<SearchPlace>& places_;
  std::string bytes_;
};

}  // namespace

void KnownSplits::learn(std::string_view stored) {
  const auto unpacked = unpackedBytes(stored, kMaxStoredBytes);
  if (!unpacked) return;
  std::string_view rest = unpacked->view();
  const auto causes = takeArray<ContentHash>(rest);
  const auto sizes = takeArray<std::uint32_t>(rest);
  const auto numbers = takeArray<std::uint32_t>(rest);
  if (!causes || !sizes || !numbers || causes->size() != sizes->size() ||
      std::accumulate(sizes->begin(), sizes->end(), std::uint64_t{0}) != numbers->size())
    return;
  auto at = numbers->begin();
  for (std::size_t i = 0; i < causes->size(); ++i) {
    SplitOutcome& outcome = known_[(*causes)[i]];
    outcome.assign(at, at + (*sizes)[i]);
    for (std::uint32_t& number : outcome) --number;  // kNoSource is stored as 0
    at += (*sizes)[i];
  }
}

const SplitOutcome* KnownSplits::find(const ContentHash& cause) const {
  for (const auto* outcomes : {&known_, &of_run_})
    if (const auto found = outcomes->find(cause); found != outcomes->end()) return &found->second;
  return nullptr;
}

void KnownSplits::note(const ContentHash& cause, SplitOutcome outcome, bool is_reused) {
  if (of_run_.emplace(cause, std::move(outcome)).second && is_reused) ++reused_;
}

std::string KnownSplits::stored() const {
  std::vector<ContentHash> causes;
  std::vector<std::uint32_t> sizes, numbers;
  for (const auto& [cause, outcome] : of_run_) {
    causes.push_back(cause);
    sizes.push_back(static_cast<std::uint32_t>(outcome.size()));
    for (const std::uint32_t number : outcome) numbers.push_back(number + 1);
  }
  std::string bytes;
  appendArray(bytes, causes);
  appendArray(bytes, sizes);
  appendArray(bytes, numbers);
  return packedBytes(bytes);
}

ContentHash causeOf(const CrownParts& parts, const SourceGroup& group, std::uint32_t number,
                    const std::vector<SearchPlace>& places) {
  const CauseBytes cause(parts, group, number, places);
  return ContentHasher().addText(cause.bytes()).finish();
}

}  // namespace cluxel::rules
