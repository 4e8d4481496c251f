// SPDX-License-Identifier: Apache-2.0
// Differences as text, JSON and coloured points.
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tasks/export/cloud_export.hpp"
#include "tasks/rule_trial/rule_difference.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::array<std::string_view, kObjectChangeKinds> kKindNames{"class", "parts", "confidence",
                                                                      "rule",  "added", "removed"};
/// In the order of ObjectChangeKind: red, orange, yellow, light blue, green, purple.
constexpr std::array<PointColour, kObjectChangeKinds> kKindColours{
    {{214, 39, 40}, {255, 127, 14}, {240, 220, 40}, {100, 180, 255}, {44, 160, 44}, {148, 60, 189}}};
constexpr PointColour kUnchanged{170, 170, 170};

std::string fixed(double value, int digits) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  return buffer.data();
}

/// "Pole -> StreetSign", or one of them where they are equal.
std::string arrow(const std::string& before, const std::string& after) {
  return before == after ? after : before + " -> " + after;
}

std::string lineOf(const ObjectChange& change) {
  const JudgedObject none{{}, "nothing", "", 0};
  const JudgedObject &a = change.before.value_or(none), &b = change.after.value_or(none);
  const JudgedObject& shown = change.before ? a : b;
  std::string text = std::string(nameOf(change.kind)) + "  object/" + shown.id.hex().substr(0, 12) + "  " +
                     arrow(a.class_name, b.class_name) + "  at " + fixed(change.place.x(), 1) + " " +
                     fixed(change.place.y(), 1) + " " + fixed(change.place.z(), 1);
  if (change.before && change.after)
    text +=
        "  confidence " + arrow(fixed(a.confidence, 3), fixed(b.confidence, 3)) + "  by " + arrow(a.rule_id, b.rule_id);
  else
    text += "  confidence " + fixed(shown.confidence, 3) + "  by " + shown.rule_id;
  return text + "\n";
}

nlohmann::ordered_json judgedJson(const std::optional<JudgedObject>& object) {
  if (!object) return nullptr;
  return {{"id", object->id.hex()},
          {"class", object->class_name},
          {"confidence", object->confidence},
          {"rule", object->rule_id}};
}

}  // namespace

std::string_view nameOf(ObjectChangeKind kind) {
  return kKindNames[static_cast<std::size_t>(kind)];
}

std::string textOf(const RuleDifference& difference) {
  std::string text;
  for (const ObjectChange& change : difference.changes) text += lineOf(change);
  for (const auto& [classes, count] : difference.class_changes)
    text += std::to_string(count) + "  " + (classes.first.empty() ? "nothing" : classes.first) + " -> " +
            (classes.second.empty() ? "nothing" : classes.second) + "\n";
  text += std::to_string(difference.before) + " objects before, " + std::to_string(difference.after) + " after";
  for (std::size_t kind = 0; kind < kObjectChangeKinds; ++kind)
    if (difference.count_of[kind] > 0)
      text += ", " + std::to_string(difference.count_of[kind]) + " " + std::string(kKindNames[kind]);
  return text + (difference.isEmpty() ? ": no difference\n" : "\n");
}

std::string jsonOf(const RuleDifference& difference) {
  nlohmann::ordered_json json{{"before", difference.before}, {"after", difference.after}};
  for (std::size_t kind = 0; kind < kObjectChangeKinds; ++kind)
    json["counts"][std::string(kKindNames[kind])] = difference.count_of[kind];
  json["classes"] = nlohmann::ordered_json::array();
  for (const auto& [classes, count] : difference.class_changes)
    json["classes"].push_back({{"before", classes.first}, {"after", classes.second}, {"count", count}});
  json["changes"] = nlohmann::ordered_json::array();
  for (const ObjectChange& change : difference.changes)
    json["changes"].push_back({{"kind", std::string(nameOf(change.kind))},
                               {"before", judgedJson(change.before)},
                               {"after", judgedJson(change.after)},
                               {"place", {change.place.x(), change.place.y(), change.place.z()}},
                               {"points", change.points}});
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

void writeDifferencePly(const mapping::MapReader& map, const RuleDifference& difference, const ByteSink& out) {
  writeColouredPly(
      map,
      [&](std::uint32_t cluxel, std::uint32_t /*object*/) {
        const auto kind = difference.kind_of_cluxel[cluxel];
        return kind ? kKindColours[static_cast<std::size_t>(*kind)] : kUnchanged;
      },
      out);
}

}  // namespace cluxel::tasks
