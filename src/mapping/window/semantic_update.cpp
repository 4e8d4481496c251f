// SPDX-License-Identifier: Apache-2.0
// A change is decided around what changed; a change of most of the map is computed as a whole.
#include "mapping/window/semantic_update.hpp"

#include "mapping/clouds/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_state.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/strips/growth_update.hpp"
#include "mapping/strips/map_strips.hpp"
#include "mapping/strips/whole_update.hpp"
#include "mapping/window/lent_decisions.hpp"
#include "mapping/window/local_update.hpp"
#include "rdf/store/quad_journal.hpp"

namespace cluxel::mapping {

namespace {

bool hasOtherInference(const rdf::ReadTransaction& transaction, const MapInputs& inputs) {
  const MapInputs before = storedInputs(transaction);
  return before.ontology != inputs.ontology || before.sparql_rules != inputs.sparql_rules;
}

/// Whether quads came or went since the last inference, as those of graph operator of a map that was merged.
bool hasOtherQuads(const rdf::WriteTransaction& transaction) {
  const auto change = rdf::changesOf(transaction);
  return !change || !change->added.empty() || !change->removed.empty();
}

/// Whether the change is too large for the memory of one window, and large enough a share of the map that deciding the
/// whole map strip by strip takes at most some three times as long.
bool isLarge(const LayerWork& work, const OutputChanges& changes) {
  constexpr double kLargeShare = 0.3;  // of the tiles, with those beside them
  if (!work.params.is_first_of_commit || !canBeInStrips(work)) return false;
  const perception::TileSet all = storedTiles(work.transaction);
  const std::size_t around = perception::withRing(changes.tiles, all).size();
  return static_cast<double>(around) > kLargeShare * static_cast<double>(all.size()) &&
         cluxelsIn(work.transaction, changes.tiles, work.stages.summaries()) > work.params.whole_cluxels;
}

}  // namespace

IsInBoth keptBy(const rdf::ReadTransaction& transaction, const SemanticUpdate& update) {
  std::set<ContentHash> listed;
  for (const ObjectMembers& object : update.after) listed.insert(object.id);
  return [&transaction, listed = std::move(listed)](const ContentHash& object) {
    return !listed.contains(object) && storedRecord(transaction, object).has_value();
  };
}

SemanticUpdate updateSemanticLayer(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                                   ChangedInputs inputs, const UpdateParams& params, ProgressSink& sink,
                                   const rdf::InferenceCheck& check) {
  const LayerWork work{transaction, parsed, stages, params, sink, check};
  OutputChanges changes = stages.takeChanges();
  if (inputs == ChangedInputs::Inference)
    if (auto update = updateInference(work, changes)) return *std::move(update);
  if (inputs == ChangedInputs::Scans) {
    if (auto update = updateByGrowth(work, changes)) return *std::move(update);
    if (changes.lender == nullptr && isLarge(work, changes)) return updateAll(work, std::move(changes));
  }
  std::optional<LentDecisions> lent;
  if (inputs == ChangedInputs::Scans && changes.lender != nullptr) {
    lent.emplace(transaction, *changes.lender);
    lent->lend(changes, stages);
  }
  const bool infers_otherwise = inputs == ChangedInputs::Rules && hasOtherInference(transaction, parsed.inputs);
  if (infers_otherwise) writeOntology(transaction, parsed.inputs);
  if (inputs == ChangedInputs::Scans || inputs == ChangedInputs::Rules)
    if (auto update = updateAround(work, changes, inputs, lent ? &*lent : nullptr, nullptr)) {
      const bool may_infer_otherwise =
          infers_otherwise || (inputs == ChangedInputs::Rules && hasOtherQuads(transaction));
      if (may_infer_otherwise && update->tiles_decided == 0)
        update->whole_rules = inferFacts(transaction, parsed.inputs, sink, check);
      update->took_decisions = lent.has_value();
      if (changes.has_copied_map) eraseRowsWithoutObject(transaction);
      return *std::move(update);
    }
  if (lent) lent->takeBack();
  return updateAll(work, std::move(changes));
}

}  // namespace cluxel::mapping
