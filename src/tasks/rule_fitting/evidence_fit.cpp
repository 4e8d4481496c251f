// SPDX-License-Identifier: Apache-2.0
// The parameters of a rule: one shift of its confidences, one more for each leaf, and the log-odds of its evidence.
#include "tasks/rule_fitting/evidence_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <set>

#include "perception/training/lbfgs_minimise.hpp"
#include "rules/propose/evidence.hpp"
#include "tasks/rule_fitting/evidence_design.hpp"
#include "tasks/rule_fitting/round_number.hpp"

namespace cluxel::tasks {

namespace {

using fitting::Design;
using fitting::Parameter;
using fitting::Row;
using fitting::UsersOf;

struct Sample {
  Row row;
  double offset = 0;  ///< log-odds of the leaf's confidence
  bool is_right = false;
  std::string place;
  bool is_imagined = false;  ///< see RuleFit::addSuccession()
};

double logOddsAt(const Sample& sample, std::span<const double> x) {
  double sum = sample.offset;
  for (const auto& [parameter, factor] : sample.row) sum += factor * x[parameter];
  return sum;
}

double lossOf(const Sample& sample, double log_odds) {
  const double signed_odds = sample.is_right ? log_odds : -log_odds;
  return signed_odds > 30 ? 0 : std::log1p(std::exp(-signed_odds));
}

std::string lossText(double loss) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", loss);
  return text.data();
}

/// Logistic regression with a ridge; `weights` says how often each sample counts.
std::vector<double> regress(const std::vector<Sample>& samples, const std::vector<double>& weights, std::size_t size,
                            double ridge) {
  const auto objective = [&](std::span<const double> x, std::span<double> gradient) {
    double value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      // The shift of the whole rule is its base rate, which the data knows best.
      const double pull = i == 0 ? ridge / 100 : ridge;
      value += pull * x[i] * x[i] / 2;
      gradient[i] = pull * x[i];
    }
    for (std::size_t s = 0; s < samples.size(); ++s) {
      if (weights[s] == 0) continue;
      const double log_odds = logOddsAt(samples[s], x);
      value += weights[s] * lossOf(samples[s], log_odds);
      const double error = weights[s] * (rules::probabilityOf(log_odds) - (samples[s].is_right ? 1.0 : 0.0));
      for (const auto& [parameter, factor] : samples[s].row) gradient[parameter] += error * factor;
    }
    return value;
  };
  return perception::minimise(objective, std::vector<double>(size, 0), {.iterations = 300, .precision = 1e-6});
}

class RuleFit {
 public:
  RuleFit(const rules::Rule& rule, std::vector<Sample> samples, std::size_t right_of_class, const Design& design,
          const EvidenceFitParams& params)
      : rule_(rule), samples_(std::move(samples)), right_of_class_(right_of_class), design_(design), params_(params) {
    std::set<std::string> places;
    for (const Sample& sample : samples_) places.insert(sample.place);
    places_.assign(places.begin(), places.end());
  }

  FittedRule run() {
    FittedRule fitted;
    fitted.rule_id = rule_.id;
    for (const Sample& sample : samples_) ++(sample.is_right ? fitted.right : fitted.wrong);
    const std::string few = "fewer than " + std::to_string(params_.min_examples);
    if (samples_.size() < params_.min_examples || right_of_class_ < params_.min_examples) {
      fitted.refusal = few + (samples_.size() < params_.min_examples ? " candidates" : " right ones of its class");
      return fitted;
    }
    if (std::min(fitted.right, fitted.wrong) < params_.min_examples) {
      fitted.refusal = few + " right or wrong candidates: only its confidence is fitted";
      keepShiftOnly();
      addSuccession();
    }
    if (places_.size() < 2) {
      fitted.refusal = "all its candidates are of one scan, and none is left to test new numbers on";
      return fitted;
    }
    scoreLeftOut(fitted);
    if (fitted.loss_after > fitted.loss_before) {
      fitted.refusal = "new numbers are worse on places left out: log loss " + lossText(fitted.loss_before) + " -> " +
                       lossText(fitted.loss_after);
      return fitted;
    }
    resample();
    fitted.is_fitted = true;
    fitted.kept = design_.keptPlaces().size();
    addConfidences(fitted);
    addNumbers(fitted);
    return fitted;
  }

 private:
  void keepShiftOnly() {
    const auto current = startingPoint();
    for (Sample& sample : samples_) {
      const bool may_shift = !sample.row.empty() && sample.row.front().first == 0;
      sample.offset = logOddsAt(sample, current);
      sample.row = may_shift ? Row{{0, 1.0}} : Row{};
    }
    only_shift_ = true;
  }

  /// As Laplace's rule of succession, adds a right candidate and a wrong one: a few that were all right must not give a
  /// confidence of 1. Where the evidence adds nothing, 27 right ones give about 28 in 29.
  void addSuccession() {
    const bool may_shift = std::any_of(samples_.begin(), samples_.end(), [](const Sample& sample) {
      return !sample.row.empty() && sample.row.front().first == 0;
    });
    if (!may_shift) return;
    Sample imagined{{{0, 1.0}}, 0, true, {}, true};
    const auto current = startingPoint();
    for (const Sample& sample : samples_)
      imagined.offset += logOddsAt(sample, current) / static_cast<double>(samples_.size());
    samples_.push_back(imagined);
    imagined.is_right = false;
    samples_.push_back(imagined);
  }

  /// Fits to places drawn with replacement.
  void resample() {
    std::mt19937_64 random(params_.seed);
    for (int round = 0; round < params_.resamples; ++round) {
      std::map<std::string, double> drawn;
      for (std::size_t i = 0; i < places_.size(); ++i) drawn[places_[random() % places_.size()]] += 1;
      resamples_.push_back(regress(samples_, weightsOf(drawn), design_.size(), params_.ridge));
    }
  }

  std::vector<double> weightsOf(const std::map<std::string, double>& drawn) const {
    std::vector<double> weights;
    for (const Sample& sample : samples_) {
      const auto found = drawn.find(sample.place);
      weights.push_back(sample.is_imagined ? 1 : found == drawn.end() ? 0 : found->second);
    }
    return weights;
  }

  /// A fifth of the places in turn is left out.
  void scoreLeftOut(FittedRule& fitted) const {
    constexpr std::size_t kFolds = 5;
    const auto candidates = static_cast<double>(fitted.right + fitted.wrong);
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
      std::map<std::string, double> kept;
      for (std::size_t i = 0; i < places_.size(); ++i)
        if (i % kFolds != fold) kept[places_[i]] = 1;
      const auto weights = weightsOf(kept);
      const auto x = regress(samples_, weights, design_.size(), params_.ridge);
      const auto before = startingPoint();
      for (std::size_t s = 0; s < samples_.size(); ++s) {
        if (weights[s] != 0) continue;
        fitted.loss_after += lossOf(samples_[s], logOddsAt(samples_[s], x)) / candidates;
        fitted.loss_before += lossOf(samples_[s], logOddsAt(samples_[s], before)) / candidates;
      }
    }
  }

  /// The parameters that the rule file has now.
  std::vector<double> startingPoint() const {
    std::vector<double> x(design_.size(), 0);
    for (std::size_t i = 0; i < design_.numbers().size(); ++i)
      x[design_.firstNumber() + i] = design_.numbers()[i].before;
    return x;
  }

  /// The interval of a sum of parameters over the resamples, as (low, high).
  std::pair<double, double> intervalOf(const std::vector<std::size_t>& parameters, double share) const {
    std::vector<double> values;
    for (const auto& x : resamples_) {
      double sum = 0;
      for (std::size_t parameter : parameters) sum += x[parameter];
      values.push_back(sum);
    }
    std::sort(values.begin(), values.end());
    const auto at = [&](double quantile) {
      return values[static_cast<std::size_t>(std::lround(quantile * static_cast<double>(values.size() - 1)))];
    };
    return {at((1 - share) / 2), at((1 + share) / 2)};
  }

  void addNumbers(FittedRule& fitted) const {
    if (only_shift_) return;
    for (std::size_t i = 0; i < design_.numbers().size(); ++i) {
      const Parameter& number = design_.numbers()[i];
      const std::vector<std::size_t> parameter{design_.firstNumber() + i};
      const auto [low, high] = intervalOf(parameter, params_.interval);
      if (low <= number.before && number.before <= high) continue;
      const auto [inner_low, inner_high] = intervalOf(parameter, 0.5);
      fitted.changes.push_back(
          {number.at, number.what, number.before, roundestIn(inner_low, inner_high), low, high, false});
    }
  }

  void addConfidences(FittedRule& fitted) const {
    std::set<std::size_t> written;
    for (const auto& [node, shift] : design_.shifts()) {
      if (!written.insert(shift).second) continue;  // leaves that share a definition
      const rules::Confidence& confidence = std::get<rules::AcceptLeaf>(rule_.nodes[node].what).confidence;
      addConfidence(confidence.high, confidence.high_at, shift, fitted);
      if (!confidence.ramps.empty()) addConfidence(confidence.low, confidence.low_at, shift, fitted);
    }
  }

  void addConfidence(double before, const SourceLocation& at, std::size_t shift, FittedRule& fitted) const {
    const auto shifted = [&](double by) { return rules::probabilityOf(rules::logOdds(before) + by); };
    const auto [low, high] = intervalOf({0, shift}, params_.interval);
    const auto [inner_low, inner_high] = intervalOf({0, shift}, 0.5);
    if (low <= 0 && 0 <= high) return;
    fitted.changes.push_back({at, "confidence", before, roundestIn(shifted(inner_low), shifted(inner_high)),
                              shifted(low), shifted(high), true});
  }

  const rules::Rule& rule_;
  std::vector<Sample> samples_;
  std::size_t right_of_class_;
  const Design& design_;
  const EvidenceFitParams& params_;
  std::vector<std::string> places_;
  std::vector<std::vector<double>> resamples_;
  bool only_shift_ = false;
};

}  // namespace

std::vector<FittedRule> fitEvidence(const rules::RuleSet& rules, const std::vector<CandidateExample>& examples,
                                    const EvidenceFitParams& params) {
  std::set<std::string> named;
  for (const CandidateExample& example : examples)
    if (example.is_named) named.insert(example.class_iri);
  const auto speaks = [&](const CandidateExample& example) {
    return example.is_named || !named.contains(example.class_iri);
  };
  std::map<std::string, std::size_t> right_of_class;
  for (const CandidateExample& example : examples)
    right_of_class[example.class_iri] += example.is_right && speaks(example) ? 1 : 0;
  const UsersOf users = fitting::usersOf(rules);
  std::vector<FittedRule> fitted;
  for (const rules::Rule& rule : rules.rules) {
    const Design design(rule, users);
    std::vector<Sample> samples;
    for (const CandidateExample& example : examples)
      if (example.rule_id == rule.id && speaks(example)) {
        Sample sample{{}, example.confidence, example.is_right, example.place};
        sample.row = design.rowOf(example, sample.offset);
        samples.push_back(std::move(sample));
      }
    if (!samples.empty())
      fitted.push_back(RuleFit(rule, std::move(samples), right_of_class[rule.class_iri], design, params).run());
  }
  return fitted;
}

}  // namespace cluxel::tasks
