// SPDX-License-Identifier: Apache-2.0
// Copies facts of another map's graph `observed`.
#pragma once

#include <set>
#include <string>
#include <unordered_set>

#include "base/content_hash.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// What facts are not copied about, because it is told anew.
struct NotLent {
  std::set<ContentHash> objects, primitives;
  std::set<ContentHash> wide;  ///< class-wide objects: of these only their other primitives are copied
};

/// Copies the facts of a lender, without facts about ways.
class LentFacts {
 public:
  LentFacts(const rdf::ReadTransaction& lender, const NotLent& not_lent);

  /// Adds the facts to the same graph of another map. Returns the ground patches (IRIs) that primitives touch which are
  /// not copied.
  std::set<std::string> add(rdf::WriteTransaction& into);

 private:
  using Ids = std::unordered_set<rdf::TermId>;
  void leaveOut(const ContentHash& object, Ids& subjects) const;
  bool isLent(const rdf::QuadIds& quad);
  bool isOfWay(rdf::TermId subject);
  rdf::TermId idOf(const std::string& iri) const;

  rdf::QuadReader lender_;
  rdf::TermId graph_, root_, has_cloud_, has_primitive_, touches_ground_;
  Ids objects_, primitives_, of_wide_;  ///< subjects that are left out
  rdf::TermId subject_ = rdf::kNoTerm;  ///< the last one looked at
  bool subject_is_of_way_ = false;
  std::set<std::string> touched_patches_;
};

}  // namespace cluxel::mapping
