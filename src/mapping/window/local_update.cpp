// SPDX-License-Identifier: Apache-2.0
// A window grows until it holds all that follows from the change.
#include "mapping/window/local_update.hpp"

#include <algorithm>
#include <unordered_map>

#include "mapping/build/way_telling.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/layers/rule_margins.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/window/former_objects.hpp"
#include "mapping/window/kept_objects.hpp"
#include "mapping/window/lent_decisions.hpp"
#include "mapping/window/likely_tiles.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/passed_objects.hpp"
#include "mapping/window/window_change.hpp"
#include "mapping/window/window_decision.hpp"
#include "mapping/window/window_facts.hpp"
#include "mapping/window/window_layers.hpp"
#include "mapping/window/window_statements.hpp"
#include "perception/segments/primitive_inputs.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/decide/local_reach.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

constexpr int kRings = 1;  ///< of tiles around the changed ones that a window holds at least
/// The first window holds one more, if it can: what lies beside a change may come out otherwise.
constexpr std::uint32_t kLayersOfSeam = rules::kLastLayer + 1;
constexpr std::size_t kMaxAttempts = 40;
constexpr std::size_t kNarrowAttempts = 6;  ///< later ones add the tiles around, too: each attempt costs a window

/// The tiles of a window in which everything was decided anew.
TileSet tilesDecidedWhole(const MapWindow& window, const WindowDecision& decision) {
  TileSet tiles;
  for (const TileKey& tile : window.tiles) {
    const auto here = window.primitive_of_component.find(tile);
    if (here == window.primitive_of_component.end() ||
        std::all_of(here->second.begin(), here->second.end(),
                    [&](perception::PrimitiveIndex primitive) { return decision.is_decided[primitive] != 0; }))
      tiles.insert(tile);
  }
  return tiles;
}

class LocalUpdate {
 public:
  LocalUpdate(const LayerWork& work, OutputChanges& changes, ChangedInputs inputs, LentDecisions* lent,
              const MapStrip* strip)
      : transaction_(work.transaction),
        parsed_(work.parsed),
        stages_(work.stages),
        changes_(changes),
        inputs_(inputs),
        params_(work.params),
        sink_(work.sink),
        check_(work.check),
        lent_(lent),
        strip_(strip),
        map_(strip != nullptr ? strip->shown : storedTiles(work.transaction)),
        former_summaries_(changes) {}

  /// Absent when the whole map has to be computed; then no decision was written.
  std::optional<SemanticUpdate> run() {
    const std::optional<double> reach_m = rules::localReach(parsed_.rules).reach_m;
    std::optional<SemanticState> before = storedSemanticState(transaction_);
    if (!reach_m || *reach_m > perception::kTileSize_m || !before) return std::nullopt;
    reach_m_ = *reach_m;
    clouds_ = storedClouds(transaction_);
    before_ = lent_ != nullptr ? lent_->state() : *std::move(before);
    now_ = {0, 0, 0, statementIds(transaction_), seenClouds(clouds_)};
    if (tellsPresence(before_.clouds) != tellsPresence(now_.clouds) || haveOtherTimes(before_.clouds, now_.clouds))
      return std::nullopt;
    if (inputs_ == ChangedInputs::Rules) {
      const std::optional<RuleChange> other = changeOfRules(transaction_, parsed_.rules);
      if (!other || other->former_reach_m > perception::kTileSize_m) return std::nullopt;
      reach_m_ = std::max(reach_m_, other->former_reach_m);  // beyond a seam both runs must be the same
      decided_otherwise_ = other->tiles;
      changes_.tiles.insert(other->tiles.begin(), other->tiles.end());
      if (changes_.tiles.empty() && haveSameSources(now_, before_)) return unchanged();
    }
    if (lent_ != nullptr) {
      more_ = lent_->tilesOfWide();
      passed_ = lent_->passed();
    } else if (strip_ == nullptr) {
      passed_ = passedObjects(transaction_, changedRays(before_.clouds, now_.clouds));
    }
    const std::vector<SemanticState> maps = lent_ != nullptr ? lent_->statesOfMaps() : std::vector{before_};
    WindowStatements statements(transaction_, parsed_, stages_, clouds_, changes_, maps, now_);
    for (; attempt_ < kMaxAttempts && !statements.needsWholeMap(); ++attempt_) {
      if (check_) check_(0);
      noteChanged(statements.tiles());
      if (attempt_ == 0) beginWithLikelyTiles();
      const std::optional<MapWindow> window = windowAround(transaction_, stages_, changes_, former_summaries_, map_,
                                                           more_, kRings, clouds_, params_.max_window_share);
      if (!window) return std::nullopt;
      if (auto update = decideAndWrite(*window, statements)) return update;
      if (needs_whole_map_) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  /// Absent when the window has to grow, or the whole map has to be computed.
  std::optional<SemanticUpdate> decideAndWrite(const MapWindow& window, WindowStatements& statements) {
    perception::PrimitiveInputs inputs(window.scene, stages_.summaries());
    const InputOf input_of = [&](perception::PrimitiveIndex primitive) {
      const auto [known, is_new] = inputs_of_.try_emplace(window.scene.primitives[primitive].id);
      if (is_new) known->second = inputs.hashOf(primitive);
      return known->second;
    };
    TileSet anew = perception::unionOf(statements.tiles(), decided_otherwise_);
    if (lent_ != nullptr) anew.insert(lent_->border().begin(), lent_->border().end());
    if (strip_ != nullptr) anew.insert(strip_->anew.begin(), strip_->anew.end());
    const WindowChange change = changeIn(window, changes_, anew, reach_m_, input_of);
    const rules::LocalInput input = localInputOf(window, change, lone_objects_, reach_m_);
    if (growOrGiveUp(tilesBeyond(window, change, changes_, transaction_, input.likely.layers), window))
      return std::nullopt;
    rules::ThresholdMargins margins(window.scene, parsed_.rules);
    rules::ReasoningContext context;
    context.threads = params_.threads;
    context.margins = &margins;
    context.keeps_paths = false;
    if (strip_ != nullptr) context.splits = strip_->splits;
    rules::LocalRun rules_run(input, parsed_.rules, context, reach_m_);
    if (rules_run.layers() != input.likely.layers &&
        growOrGiveUp(tilesBeyond(window, change, changes_, transaction_, rules_run.layers()), window))
      return std::nullopt;
    sink_.progress("scene", window.scene.primitives.size(), window.scene.primitives.size());
    TileSet lacking;
    auto decision = decideIn(window, change, transaction_, rules_run, lacking);
    if (!decision) {
      lacking.merge(tilesBeyond(window, change, changes_, transaction_, rules_run.layers()));
      std::erase_if(lacking, [&](const TileKey& tile) { return !map_.contains(tile) || window.tiles.contains(tile); });
      if (!growOrGiveUp(lacking, window)) needs_whole_map_ = true;
      return std::nullopt;
    }
    if (strip_ != nullptr) addWideRecords(*decision);
    if (!statements.apply(window, change, *decision)) return std::nullopt;
    const std::vector<std::uint32_t> former = formerNumbers(window, stages_, former_summaries_);
    std::vector<rules::SemanticObject> wide = wideObjectsIn(transaction_, window, *decision, former);
    needs_whole_map_ = (strip_ == nullptr && changesWideObjects(window, *decision, wide)) ||
                       (lent_ != nullptr && !lent_->isCoveredBy(*decision, wide));
    if (strip_ != nullptr) addOtherWideObjects(wide);
    if (needs_whole_map_) return std::nullopt;
    SemanticUpdate update = write({window, change, *decision, former, wide, input_of}, statements);
    updateMargins(transaction_, margins.found(), window.tiles, tilesDecidedWhole(window, *decision));
    storeNumbers(transaction_, parsed_.rules);
    return update;
  }

  /// A first window that is large enough spares an attempt.
  void beginWithLikelyTiles() {
    lone_objects_ = objectsOfLoneSeeds(parsed_.rules);
    const auto likely = [&](std::uint32_t layers) {
      return perception::unionOf(likelyTiles(transaction_, map_, changes_.tiles, lone_objects_, reach_m_, layers),
                                 more_);
    };
    TileSet wide = likely(kLayersOfSeam + 1);
    more_ = isTooLarge(wide.size()) ? likely(kLayersOfSeam) : std::move(wide);
  }

  /// Adds `beyond` to the next window. True when this window cannot be used, or the whole map has to be computed.
  bool growOrGiveUp(const TileSet& beyond, const MapWindow& window) {
    more_ = perception::unionOf(std::move(more_), attempt_ < kNarrowAttempts ? beyond : perception::grown(beyond));
    needs_whole_map_ = attempt_ == 0 && willBeTooLarge(window.tiles, beyond);
    return needs_whole_map_ || !beyond.empty();
  }

  /// Tiles that are not shown yet are told when they are.
  void noteChanged(const TileSet& tiles) {
    std::set_intersection(tiles.begin(), tiles.end(), map_.begin(), map_.end(),
                          std::inserter(changes_.tiles, changes_.tiles.end()));
  }

  /// Gives class-wide objects a record as soon as a strip has some of them.
  void addWideRecords(const WindowDecision& decision) {
    for (const rules::SemanticObject& object : decision.objects) {
      if (!object.is_class_wide || storedRecord(transaction_, object.id)) continue;
      const ObjectRecord record{object.class_iri, object.rule_id, object.confidence, true, {}};
      transaction_.putBlock(tables::kObjects, tables::keyOf(object.id), toBytes(record));
      ++before_.objects;
    }
  }

  /// Class-wide objects of which the strip has nothing are told again, too: what tiles that were not shown added to
  /// them is gone.
  void addOtherWideObjects(std::vector<rules::SemanticObject>& wide) const {
    for (const ContentHash& id : strip_->wide) {
      const auto record = storedRecord(transaction_, id);
      if (!record || std::any_of(wide.begin(), wide.end(), [&](const auto& object) { return object.id == id; }))
        continue;
      rules::SemanticObject& object = wide.emplace_back();
      object.id = id, object.is_class_wide = true;
      object.class_iri = record->class_iri, object.rule_id = record->rule_id, object.confidence = record->confidence;
    }
  }

  /// Leaves the layers as they are: other thresholds that decide nothing otherwise.
  SemanticUpdate unchanged() {
    storeNumbers(transaction_, parsed_.rules);
    keepToldWays(transaction_);
    SemanticUpdate update;
    update.is_local = true;
    update.objects = before_.objects, update.cluxels = before_.cluxels, update.primitives = before_.primitives;
    if (!now_.statements.empty())
      update.statements = toldOutcomes(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction_)));
    return update;
  }

  /// A window that ends up too large is assembled for nothing. After the first attempt about as many tiles follow as it
  /// asked for.
  bool willBeTooLarge(const TileSet& window, const TileSet& beyond) const {
    return isTooLarge(window.size() + 2 * beyond.size());
  }
  bool isTooLarge(std::size_t tiles) const {
    return static_cast<double>(tiles) > params_.max_window_share * static_cast<double>(map_.size());
  }

  /// Whether a class-wide object comes or goes, or is not the ground, which alone has neither neighbours nor facts from
  /// rays: such a change is told by the whole map.
  bool changesWideObjects(const MapWindow& window, const WindowDecision& decision,
                          const std::vector<rules::SemanticObject>& there) const {
    for (const rules::SemanticObject& object : decision.objects)
      if (object.is_class_wide && !storedRecord(transaction_, object.id)) return true;
    return std::any_of(there.begin(), there.end(), [&](const rules::SemanticObject& object) {
      if (object.class_iri != rdf::vocabulary::clx("Ground")) return true;
      const auto record = storedRecord(transaction_, object.id);
      return object.parts.empty() && record &&
             std::all_of(record->tiles.begin(), record->tiles.end(),
                         [&](const TileKey& tile) { return window.tiles.contains(tile); });
    });
  }

  SemanticUpdate write(const DecidedWindow& decided, WindowStatements& statements) {
    const auto& [window, change, decision, former, wide, input_of] = decided;
    SemanticUpdate update;
    update.is_local = true, update.tiles_decided = window.tiles.size();
    std::vector<rules::SemanticObject> made = decision.objects;
    std::erase_if(made, [](const rules::SemanticObject& object) { return object.is_class_wide; });
    update.objects = before_.objects + made.size() - decision.replaced.size();
    if (strip_ == nullptr ? params_.lists_objects : strip_->keeps_lists) {
      DifferentObjects& different = update;
      different = differenceOf(replacedObjects(window, decision), membersOf(made, window.scene.cluxels));
    }
    former_summaries_.drop();
    count(window, change, update);
    sink_.progress("objects", made.size(), made.size());
    const bool have_ways = stages_.updateWays(transaction_, params_.threads) || lent_ != nullptr;
    const std::set<std::string> touched = lent_ != nullptr ? lent_->addFacts() : std::set<std::string>();
    const std::optional<WayGraph> ways = have_ways ? std::optional(storedWays(transaction_)) : std::nullopt;
    const RetiredThings retired = strip_ != nullptr ? strip_->retired : RetiredThings{};
    writeWindowFacts(transaction_, {parsed_, stages_, clouds_, strip_ != nullptr ? strip_->told_clouds : before_.clouds,
                                    decided, statements, retired, ways ? &*ways : nullptr, touched, params_.threads,
                                    strip_ != nullptr ? strip_->later : nullptr, lent_ != nullptr});
    writeLayers(transaction_, decided, changes_);
    if (strip_ != nullptr) eraseRetiredRecords(decision);
    statements.store(transaction_, window);
    if (strip_ == nullptr && !now_.statements.empty())
      update.statements = toldOutcomes(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction_)));
    updatePassedObjects(transaction_, parsed_, stages_, clouds_, passed_, window, params_.threads);
    if (strip_ == nullptr) tellWaysWithoutGone(transaction_, parsed_, stages_, params_.threads);
    if (check_) check_(0);
    if (strip_ == nullptr) update.whole_rules = inferFacts(transaction_, parsed_.inputs, sink_, check_);
    now_.objects = update.objects, now_.cluxels = update.cluxels, now_.primitives = update.primitives;
    storeSemanticState(transaction_, now_);
    keepToldWays(transaction_);
    sink_.progress("facts", 1, 1);
    return update;
  }

  /// Of former objects that the strip did not make again.
  void eraseRetiredRecords(const WindowDecision& decision) {
    std::set<ContentHash> gone = strip_->retired.objects;
    for (const rules::SemanticObject& object : decision.objects) gone.erase(object.id);
    for (const ContentHash& id : gone) transaction_.eraseBlock(tables::kObjects, tables::keyOf(id));
  }

  std::vector<ObjectMembers> replacedObjects(const MapWindow& window, const WindowDecision& decision) {
    const auto is_replaced = [&](const ContentHash& object) { return decision.replaced.contains(object); };
    const auto changes = [&](const TileKey& tile) { return strip_ != nullptr && strip_->as_before.contains(tile); };
    FormerObjects members(transaction_, stages_, former_summaries_, changes,
                          motionsBetween(transaction_.before(), before_.clouds, clouds_));
    for (const auto& [tile, layer] : window.layers) members.add(layer, is_replaced);
    return members.take();
  }

  void count(const MapWindow& window, const WindowChange& change, SemanticUpdate& update) const {
    update.primitives = before_.primitives - change.gone.size();
    for (std::size_t i = 0; i < window.scene.primitives.size(); ++i)
      if (window.is_cut[i] == 0 && !window.known.contains(window.scene.primitives[i].id)) ++update.primitives;
    update.cluxels = before_.cluxels;
    for (const TileKey& tile : changes_.tiles) {
      if (const auto layer = window.layers.find(tile); layer != window.layers.end())
        update.cluxels -= layer->second.size();
      if (const auto now = stages_.summaries().find(tile); now != stages_.summaries().end())
        update.cluxels += now->second.size();
    }
  }

  rdf::WriteTransaction& transaction_;
  const ParsedInputs& parsed_;
  TileStages& stages_;
  OutputChanges& changes_;  ///< gets the tiles in which statements change
  ChangedInputs inputs_;
  UpdateParams params_;
  ProgressSink& sink_;
  const rdf::InferenceCheck& check_;
  LentDecisions* lent_;        ///< null when no other map lends any
  const MapStrip* strip_;      ///< null when the map has all of its tiles
  TileSet map_;                ///< the tiles that count
  TileSet decided_otherwise_;  ///< tiles in which thresholds of the rules moved beyond what was measured
  double reach_m_ = 0;
  std::set<ContentHash> lone_objects_;
  std::set<ContentHash> passed_;  ///< objects that rays pass of clouds that came or went
  TileSet more_;                  ///< tiles that the window holds beside those around the change
  std::size_t attempt_ = 0;
  bool needs_whole_map_ = false;
  std::vector<Cloud> clouds_;
  SemanticState before_, now_;
  FormerSummaries former_summaries_;
  std::unordered_map<ContentHash, std::uint64_t> inputs_of_;  ///< hashes of primitives, kept from attempt to attempt
};

}  // namespace

std::vector<ContentHash> statementIds(const rdf::ReadTransaction& transaction) {
  std::vector<ContentHash> ids;
  for (const Statement& statement : storedStatements(rdf::QuadReader(transaction))) ids.push_back(statement.id());
  return ids;
}

std::optional<SemanticUpdate> updateAround(const LayerWork& work, OutputChanges& changes, ChangedInputs inputs,
                                           LentDecisions* lent, const MapStrip* strip) {
  return LocalUpdate(work, changes, inputs, lent, strip).run();
}

}  // namespace cluxel::mapping
