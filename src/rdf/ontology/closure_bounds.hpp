// SPDX-License-Identifier: Apache-2.0
// How far a closure may go, counted while it runs.
#pragma once

#include <cstdint>
#include <string>

#include "cluxel/error.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

/// Counts derived facts and steps of work, and ends a closure that grows beyond its limits.
class ClosureBounds {
 public:
  ClosureBounds(const QuadReader& reader, const ClosureLimits& limits) : reader_(reader), limits_(limits) {}

  void addFact(TermId property) {
    if (++facts_ > limits_.max_facts) fail(property, "more than " + std::to_string(limits_.max_facts) + " facts");
  }
  void addStep(TermId property) {
    if (++steps_ > limits_.max_steps) fail(property, "more than " + std::to_string(limits_.max_steps) + " steps");
    if (steps_ % kStepsBetweenChecks == 0 && limits_.check) limits_.check(facts_ * kBytesOfFact);
  }

 private:
  static constexpr std::uint64_t kStepsBetweenChecks = 4096;
  /// In the lists of a property, in those that are compared with the store, and in the store's pages.
  static constexpr std::size_t kBytesOfFact = 200;
  [[noreturn]] void fail(TermId property, const std::string& what) const {
    const Term name = reader_.termOf(property);
    const bool is_of_classes = name.text == vocabulary::rdfs("subClassOf") || name.text == vocabulary::rdf("type");
    throw Error(ErrorKind::BudgetExceeded,
                "the closure was ended because it takes " + what + ", at the last of " + toNTriples(name) + ": " +
                    (is_of_classes ? "too many superclasses lie above each other; make the chains of rdfs:subClassOf "
                                     "shorter, or the classes fewer"
                                   : "remove the statement that makes this property or one below it transitive, "
                                     "symmetric or inverse, or the cycle in which it lies"));
  }

  const QuadReader& reader_;
  ClosureLimits limits_;
  std::uint64_t facts_ = 0, steps_ = 0;
};

}  // namespace cluxel::rdf
