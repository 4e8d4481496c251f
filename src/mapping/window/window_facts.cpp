// SPDX-License-Identifier: Apache-2.0
// Only what a change concerns is looked up in the store.
#include "mapping/window/window_facts.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "mapping/build/way_telling.hpp"
#include "mapping/facts/fact_order.hpp"
#include "mapping/facts/fact_patch.hpp"
#include "mapping/facts/map_facts.hpp"
#include "mapping/facts/object_facts.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/layers/wide_tile.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/window/kept_objects.hpp"
#include "mapping/window/window_presence.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

using perception::PrimitiveIndex;

class FactWriting {
 public:
  FactWriting(rdf::WriteTransaction& transaction, const WindowFacts& sources)
      : transaction_(transaction),
        sources_(sources),
        scene_(sources.decided.window.scene),
        facts_(transaction, rdf::vocabulary::kGraphObserved, FactsOf::Collected),
        graph_(facts_.iri(rdf::vocabulary::kGraphObserved)),
        stored_(static_cast<const rdf::ReadTransaction&>(transaction)),
        patch_(stored_, graph_) {
    for (const rules::SemanticObject& object : sources.decided.decision.objects)
      (object.is_class_wide ? wide_ : made_).push_back(object);
  }

  void run() {
    replaceClouds();
    replacePrimitives();
    replaceObjects();
    replaceWideObjects();
    replaceStatements();
    if (sources_.ways != nullptr) replaceWayFacts(transaction_, *sources_.ways, stored_, facts_, patch_);
    for (const std::string& patch : sources_.more_patches) touched_.insert(iri(patch));
    patch_.write(facts_.take(), facts_.writer());
    renewPatches();
  }

 private:
  rdf::TermId iri(const std::string& text) { return facts_.iri(text); }

  void replaceClouds() {
    using Told = std::pair<ContentHash, std::optional<double>>;  // content and time
    std::map<ContentHash, Told> before;
    for (const SeenCloud& cloud : sources_.clouds_before) before.emplace(cloud.id, Told(cloud.content, cloud.time_s));
    const rdf::TermId root = iri(rdf::iriOfMapRoot()), has_cloud = facts_.property("hasCloud");
    const auto forget = [&](const ContentHash& id) {
      const rdf::TermId subject = iri(rdf::iriOfCloud(id));
      patch_.replace(subject);
      patch_.replace(root, has_cloud, subject);
    };
    std::map<ContentHash, Told> now;
    for (const SeenCloud& cloud : seenClouds(sources_.clouds)) now.emplace(cloud.id, Told(cloud.content, cloud.time_s));
    for (const auto& [id, told] : before)
      if (!now.contains(id)) forget(id);
    for (const Cloud& cloud : sources_.clouds) {
      if (const auto known = before.find(cloud.id); known != before.end() && known->second == now.at(cloud.id))
        continue;
      forget(cloud.id);
      addCloud(cloud, facts_);
      facts_.link(root, "hasCloud", iri(rdf::iriOfCloud(cloud.id)));
    }
  }

  void replacePrimitives() {
    const rdf::TermId touches = facts_.property("touchesGround");
    const auto forget = [&](const ContentHash& id) {
      const rdf::TermId subject = iri(rdf::iriOfPrimitive(id));
      for (const rdf::TermId patch : patch_.objectsOf(subject, touches)) touched_.insert(patch);
      patch_.replace(subject);
    };
    for (const ContentHash& id : sources_.decided.change.gone) forget(id);
    for (const ContentHash& id : sources_.retired.primitives) {
      forget(id);
      patch_.replace({}, facts_.property("hasPrimitive"), iri(rdf::iriOfPrimitive(id)));  // also of the ground
    }
    for (const PrimitiveIndex i : primitivesByPlace(scene_)) {
      if (sources_.decided.change.is_dirty[i] == 0 || sources_.decided.decision.is_decided[i] == 0) continue;
      forget(scene_.primitives[i].id);
      addPrimitive(scene_, i, facts_);
      if (const auto patch = touchedPatch(scene_, i)) touched_.insert(iri(*patch));
    }
  }

  std::vector<rdf::TermId> subjectsOf(const ContentHash& object) {
    return subjectsOfObject(stored_, graph_, iri(rdf::iriOfObject(object)));
  }

  void forgetObject(const ContentHash& object) {
    for (const rdf::TermId subject : subjectsOf(object)) patch_.replace(subject);
    patch_.replace({}, facts_.property("near"), iri(rdf::iriOfObject(object)));
  }

  void replaceObjects() {
    for (const auto& [id, record] : sources_.decided.decision.replaced) forgetObject(id);
    for (const ContentHash& id : sources_.retired.objects) forgetObject(id);
    const WindowPresence presence = updatePresenceIn(transaction_, sources_, made_);
    const std::vector<std::vector<ContentHash>> near = nearOfMade();
    rules::ReasoningResult result;
    result.objects = made_;
    const auto sightings =
        sightingsOf(sources_.stages.summaries(), sources_.stages.grid(), objectOfCluxel(result, scene_.cluxels.size()));
    addObjectFacts(
        {sources_.parsed.inputs, sources_.clouds, scene_, result, sightings, presence.times, presence.rays, near, {}},
        facts_);
    for (std::size_t i = 0; i < made_.size(); ++i) {
      forgetObject(made_[i].id);
      for (const ContentHash& other : near[i])
        facts_.link(iri(rdf::iriOfObject(other)), "near", iri(rdf::iriOfObject(made_[i].id)));
    }
    for (const KeptPresence& kept : presence.kept)
      replaceRayFacts(iri(rdf::iriOfObject(kept.object)), kept.times, kept.rays, patch_, facts_);
  }

  std::vector<std::vector<ContentHash>> nearOfMade() const {
    const WindowOwners owners = ownersIn(sources_.decided.window, sources_.decided.decision, sources_.decided.former);
    std::vector<rules::SemanticObject> named;
    for (const ContentHash& id : owners.objects) {
      rules::SemanticObject& object = named.emplace_back();
      object.id = id;
      object.class_iri = classOf(id);
    }
    const auto near_all = nearOf(named, scene_.cluxels, owners.owner_of);
    std::map<ContentHash, std::size_t> number;
    for (std::size_t i = 0; i < named.size(); ++i) number.emplace(named[i].id, i);
    std::vector<std::vector<ContentHash>> near;
    for (const rules::SemanticObject& object : made_) near.push_back(near_all[number.at(object.id)]);
    return near;
  }

  std::string classOf(const ContentHash& id) const {
    for (const rules::SemanticObject& object : sources_.decided.decision.objects)
      if (object.id == id) return object.class_iri;
    const auto record = storedRecord(transaction_, id);
    return record ? record->class_iri : std::string();
  }

  /// Of class-wide objects the window holds a part: their primitives are exchanged one by one, and what is merged over
  /// all tiles is made anew.
  void replaceWideObjects() {
    replaceWideTiles(transaction_, wideTilesOf(scene_, sources_.stages.summaries(), sources_.decided.wide),
                     sources_.decided.window.tiles);
    const std::vector<WidePart> parts = mergedParts(storedWideTiles(transaction_));
    rules::ReasoningResult result;
    for (const rules::SemanticObject& object : sources_.decided.wide)
      result.objects.push_back(wideFacts(object, parts));
    const rdf::TermId has_primitive = facts_.property("hasPrimitive"), has_part = facts_.property("hasPart");
    const std::vector<rdf::TermId> exchanged = exchangedPrimitives();
    for (const rules::SemanticObject& object : result.objects) {
      for (const rdf::TermId subject : subjectsOf(object.id)) patch_.replaceBut(subject, has_primitive);
      std::vector<rdf::TermId> owners = patch_.objectsOf(iri(rdf::iriOfObject(object.id)), has_part);
      owners.push_back(iri(rdf::iriOfObject(object.id)));
      for (const rdf::TermId owner : owners)
        for (const rdf::TermId primitive : exchanged) patch_.replace(owner, has_primitive, primitive);
    }
    addObjectFacts({sources_.parsed.inputs, sources_.clouds, scene_, result, {}, {}, {}, {}, parts}, facts_);
  }

  /// The object with those primitives of the window that are decided anew.
  rules::SemanticObject wideFacts(const rules::SemanticObject& object, const std::vector<WidePart>& parts) const {
    rules::SemanticObject told = object;
    told.parts.clear();
    for (const WidePart& wide : parts)
      if (wide.object == object.id) told.parts.push_back({wide.part_class, {}, {}});
    for (const rules::SemanticObject& decided : wide_)
      for (const rules::ObjectPart& part : decided.parts)
        for (rules::ObjectPart& own : told.parts)
          if (decided.id == object.id && own.part_class == part.part_class) own.primitives = part.primitives;
    return told;
  }

  void replaceStatements() {
    for (const ContentHash& id : sources_.statements.exchanged()) patch_.replace(iri(rdf::iriOfStatement(id)));
    addStatementFacts(sources_.statements.outcomes(), facts_);
  }

  std::vector<rdf::TermId> exchangedPrimitives() {
    std::vector<rdf::TermId> exchanged;
    for (const ContentHash& id : sources_.decided.change.gone) exchanged.push_back(iri(rdf::iriOfPrimitive(id)));
    for (PrimitiveIndex i = 0; i < scene_.primitives.size(); ++i)
      if (sources_.decided.decision.is_decided[i] != 0)
        exchanged.push_back(iri(rdf::iriOfPrimitive(scene_.primitives[i].id)));
    return exchanged;
  }

  /// A ground patch is there as long as some primitive touches it.
  void renewPatches() {
    const rdf::QuadReader now(static_cast<const rdf::ReadTransaction&>(transaction_));
    const rdf::TermId touches = facts_.property("touchesGround"), type = facts_.property(rdf::vocabulary::rdf("type"));
    const rdf::TermId patch_class = iri(rdf::vocabulary::clx("GroundPatch"));
    for (const rdf::TermId patch : touched_) {
      rdf::QuadCursor cursor = now.scan({.s = {}, .p = touches, .o = patch, .g = graph_});
      rdf::QuadIds quad;
      if (cursor.next(quad))
        facts_.writer().add(rdf::QuadIds{patch, type, patch_class, graph_});
      else
        facts_.writer().remove(rdf::QuadIds{patch, type, patch_class, graph_});
    }
    facts_.writer().flush();
  }

  rdf::WriteTransaction& transaction_;
  const WindowFacts& sources_;
  const perception::Scene& scene_;
  FactSink facts_;
  rdf::TermId graph_;
  rdf::QuadReader stored_;
  FactPatch patch_;
  std::vector<rules::SemanticObject> made_, wide_;
  std::set<rdf::TermId> touched_;  ///< ground patches
};

}  // namespace

void writeWindowFacts(rdf::WriteTransaction& transaction, const WindowFacts& facts) {
  FactWriting(transaction, facts).run();
  forgetFactUnits(transaction);
}

}  // namespace cluxel::mapping
