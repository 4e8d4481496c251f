// SPDX-License-Identifier: Apache-2.0
// Objects are counted by class, and listed in JSON.
#include "app/commands/change_report.hpp"

#include <algorithm>
#include <map>

#include "app/commands/statement_list.hpp"
#include "app/option_checks.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel::app {

namespace {

using mapping::ChangeReport;
using mapping::DerivedObject;
using mapping::ObjectMembers;

std::map<ContentHash, std::string> classesOf(const std::vector<ObjectMembers>& objects, const rdf::ClassNames& names) {
  std::map<ContentHash, std::string> classes;
  for (const ObjectMembers& object : objects) classes.emplace(object.id, names.nameOf(object.class_iri));
  return classes;
}

/// ": 3 Tree, 1 Bush".
template <typename Objects, typename Id>
std::string byClass(const Objects& objects, const std::map<ContentHash, std::string>& classes, const Id& id) {
  std::map<std::string, std::size_t> counts;
  for (const auto& object : objects) ++counts[classes.at(id(object))];
  std::string text;
  for (const auto& [name, count] : counts) text += (text.empty() ? ": " : ", ") + std::to_string(count) + " " + name;
  return text;
}

Json objectsJson(const std::vector<ContentHash>& objects, const std::map<ContentHash, std::string>& classes) {
  Json json = Json::array();
  for (const ContentHash& id : objects) json.push_back({{"object", id.hex()}, {"class", classes.at(id)}});
  return json;
}

Json objectsJson(const std::vector<DerivedObject>& objects, const std::map<ContentHash, std::string>& after,
                 const std::map<ContentHash, std::string>& before) {
  Json json = Json::array();
  for (const DerivedObject& object : objects) {
    Json from = Json::array();
    for (const ContentHash& id : object.from) from.push_back({{"object", id.hex()}, {"class", before.at(id)}});
    json.push_back({{"object", object.id.hex()}, {"class", after.at(object.id)}, {"from", from}});
  }
  return json;
}

Json redecidedJson(const std::vector<mapping::RedecidedObject>& objects, const rdf::ClassNames& names) {
  const auto decisionOf = [](const ObjectMembers& object) {
    return Json{{"rule", object.rule_id}, {"confidence", object.confidence}};
  };
  Json json = Json::array();
  for (const auto& [before, after] : objects)
    json.push_back({{"object", after.id.hex()},
                    {"class", names.nameOf(after.class_iri)},
                    {"other_parts", before.parts != after.parts},
                    {"before", decisionOf(before)},
                    {"after", decisionOf(after)}});
  return json;
}

Json statementsJson(const std::vector<mapping::StatementOutcome>& outcomes) {
  Json json = Json::array();
  for (const mapping::StatementOutcome& outcome : outcomes) json.push_back(jsonOf(outcome));
  return json;
}

Json wholeRulesJson(const std::vector<mapping::WholeRule>& rules) {
  Json json = Json::array();
  for (const auto& [rule, reason] : rules) json.push_back({{"rule", rule}, {"reason", reason}});
  return json;
}

}  // namespace

Json changeJson(const fs::path& map, const ChangeReport& report, bool dry_run) {
  const auto before = classesOf(report.before, report.class_names), after = classesOf(report.after, report.class_names);
  return Json{{"map", map.string()},
              {"dry_run", dry_run},
              {"has_changes", report.has_changes},
              {"scans_added", report.scans_added},
              {"scans_already_there", report.scans_already_there},
              {"scans_removed", report.scans_removed},
              {"scans_moved", report.scans_moved},
              {"tiles_touched", report.tiles_touched},
              {"tiles_changed", report.tiles_changed},
              {"tiles_decided", report.tiles_decided},
              {"local_commits", report.local_commits},
              {"maps_taken_over", report.maps_taken_over},
              {"scans", report.scans},
              {"tiles", report.tiles},
              {"statements", statementsJson(report.statements)},
              {"rules_evaluated_whole", wholeRulesJson(report.rules_evaluated_whole)},
              {"objects",
               {{"unchanged", report.objects.unchanged},
                {"added", objectsJson(report.objects.added, after)},
                {"gone", objectsJson(report.objects.gone, before)},
                {"redecided", redecidedJson(report.objects.redecided, report.class_names)},
                {"changed", objectsJson(report.objects.changed, after, before)},
                {"split", objectsJson(report.objects.split, after, before)},
                {"joined", objectsJson(report.objects.joined, after, before)}}}};
}

namespace {

/// ": 3 Tree, 1 Bush (other parts: 3, another rule: 1, another confidence: 2)".
std::string redecidedByClass(const std::vector<mapping::RedecidedObject>& objects, const rdf::ClassNames& names) {
  if (objects.empty()) return "";
  std::map<ContentHash, std::string> classes;
  std::vector<ContentHash> ids;
  std::size_t parts = 0, rules = 0, confidences = 0;
  for (const auto& [before, after] : objects) {
    classes.emplace(after.id, names.nameOf(after.class_iri));
    ids.push_back(after.id);
    parts += before.parts != after.parts ? 1 : 0;
    rules += before.rule_id != after.rule_id ? 1 : 0;
    confidences += before.hasOtherConfidence(after) ? 1 : 0;
  }
  return byClass(ids, classes, [](const ContentHash& id) { return id; }) + " (other parts: " + std::to_string(parts) +
         ", another rule: " + std::to_string(rules) + ", another confidence: " + std::to_string(confidences) + ")";
}

/// "Tree 0123…".
std::string namedObject(const ContentHash& id, const std::map<ContentHash, std::string>& classes) {
  return classes.at(id) + " " + id.hex();
}

/// Some objects of a list, one a line.
void listSome(const std::vector<ContentHash>& objects, std::size_t listed,
              const std::map<ContentHash, std::string>& classes) {
  for (std::size_t i = 0; i < std::min(listed, objects.size()); ++i)
    std::printf("    %s\n", namedObject(objects[i], classes).c_str());
}
void listSome(const std::vector<DerivedObject>& objects, std::size_t listed,
              const std::map<ContentHash, std::string>& after, const std::map<ContentHash, std::string>& before) {
  for (std::size_t i = 0; i < std::min(listed, objects.size()); ++i) {
    std::string from;
    for (const ContentHash& id : objects[i].from) from += (from.empty() ? "" : ", ") + namedObject(id, before);
    std::printf("    %s, was %s\n", namedObject(objects[i].id, after).c_str(), from.c_str());
  }
}

}  // namespace

void addListed(CLI::App& command, std::size_t& listed) {
  command
      .add_option("--list", listed, "name up to this many of the objects that came, went, changed, split and joined")
      ->check(wholeWithin({.min = 0, .max = 1'000'000'000}));
}

void addDryRun(CLI::App& command, bool& is_dry_run) {
  command.add_flag("--dry-run", is_dry_run, "tell what would change, and write nothing");
}

void addChangeOptions(CLI::App& command, mapping::ChangeParams& params, bool in_batches) {
  addDryRun(command, params.dry_run);
  if (in_batches)
    command.add_option("--batch-points", params.batch_points, "commit when a batch of scans has this many points")
        ->check(wholeAbove0());
}

void printChange(const fs::path& map, const ChangeReport& report, const mapping::ChangeParams& params,
                 const Session& session, std::size_t listed) {
  if (session.json) return printJson(changeJson(map, report, params.dry_run));
  if (!report.has_changes) {
    std::printf("%s: nothing changes%s\n", map.c_str(), report.scans_already_there > 0 ? "; all scans are there" : "");
    return;
  }
  const auto before = classesOf(report.before, report.class_names), after = classesOf(report.after, report.class_names);
  const mapping::ObjectChanges& objects = report.objects;
  const auto own = [](const ContentHash& id) { return id; };
  const auto derived = [](const DerivedObject& object) { return object.id; };
  std::printf(
      "%s%s: %zu scans added, %zu removed, %zu moved; %zu tiles computed anew, %zu decided anew; the map has %zu "
      "tiles\n",
      map.c_str(), params.dry_run ? " (dry run, nothing written)" : "", report.scans_added, report.scans_removed,
      report.scans_moved, report.tiles_changed, report.tiles_decided, report.tiles);
  std::printf("objects: %zu unchanged\n", objects.unchanged);
  std::printf("  %zu redecided%s\n", objects.redecided.size(),
              redecidedByClass(objects.redecided, report.class_names).c_str());
  std::printf("  %zu added%s\n", objects.added.size(), byClass(objects.added, after, own).c_str());
  listSome(objects.added, listed, after);
  std::printf("  %zu gone%s\n", objects.gone.size(), byClass(objects.gone, before, own).c_str());
  listSome(objects.gone, listed, before);
  std::printf("  %zu changed%s\n", objects.changed.size(), byClass(objects.changed, after, derived).c_str());
  listSome(objects.changed, listed, after, before);
  std::printf("  %zu from splits%s\n", objects.split.size(), byClass(objects.split, after, derived).c_str());
  listSome(objects.split, listed, after, before);
  std::printf("  %zu joined%s\n", objects.joined.size(), byClass(objects.joined, after, derived).c_str());
  listSome(objects.joined, listed, after, before);
}

}  // namespace cluxel::app
