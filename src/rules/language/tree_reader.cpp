// SPDX-License-Identifier: Apache-2.0
// Reads decision trees: branches, finds and leaves.
#include <algorithm>
#include <array>

#include "base/nearest_name.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

struct ChoiceName {
  std::string_view name;
  Choice choice;
};
constexpr std::array<ChoiceName, 7> kChoices{{{"largest_volume", Choice::LargestVolume},
                                              {"most_points", Choice::MostPoints},
                                              {"nearest", Choice::Nearest},
                                              {"highest", Choice::Highest},
                                              {"lowest", Choice::Lowest},
                                              {"most_adjacent", Choice::MostAdjacent},
                                              {"all", Choice::All}}};

constexpr const char* kBesideReject = "'leave' and 'hint' stand beside 'reject': { reject: reason, leave: unknown }";

class TreeReader {
 public:
  TreeReader(Rule& rule, RuleReading& reading) : rule_(rule), reading_(reading), faults_(reading.faults) {}

  NodeIndex read(const YamlNode& node, const NameScope& scope) {
    const NodeIndex index = rule_.nodes.size();
    rule_.nodes.push_back({node.at, RejectLeaf{}});
    if (checkKeys(node, "node", faults_)) readKind(node, scope, index);
    return index;
  }

 private:
  void readKind(const YamlNode& node, const NameScope& scope, NodeIndex index) {
    static constexpr std::array<std::string_view, 8> kinds{"test", "all",  "any",    "not",
                                                           "ask",  "find", "accept", "reject"};
    std::vector<std::string> given;
    for (const YamlNode& key : node.keys)
      if (std::find(kinds.begin(), kinds.end(), key.text) != kinds.end()) given.push_back(key.text);
    if (given.empty() && (node.find("leave") != nullptr || node.find("hint") != nullptr))
      return faults_.error(node.at, "a node that does nothing", kBesideReject);
    if (given.size() != 1) {
      const bool none = given.empty();
      const SourceLocation at = none ? node.at : node.keyNode(given[1])->at;
      return faults_.error(at,
                           none ? "a node that does nothing" : "'" + given[0] + "' and '" + given[1] + "' in one node",
                           "a node has exactly one of: test, all, any, not, ask, find, accept, reject");
    }
    const std::string& kind = given.front();
    if (kind == "find") return readFind(node, scope, index);
    if (kind == "accept") return readAcceptNode(node, scope, index);
    if (kind == "reject") return readReject(node, index);
    readBranch(node, kind, scope, index);
  }

  void onlyWith(const YamlNode& node, std::initializer_list<std::string_view> allowed) {
    static constexpr std::array<std::string_view, 7> others{"yes", "no", "unseen", "found", "missing", "hint", "leave"};
    for (const YamlNode& key : node.keys) {
      const bool other = std::find(others.begin(), others.end(), key.text) != others.end();
      if (other && std::find(allowed.begin(), allowed.end(), key.text) == allowed.end())
        faults_.error(key.at, "'" + key.text + "' has no meaning in this node",
                      key.text == "leave" || key.text == "hint" ? kBesideReject : "");
    }
  }

  NodeIndex readBelow(const YamlNode& node, std::string_view key, const NameScope& scope) {
    const YamlNode* below = requireKey(node, key, "node", faults_);
    return below == nullptr ? 0 : read(*below, scope);
  }

  void readBranch(const YamlNode& node, const std::string& kind, const NameScope& scope, NodeIndex index) {
    onlyWith(node, {"yes", "no", "unseen"});
    BranchNode branch;
    const std::size_t faults_before = faults_.errorCount();
    const YamlNode* test = requireKey(node, kind, "node", faults_);
    if (test != nullptr) {
      YamlNode bare;
      bare.kind = YamlNode::Kind::Map;
      bare.at = test->at;
      bare.keys.push_back(*node.keyNode(kind));
      bare.items.push_back(*test);
      if (auto condition = readCondition(kind == "test" ? *test : bare, scope, reading_))
        branch.condition = std::move(*condition);
    }
    if (const YamlNode* unseen = node.find("unseen")) {
      if (faults_.errorCount() == faults_before) requireAnEnd(branch.condition, node.keyNode("unseen")->at);
      index = readUnseen(node, *unseen, branch.condition, scope, index);
    }
    branch.yes = readBelow(node, "yes", scope);
    branch.no = readBelow(node, "no", scope);
    rule_.nodes[index].what = std::move(branch);
  }

  /// Makes the node ask first whether the test is unseen; returns the new node for the test itself.
  NodeIndex readUnseen(const YamlNode& node, const YamlNode& below, const Condition& test, const NameScope& scope,
                       NodeIndex index) {
    BranchNode first;
    first.condition.kind = Condition::Kind::Unseen;
    first.condition.at = test.at;
    first.condition.of = test.of;
    first.condition.operands = {test};
    first.yes = read(below, scope);
    first.no = rule_.nodes.size();
    rule_.nodes.push_back({node.at, RejectLeaf{}});
    rule_.nodes[index].what = std::move(first);
    return rule_.nodes.size() - 1;
  }

  void requireAnEnd(const Condition& test, const SourceLocation& at) {
    if (!measuresAnEnd(test))
      faults_.error(
          at, "this test measures no end of a thing, so it is never unseen",
          "tests of top, bottom, height, elevation_span, length and horizontal_extent can be, without 'slice'");
  }

  static bool measuresAnEnd(const Condition& test) {
    if (test.kind == Condition::Kind::Attribute) return !test.slice && perception::isOfAnEnd(test.attribute);
    return std::any_of(test.operands.begin(), test.operands.end(), measuresAnEnd);
  }

  void readFind(const YamlNode& node, const NameScope& scope, NodeIndex index) {
    onlyWith(node, {"found", "missing"});
    const YamlNode* spec = node.find("find");
    FindNode find;
    NameScope inside = scope;
    if (checkKeys(*spec, "find", faults_)) readFindSpec(*spec, find, inside);
    inside.subject = scope.subject;
    find.found = readBelow(node, "found", inside);
    find.missing = readBelow(node, "missing", scope);
    rule_.nodes[index].what = std::move(find);
  }

  void readFindSpec(const YamlNode& spec, FindNode& find, NameScope& inside) {
    if (const YamlNode* as = requireKey(spec, "as", "find", faults_))
      if (const auto name = readNewName(*as, inside, faults_)) find.name = *name;
    if (!find.name.empty()) inside.names.push_back(find.name);
    inside.subject = find.name;
    find.labels = readLabels(spec, reading_);
    if (const YamlNode* object = spec.find("object")) find.object_class = readClass(*object, reading_).value_or("");
    if (find.labels.empty() && find.object_class.empty() && spec.find("label") == nullptr &&
        spec.find("label_in") == nullptr && spec.find("object") == nullptr)
      faults_.error(spec.at, "'find' says nothing about what it looks for", "give label, label_in or object");
    const std::size_t faults_before = faults_.errorCount();
    for (std::string_view key : {"relations", "where"})
      if (const YamlNode* list = spec.find(key))
        for (Condition& condition : readConditions(*list, inside, reading_)) find.where.push_back(std::move(condition));
    if (faults_.errorCount() == faults_before && !tiesToNeighbours(find.where, find.name))
      faults_.error(spec.at, "'find' does not say where to look",
                    "give a relation to a bound name, or a measure with an upper bound: { gap_to: pole, op: \"<=\", "
                    "value: 0.5 m }");
    readChoice(spec, find);
    if (const YamlNode* share = spec.find("share")) find.share = readFlag(*share, faults_).value_or(false);
    if (find.share && !find.object_class.empty())
      faults_.error(spec.keyNode("share")->at, "what belongs to an object cannot be shared");
  }

  void readChoice(const YamlNode& spec, FindNode& find) {
    for (const Condition& condition : find.where)
      if (find.nearest_to.empty() && looksNearby(condition, find.name)) find.nearest_to = condition.target->name;
    const YamlNode* choose = spec.find("choose");
    if (choose == nullptr) return;
    const auto found = std::find_if(kChoices.begin(), kChoices.end(),
                                    [&](const ChoiceName& known) { return known.name == choose->text; });
    if (choose->isScalar() && found != kChoices.end()) {
      find.choose = found->choice;
      return;
    }
    std::vector<std::string> known;
    for (const ChoiceName& choice : kChoices) known.emplace_back(choice.name);
    faults_.error(choose->at, "unknown choice '" + choose->text + "'", suggestion(choose->text, known));
  }

  void readAcceptNode(const YamlNode& node, const NameScope& scope, NodeIndex index) {
    onlyWith(node, {});
    if (auto leaf = readAccept(*node.find("accept"), scope, rule_, reading_))
      rule_.nodes[index].what = std::move(*leaf);
  }

  void readReject(const YamlNode& node, NodeIndex index) {
    onlyWith(node, {"hint", "leave"});
    RejectLeaf leaf;
    leaf.reason = readText(*node.find("reject"), "a reason", faults_).value_or("");
    if (const YamlNode* hint = node.find("hint")) leaf.hint = readText(*hint, "a rule id", faults_).value_or("");
    if (const YamlNode* leave = node.find("leave")) {
      leaf.leave_unknown = leave->text == "unknown";
      if (!leaf.leave_unknown) faults_.error(leave->at, "'leave' takes only 'unknown'");
    }
    rule_.nodes[index].what = std::move(leaf);
  }

  Rule& rule_;
  RuleReading& reading_;
  FaultList& faults_;
};

}  // namespace

void readTree(const YamlNode& node, Rule& rule, RuleReading& reading) {
  const NameScope scope{{rule.seed.name}, rule.seed.name};
  TreeReader(rule, reading).read(node, scope);
}

}  // namespace cluxel::rules
