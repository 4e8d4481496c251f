// SPDX-License-Identifier: Apache-2.0
// Outcomes of splits of crowns, found by a hash of all that they follow from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/content_hash.hpp"
#include "rules/objects/crown_groups.hpp"

namespace cluxel::rules {

/// For each cluxel of a group of sources, the place of its source in the group, or kNoSource.
using SplitOutcome = std::vector<std::uint32_t>;

/// Outcomes of earlier runs, and those that this run came to. Only the latter are stored.
class KnownSplits {
 public:
  KnownSplits() = default;
  /// Knows what stored() returned. Of damaged bytes nothing is known.
  explicit KnownSplits(std::string_view stored) { learn(stored); }
  /// Knows these outcomes, too.
  void learn(std::string_view stored);
  /// Counts all known outcomes to this run, so that they are stored.
  void keepAll() { of_run_.insert(known_.begin(), known_.end()); }

  /// An outcome that was known or that this run has noted; null when there is none. Threads may ask at the same time.
  const SplitOutcome* find(const ContentHash& cause) const;
  /// Notes an outcome of this run.
  void note(const ContentHash& cause, SplitOutcome outcome, bool is_reused);
  std::string stored() const;

  std::size_t count() const { return of_run_.size(); }  ///< of this run
  std::size_t reused() const { return reused_; }        ///< of these, those that were known before

 private:
  std::map<ContentHash, SplitOutcome> known_, of_run_;
  std::size_t reused_ = 0;
};

/// A hash of all that the split of a group follows from. `number` is the group's in `places`. It does not depend on the
/// numbers of cluxels, only on their order.
ContentHash causeOf(const CrownParts& parts, const SourceGroup& group, std::uint32_t number,
                    const std::vector<SearchPlace>& places);

}  // namespace cluxel::rules
