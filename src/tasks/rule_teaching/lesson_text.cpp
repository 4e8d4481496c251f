// SPDX-License-Identifier: Apache-2.0
// Writes YAML in flow style. A rule that must leave the case alone gets its own seed again, with one more condition.
#include "tasks/rule_teaching/lesson_text.hpp"

#include <algorithm>
#include <numbers>
#include <set>

#include "base/yaml/fault_list.hpp"
#include "base/yaml/yaml_tree.hpp"
#include "cluxel/error.hpp"
#include "tasks/named_class.hpp"
#include "tasks/rule_fitting/round_number.hpp"

namespace cluxel::tasks {

namespace {

/// A scalar that YAML reads as it stands between brackets, or the same in quotes.
std::string scalarText(const std::string& text) {
  const bool is_plain = !text.empty() &&
                        (std::isalnum(static_cast<unsigned char>(text.front())) != 0 || text.front() == '$') &&
                        text.find(": ") == std::string::npos && text.find(" #") == std::string::npos &&
                        text.back() != ':' && std::all_of(text.begin(), text.end(), [](char c) {
                          return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                                 std::string_view("_.:/$<>= +-%").find(c) != std::string_view::npos;
                        });
  if (is_plain) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

/// A class as rule files and rule tests take it: with its prefix, else as an IRI between < and >.
std::string classText(const rules::RuleSet& rules, const std::string& class_iri) {
  const std::string shortened = rules.shorten(class_iri);
  return scalarText(shortened == class_iri ? "<" + class_iri + ">" : shortened);
}

std::string flowText(const YamlNode& node) {
  if (node.isNull()) return "null";
  if (node.isScalar()) return scalarText(node.text);
  std::string text;
  for (std::size_t i = 0; i < node.items.size(); ++i)
    text +=
        (i == 0 ? " " : ", ") + (node.isMap() ? scalarText(node.keys[i].text) + ": " : "") + flowText(node.items[i]);
  return (node.isMap() ? "{" : "[") + text + (node.isMap() ? " }" : " ]");
}

/// What a rule file says of a rule.
YamlNode nodeOf(const rules::RuleSet& rules, const std::string& id) {
  const rules::Rule* rule = rules.find(id);
  for (const rules::RuleSource& source : rules.sources) {
    if (rule == nullptr || source.name != rule->at.file) continue;
    FaultList faults(source.name, source.text);
    const auto root = parseYaml(source.name, source.text, faults);
    const YamlNode* list = root ? root->find("rules") : nullptr;
    if (list == nullptr) break;
    for (const YamlNode& item : list->items)
      if (const YamlNode* name = item.find("id"); name != nullptr && name->text == id && item.find("seed") != nullptr)
        return item;
  }
  throw Error(ErrorKind::InvalidArgument,
              "rule " + id + " takes the object, and its seed stands in no rule file of the map: change it by hand");
}

std::string conditionList(const std::vector<AttributeCut>& cuts) {
  std::string text;
  for (const AttributeCut& cut : cuts) text += (text.empty() ? "" : ", ") + conditionText(cut);
  return "[ " + text + " ]";
}

/// The seed of a rule with the condition that it is not the case.
std::string guardedSeed(const YamlNode& rule, const std::vector<AttributeCut>& cuts) {
  const std::string guard = "{ not: { all: " + conditionList(cuts) + " } }";
  const YamlNode& seed = *rule.find("seed");
  std::string text;
  bool has_where = false;
  for (std::size_t i = 0; i < seed.items.size(); ++i) {
    std::string value = flowText(seed.items[i]);
    if (seed.keys[i].text == "where") {
      has_where = true;
      if (seed.items[i].isSequence()) value.resize(value.size() - 2);  // without " ]"
      value = (seed.items[i].isSequence() ? value : "[ " + value) + ", " + guard + " ]";
    }
    text += (i == 0 ? "" : ", ") + seed.keys[i].text + ": " + value;
  }
  if (!has_where) text += ", where: [ " + guard + " ]";
  return "{ " + text + " }";
}

std::string labelsOf(const perception::Scene& scene, const LessonCase& lesson) {
  std::set<std::string> labels;
  for (const perception::PrimitiveIndex seed : lesson.seeds) labels.emplace(nameOf(scene.primitives[seed].label));
  std::string text;
  for (const std::string& label : labels) text += (text.empty() ? "" : ", ") + label;
  return "[" + text + "]";
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.7g", value);
  return text;
}

std::string vectorText(const Eigen::Vector3d& v) {
  return "[" + numberText(v.x()) + ", " + numberText(v.y()) + ", " + numberText(v.z()) + "]";
}

std::string attributesText(const perception::Primitive& primitive) {
  std::string text;
  for (const perception::AttributeInfo& info : perception::attributeInfos()) {
    const double value = primitive[info.attribute];
    if (!std::isfinite(value)) continue;
    const bool angle = info.dimension == perception::Dimension::Angle;
    const std::string unit(rules::unitOf(info.dimension));
    text += (text.empty() ? "" : ", ") + std::string(info.name) + ": " +
            numberText(angle ? value * 180 / std::numbers::pi : value) + (unit.empty() ? "" : " " + unit);
  }
  return text;
}

}  // namespace

std::string includingText(const mapping::MapReader& map, const std::string& body) {
  const mapping::MapInputs inputs = map.inputs();
  std::string files;
  const std::filesystem::path folder =
      inputs.rules.empty() ? "" : std::filesystem::path(inputs.rules.front().name).parent_path();
  for (std::size_t i = 0; i < inputs.rule_roots && i < inputs.rules.size(); ++i) {
    files += (files.empty() ? "" : ", ") + scalarText(mapping::nameWithin(folder, inputs.rules[i].name).string());
  }
  return "apiVersion: cluxel.rules/v1\ninclude: [ " + files + " ]\n" + body;
}

std::string ruleText(const mapping::MapReader& map, const rules::RuleSet& rules, LessonCase& lesson) {
  const perception::Scene& scene = map.scene();
  const rules::SemanticObject& object = map.byRules(map.objects()[lesson.object]);
  const std::string class_name = classText(rules, lesson.class_iri);
  lesson.rule_id = "taught/" + lowerCase(distinctName(lesson.class_iri)) + "-" +
                   scene.primitives[lesson.seeds.front()].id.hex().substr(0, 8);
  std::string body;
  if (std::find(rules.order.begin(), rules.order.end(), lesson.class_iri) == rules.order.end())
    body += "order: { insert: [ " + class_name + " ], before: " + classText(rules, object.class_iri) + " }\n";
  body += "rules:\n  - id: " + lesson.rule_id + "\n    class: " + class_name +
          "\n    description: Taught by one case that was taken for " + rules.shorten(object.class_iri) + ".\n" +
          "    seed: { label_in: " + labelsOf(scene, lesson) + ", as: thing" +
          (lesson.cuts.empty() ? "" : ", where: " + conditionList(lesson.cuts)) + " }\n";
  if (lesson.seeds.size() > 1)
    if (const YamlNode rule = nodeOf(rules, object.rule_id); rule.find("group") != nullptr)
      body += "    group: " + flowText(*rule.find("group")) + "\n";
  body += "    tree: { accept: { confidence: 0.999 } }\n";
  if (!lesson.guarded.empty()) body += "override:\n  rules:\n";
  for (const std::string& id : lesson.guarded)
    body += "    - id: " + id + "\n      seed: " + guardedSeed(nodeOf(rules, id), lesson.cuts) + "\n";
  return includingText(map, body);
}

std::string testText(const mapping::MapReader& map, const rules::RuleSet& rules, const LessonCase& lesson) {
  const perception::Scene& scene = map.scene();
  const Eigen::Vector3d at(scene.primitives[lesson.seeds.front()].box.center.x(),
                           scene.primitives[lesson.seeds.front()].box.center.y(),
                           scene.primitives[lesson.seeds.front()].ground_z);
  const std::string id = map.objects()[lesson.object].id.hex().substr(0, 8);
  std::string text = "apiVersion: cluxel.rules.test/v1\nrules: [ " + scalarText(lesson.rule_file) +
                     " ]\ndefaults: { ground: { z: 0 m } }\ntests:\n  - name: the case that was taught, object " + id +
                     "\n    primitives:\n";
  std::string names;
  for (std::size_t i = 0; i < lesson.seeds.size(); ++i) {
    const perception::Primitive& primitive = scene.primitives[lesson.seeds[i]];
    const std::string name = "p" + std::to_string(i + 1);
    names += (names.empty() ? "" : ", ") + name;
    text += "      " + name + ": { label: " + std::string(nameOf(primitive.label)) +
            ", box: { center: " + vectorText(primitive.box.center - at) +
            ", size: " + vectorText(primitive.box.size.cwiseMax(0.001)) +
            ", yaw: " + numberText(primitive.box.yaw_rad * 180 / std::numbers::pi) +
            " deg },\n            attributes: { " + attributesText(primitive) + " } }\n";
  }
  return text + "    expect: { objects: [ { class: " + classText(rules, lesson.class_iri) + ", primitives: [" + names +
         "], rule: " + lesson.rule_id + " } ] }\n";
}

}  // namespace cluxel::tasks
