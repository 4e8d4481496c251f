// SPDX-License-Identifier: Apache-2.0
// A grammar of words: [not] MEASURE [of NAME] [from A to B] OPERATOR VALUE, relations, labels and their shares. The
// result is the mapping that people could have written, so that its checks and messages are those of all conditions.
#include "rules/language/condition_text.hpp"

#include <algorithm>

#include "base/nearest_name.hpp"
#include "rules/language/condition_words.hpp"

namespace cluxel::rules {

namespace {

constexpr std::string_view kExample = "write 'height of top >= 1 m', 'gap to trunk <= 0.5 m' or 'is column'";

struct Word {
  std::string text;
  std::size_t offset = 0;
};

std::vector<Word> wordsOf(const std::string& text) {
  std::vector<Word> words;
  for (std::size_t at = text.find_first_not_of(' '); at != std::string::npos; at = text.find_first_not_of(' ', at)) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    words.push_back({text.substr(at, end - at), at});
    at = end;
  }
  return words;
}

class ConditionTextReader {
 public:
  ConditionTextReader(const YamlNode& node, FaultList& faults)
      : node_(node), faults_(faults), words_(wordsOf(node.text)) {}

  std::optional<YamlNode> readMeasure() {
    measure_only_ = true;
    return read();
  }

  std::optional<YamlNode> read() {
    YamlNode condition = mapHere();
    if (!measure_only_)
      condition = readHere();
    else if (isPair())
      readPair(condition);
    else
      readAttribute(condition);
    if (!failed_ && at_ < words_.size()) fail("the condition must end here");
    return failed_ ? std::nullopt : std::optional(std::move(condition));
  }

 private:
  YamlNode readHere() {
    YamlNode map = mapHere();
    if (isWord("not") && !isOver(1)) {
      const YamlNode key = nodeOf("not", at_);
      ++at_;
      addKey(map, key, readHere());
    } else if (isWord("is") || (!isOver(1) && words_[at_ + 1].text == "is")) {
      readLabels(map);
    } else if (isLabelShare()) {
      readLabelShare(map);
    } else if (isRelation(0) || isRelation(1)) {
      readRelation(map);
    } else if (isPair()) {
      readPair(map);
    } else {
      readAttribute(map);
    }
    return map;
  }

  bool isOver(std::size_t ahead) const { return at_ + ahead >= words_.size(); }
  bool isWord(std::string_view word) const { return !isOver(0) && words_[at_].text == word; }
  bool isPair() const { return !isOver(0) && measureOf(words_[at_].text + "_to") != nullptr; }
  /// `column or scatter share of NAME`.
  bool isLabelShare() const {
    return !isOver(1) && scan::primitiveLabelOf(words_[at_].text).has_value() &&
           (words_[at_ + 1].text == "share" || words_[at_ + 1].text == "or");
  }
  bool isRelation(std::size_t ahead) const {
    return !isOver(ahead) && perception::relationKindOf(words_[at_ + ahead].text).has_value();
  }

  void fail(const std::string& message, std::string hint = std::string(kExample)) {
    if (!failed_) faults_.error(placeOf(at_), message + ": '" + node_.text + "'", std::move(hint));
    failed_ = true;
  }

  SourceLocation placeOf(std::size_t word) const {
    SourceLocation at = node_.at;
    at.column += word < words_.size() ? words_[word].offset : node_.text.size();
    return at;
  }
  YamlNode nodeOf(std::string text, std::size_t word) const {
    YamlNode node;
    node.kind = YamlNode::Kind::Scalar;
    node.at = placeOf(word);
    node.text = std::move(text);
    return node;
  }
  YamlNode mapHere() const {
    YamlNode map;
    map.kind = YamlNode::Kind::Map;
    map.at = placeOf(at_);
    return map;
  }
  static void addKey(YamlNode& map, YamlNode key, YamlNode value) {
    map.keys.push_back(std::move(key));
    map.items.push_back(std::move(value));
  }
  void add(YamlNode& map, std::string_view key, YamlNode value) {
    YamlNode name = value;
    name.kind = YamlNode::Kind::Scalar;
    name.text = key;
    name.keys.clear();
    name.items.clear();
    addKey(map, std::move(name), std::move(value));
  }

  YamlNode take(std::string_view what) {
    if (isOver(0)) {
      fail(std::string(what) + " is missing");
      return nodeOf("", at_);
    }
    ++at_;
    return nodeOf(words_[at_ - 1].text, at_ - 1);
  }
  bool skip(std::string_view word) {
    if (!isWord(word)) return false;
    ++at_;
    return true;
  }
  void expect(std::string_view word) {
    if (!skip(word)) fail("'" + std::string(word) + "' is missing");
  }

  /// The words up to one of those that end a quantity: "2.5 m".
  YamlNode takeQuantity() {
    YamlNode quantity = take("a value");
    while (!isOver(0) && !isWord("to") && !isWord("and") && !isWord("x") &&
           comparisonOf(words_[at_].text) == std::nullopt)
      quantity.text += " " + words_[at_++].text;
    return quantity;
  }

  void readOf(YamlNode& map) {
    if (skip("of")) add(map, "of", take("a name"));
  }

  void readLabels(YamlNode& map) {
    if (!isWord("is")) add(map, "of", take("a name"));
    expect("is");
    skip("labelled");
    add(map, "label_in", takeLabels());
  }

  YamlNode takeLabels() {
    YamlNode labels = mapHere();
    labels.kind = YamlNode::Kind::Sequence;
    do labels.items.push_back(take("a label"));
    while (skip("or"));
    return labels;
  }

  void readLabelShare(YamlNode& map) {
    YamlNode labels = takeLabels();
    expect("share");
    readOf(map);
    add(map, "label_in", std::move(labels));
    readComparison(map, false);
  }

  void readRelation(YamlNode& map) {
    if (!isRelation(0)) add(map, "of", take("a name"));
    const YamlNode relation = take("a relation");
    const bool with = relation.text != "touches_ground";
    add(map, "relation", relation);
    if (with) add(map, "with", takeTarget());
    if (skip("within")) add(map, "within", takeQuantity());
  }

  /// A bound name, a label, or a class.
  YamlNode takeTarget() {
    if (!skip("a")) skip("an");
    YamlNode name = take("a name, a label or a class");
    const bool is_class = name.text.find(':') != std::string::npos || name.text.starts_with('<');
    if (!is_class && !scan::primitiveLabelOf(name.text)) return name;
    YamlNode target = mapHere();
    target.at = name.at;
    add(target, is_class ? "object" : "label", std::move(name));
    return target;
  }

  void readPair(YamlNode& map) {
    YamlNode measure = take("a measure");
    measure.text += "_to";
    readOf(map);
    expect("to");
    addKey(map, measure, takeTarget());
    readComparison(map, false);
  }

  void readAttribute(YamlNode& map) {
    const std::size_t first = at_;
    const YamlNode name = take("an attribute");
    if (!failed_ && !perception::attributeOf(name.text)) {
      at_ = first;
      return fail("no condition begins with '" + name.text + "'", hintFor(name.text));
    }
    add(map, "attribute", name);
    readOf(map);
    readSliceWords(map);
    readComparison(map, true);
  }

  static std::string hintFor(const std::string& word) {
    std::vector<std::string> known{"is", "not"};
    for (const perception::AttributeInfo& info : perception::attributeInfos()) known.emplace_back(info.name);
    for (const perception::RelationInfo& info : perception::relationInfos()) known.emplace_back(info.name);
    for (const MeasureWord& measure : kMeasureWords) known.emplace_back(measure.key.substr(0, measure.key.size() - 3));
    const auto nearest = nearestName(word, known);
    return nearest ? "did you mean '" + *nearest + "'?" : std::string(kExample);
  }

  void readSliceWords(YamlNode& map) {
    if (!isWord("from")) return;
    YamlNode slice = mapHere();
    ++at_;
    add(slice, "from", takeQuantity());
    expect("to");
    add(slice, "to", takeQuantity());
    add(map, "slice", std::move(slice));
  }

  void readComparison(YamlNode& map, bool may_be_ratio) {
    if (measure_only_) return;
    const YamlNode op = take("an operator");
    if (failed_) return;
    if (!comparisonOf(op.text)) {
      --at_;
      return fail("unknown operator '" + op.text + "'", "known: <, <=, >, >=, =, !=, between, outside");
    }
    add(map, "op", op);
    if (op.text == "between" || op.text == "outside") {
      add(map, "min", takeQuantity());
      expect("and");
      return add(map, "max", takeQuantity());
    }
    const YamlNode value = !isOver(0) && perception::attributeOf(words_[at_].text) ? nodeOf("1", at_) : takeQuantity();
    const bool is_ratio = may_be_ratio && (value.text == "1" || isWord("x")) && (skip("x") || !isOver(0));
    if (!is_ratio) return add(map, "value", value);
    add(map, "ratio", value);
    YamlNode other = mapHere();
    add(other, "attribute", take("an attribute"));
    readOf(other);
    readSliceWords(other);
    add(map, "to", std::move(other));
  }

  const YamlNode& node_;
  FaultList& faults_;
  std::vector<Word> words_;
  std::size_t at_ = 0;
  bool failed_ = false;
  bool measure_only_ = false;
};

}  // namespace

std::optional<YamlNode> conditionOfText(const YamlNode& text, FaultList& faults) {
  return ConditionTextReader(text, faults).read();
}

std::optional<YamlNode> measureOfText(const YamlNode& text, FaultList& faults) {
  return ConditionTextReader(text, faults).readMeasure();
}

}  // namespace cluxel::rules
