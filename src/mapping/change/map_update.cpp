// SPDX-License-Identifier: Apache-2.0
// After the update, what it changes is inferred. When statements came or went, the objects around them are decided
// again; when rules use `ask:`, all objects.
#include "mapping/change/map_update.hpp"

#include <chrono>
#include <optional>

#include "base/file_bytes.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/stage_clock.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/held_notes.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/map_state.hpp"
#include "mapping/statements/deleted_statements.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/refused_quad.hpp"
#include "mapping/statements/stated_subjects.hpp"
#include "mapping/statements/stated_values.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/statements/statement_history.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/store/flush_poll.hpp"

namespace cluxel::mapping {
namespace {

using Clock = std::chrono::steady_clock;

/// What the inference after an update may use: the update's deadline, and as much memory as the update itself.
rdf::InferenceCheck checkOf(const sparql::QueryBudget& budget, Clock::time_point start) {
  const auto held = [budget, start](std::size_t bytes) {
    const auto refuse = [](const std::string& what) {
      throw Error(ErrorKind::BudgetExceeded, "update: its budget of " + what +
                                                 " is exceeded by what had to be inferred; nothing was changed. Raise "
                                                 "the budget, or state less at once");
    };
    if (budget.poll) budget.poll();
    if (budget.deadline && Clock::now() - start > *budget.deadline) refuse("time");
    if (budget.max_memory_bytes != 0 && bytes > budget.max_memory_bytes) refuse("memory");
  };
  return {held, budget.max_memory_bytes};
}

/// Checks and records statements that the update made or withdrew as quads. False when there are none.
bool takeNewStatements(rdf::WriteTransaction& transaction, const rules::ClassCatalogue& classes,
                       const std::string& author, ProgressSink& sink) {
  const NewStatements news = newStatements(transaction);
  std::vector<ContentHash> made;
  for (const Statement& statement : news.made) {
    const std::string iri = rdf::iriOfStatement(statement.id());
    try {
      requireStatableOrDormant(statement, classes, sink);
      requireNoWholeClass(transaction, statement);
    } catch (const Error& fault) {
      if (!isFaultOfStatement(fault)) throw;
      throw RefusedQuad({Term::iri(iri), {}, {}, {}}, "the statement <" + iri + ">: " + fault.what());
    }
    made.push_back(statement.id());
  }
  recordStatements(transaction, made, news.withdrawn, author);
  return !made.empty() || !news.withdrawn.empty();
}

}  // namespace

rdf::WriteTransaction writeOrCopy(const std::filesystem::path& file, bool is_dry_run, ProgressSink& sink) {
  const std::filesystem::path target = withoutLinks(file);
  if (!is_dry_run || !mayBeThere(target) || mayWriteMap(target)) return rdf::writeMap(file);
  sink.note(noteOfCopy(file));
  return rdf::Environment::temporaryCopyOf(target)->write();
}

ChangeReport inferAfterUpdate(rdf::WriteTransaction& transaction, const std::filesystem::path& file,
                              const std::set<rdf::QuadIds>& before, ProgressSink& sink,
                              const rdf::InferenceCheck& check, const MapUpdateParams& params) {
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  anchorStatedObjects(transaction, parsed, before, sink);
  const bool has_news = takeNewStatements(transaction, parsed.rules.catalogue, params.author, sink);
  ChangeReport report;
  report.has_changes = true;
  report.class_names = namesOf(parsed.rules.catalogue);
  if (!parsed.rules.asks_map && !has_news) {
    addWholeRules(inferFacts(transaction, parsed.inputs, sink, check), report.rules_evaluated_whole, sink);
    keepToldWays(transaction);
    tellMap(report, transaction);
    report.statements = toldOutcomes(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction)));
    return report;
  }
  requireFinishedInputs(transaction, file);  // what is decided anew must fit what is kept
  const double started_s = secondsNow();
  StageClock clock(sink);
  TileStages stages(parsed.model, parsed.inputs.params);
  if (check) check(0);
  SemanticUpdate layers =
      updateSemanticLayer(transaction, parsed, stages, ChangedInputs::Scans, params.layers, clock, check);
  if (const std::string note = summaryOf(layers.statements); !note.empty()) sink.note(note);
  addWholeRules(layers.whole_rules, report.rules_evaluated_whole, sink);
  const Activity activity{params.operation, started_s, secondsNow(), clock.seconds()};
  addLineage(transaction, addActivity(transaction, activity, {}, parsed.inputs),
             compareStates(layers.before, layers.after));
  writeThings(transaction, dateTimeText(activity.ended_s), layers.before, layers.after, keptBy(transaction, layers));
  tellMap(report, transaction);
  report.tiles_decided = layers.tiles_decided;
  report.local_commits = layers.is_local ? 1 : 0;
  report.statements = std::move(layers.statements);
  tellObjects(report, std::move(layers));
  return report;
}

MapUpdateReport updateMap(const std::filesystem::path& file, const std::string& update,
                          const sparql::UpdateOptions& options, ProgressSink& sink, const MapUpdateParams& params) {
  HeldNotes notes(sink);
  const rdf::InferenceCheck check = checkOf(options.query.budget, Clock::now());
  rdf::WriteTransaction transaction = writeOrCopy(file, params.dry_run, sink);
  MapUpdateReport report;
  const bool is_map = report.is_map = requireFinished(file, transaction);
  refuseUncommittedBuild(transaction, file);
  if (is_map && options.any_graph_writable)
    throw Error(ErrorKind::InvalidArgument, file.string() +
                                                ": is a map, of which only the operator's statements may be written; "
                                                "other graphs can only be written in a store that was not made by a "
                                                "build");
  const std::set<rdf::QuadIds> before = is_map ? quadsThatNameResources(transaction) : std::set<rdf::QuadIds>();
  std::optional<DeletedStatements> deleted;
  sparql::UpdateOptions run_options = options;
  if (is_map) {
    deleted.emplace(transaction);
    run_options.on_removal = [&deleted](const Quad& quad) { deleted->add(quad); };
    run_options.remedy_for = [&deleted](const Quad& triple) { return deleted->remedyFor(triple); };
  }
  static_cast<sparql::UpdateReport&>(report) = runUpdate(transaction, update, run_options);
  const rdf::FlushPoll poll(transaction, [&check] { check(0); });
  if (deleted) report.deleted += deleted->withdraw(transaction, notes);
  if (is_map && report.inserted + report.deleted > 0) {
    try {
      report.change = inferAfterUpdate(transaction, file, before, notes, check, params);
    } catch (const RefusedQuad& refused) {
      throw InputError({.file = options.query.source_name}, refused.what());
    }
    check(0);
  }
  if (is_map && !report.change.has_changes) tellMap(report.change, transaction);
  if (is_map) noteStandingQuads(transaction, before, notes);
  if (!params.dry_run) transaction.commit();
  notes.give();
  for (const Diagnostic& warning : report.warnings) sink.note(format(warning));
  return report;
}

}  // namespace cluxel::mapping
