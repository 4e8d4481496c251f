// SPDX-License-Identifier: Apache-2.0
// Replaces some facts of a stored graph by others.
#pragma once

#include <optional>
#include <vector>

#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// The subjects of an object's facts in a graph: itself, its parts, its geometry and its observations.
std::vector<rdf::TermId> subjectsOfObject(const rdf::QuadReader& stored, rdf::TermId graph, rdf::TermId object);

class FactPatch {
 public:
  FactPatch(const rdf::QuadReader& stored, rdf::TermId graph) : stored_(stored), graph_(graph) {}

  /// The stored facts that fit are removed, as far as they are not given again. Parts that are absent fit all.
  void replace(std::optional<rdf::TermId> subject, std::optional<rdf::TermId> property = {},
               std::optional<rdf::TermId> object = {});
  /// All of a subject but those of one property.
  void replaceBut(rdf::TermId subject, rdf::TermId kept_property);
  /// The stored objects, or subjects, of facts.
  std::vector<rdf::TermId> objectsOf(rdf::TermId subject, rdf::TermId property) const;
  std::vector<rdf::TermId> subjectsOf(rdf::TermId property, rdf::TermId object) const;

  /// Writes the difference; `fresh` are the facts that are to be there. To be called once.
  void write(std::vector<rdf::QuadIds> fresh, rdf::QuadWriter& writer);

 private:
  const rdf::QuadReader& stored_;
  rdf::TermId graph_;
  std::vector<rdf::QuadIds> old_;  ///< in any order, some more than once
};

}  // namespace cluxel::mapping
