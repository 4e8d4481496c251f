// SPDX-License-Identifier: Apache-2.0
// Only facts of ways that follow from something else than before are looked up in the store.
#include "mapping/build/way_telling.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mapping/build/freed_tiles.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/facts/fact_units.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/facts/way_facts.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

class WayReplacement {
 public:
  WayReplacement(const rdf::QuadReader& stored, FactSink& facts, FactPatch& patch)
      : stored_(stored), facts_(facts), patch_(patch) {}

  void run(rdf::WriteTransaction& transaction, const WayGraph& ways) {
    const auto before = storedToldWays(transaction);
    if (!before) forgetAll();
    const ToldWays told = addWayFacts(ways, before.value_or(std::vector<ToldWay>()), facts_);
    for (const auto& [kind, name] : told.exchanged) forget(facts_.iri(iriOfWay(kind, name)));
    storeToldWays(transaction, told.now);
  }

 private:
  void forget(rdf::TermId subject) {
    const std::string geo(rdf::vocabulary::kGeo);
    for (const std::string_view property : {"hasGeometry", "hasCentroid", "hasBoundingBox"})
      for (const rdf::TermId node : patch_.objectsOf(subject, facts_.property(geo + std::string(property))))
        patch_.replace(node);
    patch_.replace(subject);
  }

  void forgetAll() {
    const rdf::TermId type = facts_.property(rdf::vocabulary::rdf("type"));
    using Kind = std::pair<std::string_view, WayKind>;
    for (const auto& [name, kind] : {Kind{"Way", WayKind::Way}, Kind{"Junction", WayKind::Junction},
                                     Kind{"Region", WayKind::Region}, Kind{"Kerb", WayKind::Kerb}})
      for (const rdf::TermId subject : patch_.subjectsOf(type, facts_.iri(rdf::vocabulary::clx(name))))
        if (stored_.termOf(subject).text.starts_with(iriOfWays(kind))) forget(subject);  // else an object
  }

  const rdf::QuadReader& stored_;
  FactSink& facts_;
  FactPatch& patch_;
};

}  // namespace

void replaceWayFacts(rdf::WriteTransaction& transaction, const WayGraph& ways, const rdf::QuadReader& stored,
                     FactSink& facts, FactPatch& patch) {
  WayReplacement(stored, facts, patch).run(transaction, ways);
}

bool freeWays(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages, unsigned threads) {
  const perception::TileSet changed =
      updateFreedTiles(transaction, parsed.model, parsed.inputs.params, stages.takeChangedOutputs(), threads);
  return !changed.empty() && !updateWayTiles(transaction, changed, {}, threads).empty();
}

void tellWaysWithoutGone(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                         unsigned threads) {
  if (!freeWays(transaction, parsed, stages, threads)) return;
  FactSink facts(transaction, rdf::vocabulary::kGraphObserved, FactsOf::Collected);
  const rdf::ReadTransaction& reading = transaction;
  const rdf::QuadReader stored(reading);
  FactPatch patch(stored, facts.iri(rdf::vocabulary::kGraphObserved));
  replaceWayFacts(transaction, storedWays(transaction), stored, facts, patch);
  patch.write(facts.take(), facts.writer());
  facts.writer().flush();
  forgetFactUnits(transaction);
}

}  // namespace cluxel::mapping
