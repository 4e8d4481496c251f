// SPDX-License-Identifier: Apache-2.0
// The rules of presence (perception/visibility/presence), with visits in the place of scans.
#include "tasks/changes/visit_votes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cluxel::tasks {

namespace {

constexpr perception::PresenceParams kPresence;

/// The visits of which the log-odds of "there" are as is asked.
template <typename Accepts>
std::vector<std::uint32_t> visitsWhere(const VisitVotes& votes, double share_of_hits, const Accepts& accepts) {
  const std::span all(votes.votes);
  std::vector<std::uint32_t> visits;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (accepts(logOddsOfPresence(all.subspan(i, 1), share_of_hits, kPresence))) visits.push_back(votes.visits[i]);
  return visits;
}

/// Log-odds of "there".
double logOddsOf(const LookCounts& looks, double share_of_hits) {
  return perception::logOddsOfPresence(static_cast<double>(looks.hits), static_cast<double>(looks.passed),
                                       share_of_hits, kPresence);
}

/// The share of hits on the visit that speaks most for the thing. Other visits may have hit what stood there before it.
double shareOnBestVisit(std::span<const LookCounts> visits) {
  double share = perception::shareOfHits(0, 0), best = -std::numeric_limits<double>::infinity();
  for (const LookCounts& looks : visits) {
    const std::size_t all = looks.hits + looks.passed;
    if (all == 0) continue;
    const double of_visit = perception::shareOfHits(static_cast<double>(looks.hits), static_cast<double>(all));
    const double log_odds = logOddsOf(looks, of_visit);
    if (log_odds > best) best = log_odds, share = of_visit;
  }
  return share;
}

/// Visits come in ascending order.
void addVote(std::uint32_t visit, const perception::ScanVotes& vote, const LookCounts& looks, VisitVotes& all) {
  if (all.visits.empty() || all.visits.back() != visit) {
    all.visits.push_back(visit);
    all.votes.emplace_back(), all.looks.emplace_back();
  }
  perception::ScanVotes& sum = all.votes.back();
  sum.hits |= vote.hits, sum.seen_through |= vote.seen_through;
  sum.seen_through &= ~sum.hits;
  all.looks.back().hits += looks.hits, all.looks.back().passed += looks.passed;
}

LookCounts countsOf(const perception::ScanVotes& vote) {
  return {vote.hits.count(), vote.seen_through.count()};
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
  hits.forEach([&](std::uint32_t scan) {
    const std::uint32_t visit = visits_.ofScan(scan);
    of_visit_[visit].hits.set(place), ++looks_[visit].hits;
  });
  passed.forEach([&](std::uint32_t scan) {
    const std::uint32_t visit = visits_.ofScan(scan);
    of_visit_[visit].seen_through.set(place), looks_[visit].passed += hits.contains(scan) ? 0 : 1;
  });
}

VisitVotes PlaceVotes::take() {
  VisitVotes all;
  for (const auto& [visit, vote] : of_visit_) addVote(visit, vote, looks_[visit], all);
  return all;
}

VisitVotes votesByVisit(std::span<const perception::ScanVotes> votes, const Visits& visits) {
  VisitVotes all;
  for (const perception::ScanVotes& vote : votes) addVote(visits.at(vote.time_s), vote, countsOf(vote), all);
  return all;
}

VisitVotes votesOn(std::span<const std::uint32_t> visits, const VisitVotes& votes) {
  VisitVotes some;
  for (std::size_t i = 0; i < votes.visits.size(); ++i)
    if (std::binary_search(visits.begin(), visits.end(), votes.visits[i]))
      addVote(votes.visits[i], votes.votes[i], votes.looks[i], some);
  return some;
}

std::vector<std::uint32_t> visitsWithIt(const VisitVotes& votes) {
  return visitsWhere(votes, perception::shareOfHits(votes.votes),
                     [](double log_odds) { return log_odds >= kPresence.decided; });
}

std::vector<std::uint32_t> visitsWithoutIt(const VisitVotes& votes) {
  if (visitsWithIt(votes).empty()) return {};
  std::vector<LookCounts> places;
  for (const perception::ScanVotes& vote : votes.votes) places.push_back(countsOf(vote));
  return visitsWhere(votes, shareOnBestVisit(places), [](double log_odds) { return log_odds <= -kPresence.decided; });
}

bool isAwayAtEnd(const VisitVotes& votes) {
  const perception::Visibility thing = perception::visibilityOf(votes.votes);
  return stateAtEnd(votes.votes, votes.visits, thing, kPresence).state == perception::PresenceState::Absent;
}

VisitVotes joined(const VisitVotes& before, const VisitVotes& after) {
  VisitVotes all = before;
  for (std::size_t i = 0; i < after.visits.size(); ++i) addVote(after.visits[i], after.votes[i], after.looks[i], all);
  return all;
}

std::size_t comingsAndGoings(const VisitVotes& votes) {
  const double share_of_hits = shareOnBestVisit(votes.looks);
  std::size_t turns = 0;
  std::optional<bool> was_there;
  for (const LookCounts& looks : votes.looks) {
    const double log_odds = logOddsOf(looks, share_of_hits);
    if (std::abs(log_odds) < kPresence.decided) continue;
    turns += was_there && *was_there != (log_odds > 0) ? 1 : 0;
    was_there = log_odds > 0;
  }
  return turns;
}

bool haveCommon(std::span<const std::uint32_t> ascending, std::span<const std::uint32_t> others) {
  return std::any_of(others.begin(), others.end(), [&](std::uint32_t visit) {
    return std::binary_search(ascending.begin(), ascending.end(), visit);
  });
}

}  // namespace cluxel::tasks
