// SPDX-License-Identifier: Apache-2.0
// The rules of presence (perception/visibility/presence), with visits in the place of scans.
#include "tasks/changes/visit_votes.hpp"

#include <algorithm>

namespace cluxel::tasks {

namespace {

constexpr perception::PresenceParams kPresence;

/// The visits of which the log-odds of "there" are as is asked.
template <typename Accepts>
std::vector<std::uint32_t> visitsWhere(const VisitVotes& votes, const Accepts& accepts) {
  const std::span all(votes.votes);
  const double share_of_hits = perception::shareOfHits(all);
  std::vector<std::uint32_t> visits;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (accepts(logOddsOfPresence(all.subspan(i, 1), share_of_hits, kPresence))) visits.push_back(votes.visits[i]);
  return visits;
}

/// Visits come in ascending order.
void addVote(std::uint32_t visit, const perception::ScanVotes& vote, VisitVotes& all) {
  if (all.visits.empty() || all.visits.back() != visit) {
    all.visits.push_back(visit);
    all.votes.emplace_back();
  }
  perception::ScanVotes& sum = all.votes.back();
  sum.hits |= vote.hits, sum.seen_through |= vote.seen_through;
  sum.seen_through &= ~sum.hits;
}

}  // namespace

Visits::Visits(std::span<const double> times_s, double since_s) : since_s_(since_s) {
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const bool begins = i == 0 || times_s[i] - times_s[i - 1] >= kPauseOfVisits_s ||
                        (times_s[i - 1] < since_s && times_s[i] >= since_s);
    if (begins) begins_s_.push_back(times_s[i]);
    of_scan_.push_back(static_cast<std::uint32_t>(begins_s_.size() - 1));
  }
}

std::uint32_t Visits::at(double time_s) const {
  const auto next = std::upper_bound(begins_s_.begin(), begins_s_.end(), time_s);
  return static_cast<std::uint32_t>(next - begins_s_.begin() - 1);
}

void PlaceVotes::addPlace(const ScanNumbers& hits, const ScanNumbers& passed) {
  const std::size_t votes = std::min(places_, perception::kMaxPlaces);
  const std::size_t place = added_++ * votes / places_;
  hits.forEach([&](std::uint32_t scan) { of_visit_[visits_.ofScan(scan)].hits.set(place); });
  passed.forEach([&](std::uint32_t scan) { of_visit_[visits_.ofScan(scan)].seen_through.set(place); });
}

VisitVotes PlaceVotes::take() {
  VisitVotes all;
  for (const auto& [visit, vote] : of_visit_) addVote(visit, vote, all);
  return all;
}

VisitVotes votesByVisit(std::span<const perception::ScanVotes> votes, const Visits& visits) {
  VisitVotes all;
  for (const perception::ScanVotes& vote : votes) addVote(visits.at(vote.time_s), vote, all);
  return all;
}

VisitVotes votesOn(std::span<const std::uint32_t> visits, const VisitVotes& votes) {
  VisitVotes some;
  for (std::size_t i = 0; i < votes.visits.size(); ++i)
    if (std::binary_search(visits.begin(), visits.end(), votes.visits[i]))
      addVote(votes.visits[i], votes.votes[i], some);
  return some;
}

std::vector<std::uint32_t> visitsWithIt(const VisitVotes& votes) {
  return visitsWhere(votes, [](double log_odds) { return log_odds >= kPresence.decided; });
}

std::vector<std::uint32_t> visitsWithoutIt(const VisitVotes& votes) {
  if (visitsWithIt(votes).empty()) return {};
  return visitsWhere(votes, [](double log_odds) { return log_odds <= -kPresence.decided; });
}

bool isAwayAtEnd(const VisitVotes& votes) {
  const perception::Visibility thing = perception::visibilityOf(votes.votes);
  return stateAtEnd(votes.votes, votes.visits, thing, kPresence).state == perception::PresenceState::Absent;
}

bool haveCommon(std::span<const std::uint32_t> ascending, std::span<const std::uint32_t> others) {
  return std::any_of(others.begin(), others.end(), [&](std::uint32_t visit) {
    return std::binary_search(ascending.begin(), ascending.end(), visit);
  });
}

}  // namespace cluxel::tasks
