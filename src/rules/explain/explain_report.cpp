// SPDX-License-Identifier: Apache-2.0
// Explanations as text and JSON.
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/text/short_number.hpp"
#include "rdf/map_iris.hpp"
#include "rules/explain/explain.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/explain/why_not.hpp"

namespace cluxel::rules {

namespace {

/// Rounded to 0.001 without trailing zeros: scanners do not resolve less than a millimetre.
std::string number(double value) {
  return shortNumber(value, 3);
}

double shown(const DecisionStep& step, double value) {
  return step.unit == "rad" ? value * 180.0 / std::numbers::pi : value;
}
std::string shownUnit(const std::string& unit) {
  return unit == "rad" ? "deg" : unit;
}

std::string measuredText(const DecisionStep& step) {
  if (!step.measured) return {};
  const std::string unit = shownUnit(step.unit);
  std::string text = " (measured " + number(shown(step, *step.measured)) + (unit.empty() ? "" : " " + unit);
  if (step.threshold)
    text += ", margin " + number(std::abs(shown(step, *step.measured) - shown(step, *step.threshold))) +
            (unit.empty() ? "" : " " + unit);
  return text + ")";
}

std::string stepText(const DecisionStep& step, const std::string& indent) {
  return indent + (step.passed ? "yes  " : "no   ") + step.test + measuredText(step) + "   [" + step.file + ":" +
         std::to_string(step.line) + "]\n";
}

std::string_view nameOf(PathNode::Kind kind) {
  static constexpr std::array<std::string_view, 6> kNames{"all", "any", "not", "test", "find", "skipped"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// Joined tests stand below the word that joins them.
std::string nodeText(const PathNode& node, const Decision& decision, const std::string& indent) {
  if (node.step) return stepText(decision.path[*node.step], indent);
  if (node.kind == PathNode::Kind::Skipped) return indent + "     a query that could not change the outcome\n";
  std::string text = indent + (node.passed ? "yes  " : "no   ") + std::string(nameOf(node.kind)) + " of:\n";
  for (const PathNode& operand : node.operands) text += nodeText(operand, decision, indent + "  ");
  return text;
}

/// The node tests whether an end is unseen, and it is not. Such a node is left out of the report.
bool isOfSeenEnds(const Rule& rule, const WalkedPath& walked) {
  const auto* branch = std::get_if<BranchNode>(&rule.nodes[walked.node].what);
  return branch != nullptr && branch->condition.kind == Condition::Kind::Unseen && !walked.tests.passed;
}

std::string pathText(const Decision& decision, const Rule* rule, const std::string& indent) {
  std::string text;
  if (rule == nullptr || decision.is_gathered)
    for (const DecisionStep& step : decision.path) text += stepText(step, indent);
  else
    for (const WalkedPath& walked : walkedPath(*rule, decision)) {
      if (isOfSeenEnds(*rule, walked)) continue;
      // The tests of an `all` are listed without a heading.
      if (walked.tests.kind == PathNode::Kind::All)
        for (const PathNode& operand : walked.tests.operands) text += nodeText(operand, decision, indent);
      else
        text += nodeText(walked.tests, decision, indent);
    }
  return text;
}

std::string signedNumber(double value) {
  return (value < 0 ? "" : "+") + number(value);
}

/// The log-odds line by line, then the rivals.
std::string evidenceText(const Decision& decision, const RuleSet& rules, const std::string& indent) {
  std::string text;
  if (decision.evidence.size() > 1 || !decision.rivals.empty()) {
    for (const EvidenceStep& step : decision.evidence) {
      std::string measured;
      if (step.measured) {
        const double scale = step.unit == "rad" ? 180.0 / std::numbers::pi : 1.0;
        const std::string unit = shownUnit(step.unit);
        measured = " (" + number(*step.measured * scale) + (unit.empty() ? "" : " " + unit) + ")";
      }
      if (step.holds) measured = *step.holds ? " (yes)" : " (no)";
      text += indent + signedNumber(step.log_odds) + "  " + step.text + measured + "   [" + step.file + ":" +
              std::to_string(step.line) + "]\n";
    }
    text +=
        indent + "log-odds " + signedNumber(decision.log_odds) + ", probability " + number(decision.probability) + "\n";
  }
  for (const RivalNote& rival : decision.rivals)
    text += indent + "rival: " + rules.shorten(rival.class_iri) + " (" + rival.rule_id + "), log-odds " +
            signedNumber(rival.log_odds) + (rival.won ? ", won" : "") + "\n";
  return text;
}

std::string counterfactualText(const Counterfactual& point, const std::string& indent) {
  std::string text = indent + "least change: ";
  for (const NeededChange& change : point.changes) {
    const std::string unit = change.unit.empty() ? "" : " " + change.unit;
    text += (&change == &point.changes.front() ? "" : ", and ") + change.test + " turns at " +
            number(change.threshold) + unit + " (now " + number(change.measured) + unit + ")";
  }
  return text + "; then the rule says: " + point.outcome + "\n";
}

std::string headline(const Explanation& explanation, const RuleSet& rules, const perception::Scene& scene) {
  const perception::Primitive& primitive = scene.primitives[explanation.primitive];
  std::string text = "primitive " + primitive.id.hex() + " (" + std::string(nameOf(primitive.label)) + ", " +
                     number(primitive[perception::Attribute::Height]) + " m high, " +
                     number(primitive[perception::Attribute::HorizontalExtent]) + " m wide, bottom " +
                     number(primitive[perception::Attribute::Bottom]) + " m above the ground)\n";
  if (!explanation.object) return text + "belongs to no object: unknown\n";
  return text + "belongs to " + rules.shorten(explanation.object->class_iri) + " " + explanation.object->id.hex() +
         ", confidence " + number(explanation.object->confidence) + ", by rule " + explanation.object->rule_id + "\n";
}

nlohmann::ordered_json stepJson(const DecisionStep& step) {
  nlohmann::ordered_json json{{"test", step.test}, {"passed", step.passed}, {"file", step.file}, {"line", step.line}};
  if (step.measured) json["measured"] = shown(step, *step.measured);
  if (step.threshold) json["threshold"] = shown(step, *step.threshold);
  if (step.measured && step.threshold)
    json["margin"] = std::abs(shown(step, *step.measured) - shown(step, *step.threshold));
  json["unit"] = shownUnit(step.unit);
  return json;
}

nlohmann::ordered_json nodeJson(const PathNode& node) {
  nlohmann::ordered_json json{{"kind", std::string(nameOf(node.kind))}, {"passed", node.passed}};
  if (node.step) json["step"] = *node.step;
  for (const PathNode& operand : node.operands) json["operands"].push_back(nodeJson(operand));
  return json;
}

/// The walked nodes; `step` counts in "path".
nlohmann::ordered_json treeJson(const Rule& rule, const Decision& decision) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const WalkedPath& walked : walkedPath(rule, decision)) {
    if (isOfSeenEnds(rule, walked)) continue;
    nlohmann::ordered_json entry = nodeJson(walked.tests);
    entry["line"] = rule.nodes[walked.node].at.line;
    json.push_back(std::move(entry));
  }
  return json;
}

nlohmann::ordered_json counterfactualJson(const Counterfactual& point) {
  nlohmann::ordered_json json{{"accepted", point.accepted}, {"outcome", point.outcome}};
  for (const NeededChange& change : point.changes)
    json["changes"].push_back({{"test", change.test},
                               {"measured", change.measured},
                               {"threshold", change.threshold},
                               {"margin", change.margin},
                               {"unit", change.unit}});
  return json;
}

void addEvidence(const Decision& decision, const RuleSet& rules, nlohmann::ordered_json& json) {
  if (decision.evidence.empty()) return;
  json["log_odds"] = decision.log_odds;
  json["probability"] = decision.probability;
  for (const EvidenceStep& step : decision.evidence) {
    nlohmann::ordered_json line{
        {"of", step.text}, {"log_odds", step.log_odds}, {"file", step.file}, {"line", step.line}};
    if (step.measured)
      line["measured"] = step.unit == "rad" ? *step.measured * 180.0 / std::numbers::pi : *step.measured;
    if (step.holds) line["holds"] = *step.holds;
    line["unit"] = shownUnit(step.unit);
    json["evidence"].push_back(std::move(line));
  }
  for (const RivalNote& rival : decision.rivals)
    json["rivals"].push_back({{"class", rules.shorten(rival.class_iri)},
                              {"rule", rival.rule_id},
                              {"log_odds", rival.log_odds},
                              {"won", rival.won}});
}

}  // namespace

std::string textOf(const Explanation& explanation, const RuleSet& rules, const perception::Scene& scene) {
  std::string text = headline(explanation, rules, scene);
  if (!explanation.note.empty()) text += explanation.note + "\n";
  for (const bool accepted : {true, false}) {
    bool first = true;
    for (const ExplainedDecision& explained : explanation.decisions) {
      const Decision& decision = explained.decision;
      if (decision.accepted != accepted) continue;
      if (first) text += accepted ? "\nwhy:\n" : "\nwhy nothing else:\n";
      first = false;
      text += "  " + rules.shorten(explained.class_iri) + " (" + decision.rule_id + "): " + decision.reason + "\n";
      text += pathText(decision, rules.find(decision.rule_id), "    ");
      text += evidenceText(decision, rules, "    ");
      if (!decision.hint.empty()) text += "    see also rule " + decision.hint + "\n";
      if (explained.counterfactual) text += counterfactualText(*explained.counterfactual, "    ");
    }
  }
  return text;
}

std::string jsonOf(const Explanation& explanation, const RuleSet& rules, const perception::Scene& scene) {
  nlohmann::ordered_json json;
  json["primitive"] = rdf::iriOfPrimitive(scene.primitives[explanation.primitive].id);
  json["label"] = std::string(nameOf(scene.primitives[explanation.primitive].label));
  if (explanation.object)
    json["object"] = {{"id", explanation.object->id.hex()},
                      {"class", rules.shorten(explanation.object->class_iri)},
                      {"confidence", explanation.object->confidence},
                      {"rule", explanation.object->rule_id}};
  if (!explanation.note.empty()) json["note"] = explanation.note;
  for (const ExplainedDecision& explained : explanation.decisions) {
    nlohmann::ordered_json decision{{"class", rules.shorten(explained.class_iri)},
                                    {"rule", explained.decision.rule_id},
                                    {"accepted", explained.decision.accepted},
                                    {"reason", explained.decision.reason}};
    for (const DecisionStep& step : explained.decision.path) decision["path"].push_back(stepJson(step));
    if (const Rule* rule = rules.find(explained.decision.rule_id))
      decision["tree"] = treeJson(*rule, explained.decision);
    addEvidence(explained.decision, rules, decision);
    if (!explained.decision.hint.empty()) decision["hint"] = explained.decision.hint;
    if (explained.counterfactual) decision["least_change"] = counterfactualJson(*explained.counterfactual);
    json["decisions"].push_back(std::move(decision));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string textOf(const WhyNot& why, const RuleSet& rules) {
  std::string text = "\nwhy not " + rules.shorten(why.class_iri) + ":\n";
  if (why.rules.empty()) text += "  no rule for objects makes this class\n";
  for (const RuleVerdict& verdict : why.rules) {
    const Decision& decision = verdict.decision;
    text += "  " + decision.rule_id + ": " + std::string(nameOf(verdict.nearness));
    if (verdict.nearness != Nearness::Accepted)
      text += ": " + decision.reason;
    else if (verdict.madeThing())
      text += " with log-odds " + signedNumber(decision.log_odds) + ": it made the thing";
    else if (verdict.winner)
      text += " with log-odds " + signedNumber(decision.log_odds) + ", but " +
              rules.shorten(verdict.winner->class_iri) + " (" + verdict.winner->rule_id + ") has " +
              signedNumber(verdict.winner->log_odds) +
              (verdict.behind >= 0 ? ": " + number(verdict.behind) + " behind" : " and came first");
    text += "\n";
    // The nearest rule is printed in full, the others by the tests that they fail.
    const bool is_seed = verdict.nearness <= Nearness::Rejected;
    if (&verdict == &why.rules.front() || verdict.nearness == Nearness::Accepted)
      text += pathText(decision, is_seed ? rules.find(decision.rule_id) : nullptr, "    ") +
              evidenceText(decision, rules, "    ");
    if (verdict.counterfactual) text += counterfactualText(*verdict.counterfactual, "    ");
  }
  return text;
}

std::string jsonOf(const WhyNot& why, const RuleSet& rules) {
  nlohmann::ordered_json json{{"class", rules.shorten(why.class_iri)}, {"rules", nlohmann::ordered_json::array()}};
  for (const RuleVerdict& verdict : why.rules) {
    nlohmann::ordered_json entry{{"rule", verdict.decision.rule_id},
                                 {"class", rules.shorten(verdict.class_iri)},
                                 {"outcome", std::string(nameOf(verdict.nearness))},
                                 {"reason", verdict.decision.reason}};
    for (const DecisionStep& step : verdict.decision.path) entry["path"].push_back(stepJson(step));
    if (verdict.nearness <= Nearness::Rejected)
      entry["tree"] = treeJson(*rules.find(verdict.decision.rule_id), verdict.decision);
    addEvidence(verdict.decision, rules, entry);
    if (verdict.counterfactual) entry["least_change"] = counterfactualJson(*verdict.counterfactual);
    if (verdict.winner)
      entry["winner"] = {{"class", rules.shorten(verdict.winner->class_iri)},
                         {"rule", verdict.winner->rule_id},
                         {"log_odds", verdict.winner->log_odds},
                         {"behind", verdict.behind}};
    json["rules"].push_back(std::move(entry));
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace cluxel::rules
