// SPDX-License-Identifier: Apache-2.0
// The only user of yaml-cpp. The tree is built from the parser's events: yaml-cpp's own nodes drop repeated keys and
// follow aliases, which can make a small file endless.
#include "base/yaml/yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <unordered_set>

#include "base/shown_line.hpp"
#include "base/utf8.hpp"

namespace cluxel {

namespace {

constexpr std::size_t kMaxDepth = 80;
/// A tree takes up to 100 times the size of its text.
constexpr std::size_t kMaxYamlBytes = std::size_t{8} << 20U;

SourceLocation placeOf(const std::string& file, const YAML::Mark& mark) {
  SourceLocation location;
  location.file = file;
  location.line = static_cast<std::size_t>(std::max(mark.line, 0)) + 1;
  location.column = static_cast<std::size_t>(std::max(mark.column, 0)) + 1;
  return location;
}

/// The line with this number, from 0.
std::string_view lineOf(std::string_view text, int number) {
  for (; number > 0 && !text.empty(); --number) {
    const std::size_t end = text.find('\n');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return text.substr(0, text.find('\n'));
}

/// Tabs and brackets are the faults that the parser names least well.
std::string hintFor(std::string_view text, const YAML::Exception& fault) {
  const std::string_view line = lineOf(text, fault.mark.line);
  if (line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string_view::npos)
    return "the line begins with a tab: indent with spaces";
  const auto opened = std::count(text.begin(), text.end(), '{') + std::count(text.begin(), text.end(), '[');
  const auto closed = std::count(text.begin(), text.end(), '}') + std::count(text.begin(), text.end(), ']');
  if (fault.msg.find("flow") == std::string::npos || opened == closed) return {};
  return opened > closed ? "a { or [ is not closed, here or before" : "a } or ] closes nothing, here or before";
}

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file, FaultList& faults) : file_(file), faults_(faults) {}

  YamlNode takeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { add(nodeAt(mark, YamlNode::Kind::Null)); }
  void OnAnchor(const YAML::Mark& mark, const std::string& /*name*/) override { refuseAnchor(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    refuseAnchor(mark);
    add(nodeAt(mark, YamlNode::Kind::Null));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& value) override {
    YamlNode node = nodeAt(mark, YamlNode::Kind::Scalar);
    node.text = value;
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    open(nodeAt(mark, YamlNode::Kind::Sequence));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    open(nodeAt(mark, YamlNode::Kind::Map));
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    std::unordered_set<std::string> keys{};  ///< the texts of node.keys: a look-up in the list is linear
    bool key_waits = false;                  ///< the last key has no value yet
    bool key_refused = false;                ///< and its value is dropped with it
  };

  YamlNode nodeAt(const YAML::Mark& mark, YamlNode::Kind kind) const {
    YamlNode node;
    node.kind = kind;
    node.at = placeOf(file_, mark);
    return node;
  }
  void refuseAnchor(const YAML::Mark& mark) {
    faults_.error(placeOf(file_, mark), "anchors and aliases are not supported", "write the value out");
  }
  void open(YamlNode node) {
    if (stack_.size() >= kMaxDepth) throw InputError(node.at, "nested too deeply");
    stack_.push_back({std::move(node)});
  }
  void close() {
    YamlNode node = std::move(stack_.back().node);
    stack_.pop_back();
    add(std::move(node));
  }
  void add(YamlNode node) {
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = stack_.back();
    if (parent.node.isSequence())
      parent.node.items.push_back(std::move(node));
    else if (parent.key_waits)
      addValue(parent, std::move(node));
    else
      addKey(parent, std::move(node));
  }
  void addKey(Open& parent, YamlNode key) {
    if (!key.isScalar()) faults_.error(key.at, "a key must be plain text");
    const bool is_repeated = key.isScalar() && !parent.keys.insert(key.text).second;
    if (is_repeated && faults_.errorCount() < kMaxFaults)
      faults_.error(key.at, "the key '" + key.text + "' stands here twice",
                    "it was given first in line " + std::to_string(parent.node.keyNode(key.text)->at.line));
    else if (is_repeated)
      faults_.error(key.at, "the key '" + key.text + "' stands here twice");
    parent.key_refused = is_repeated || !key.isScalar();
    parent.key_waits = true;
    if (!parent.key_refused) parent.node.keys.push_back(std::move(key));
  }
  void addValue(Open& parent, YamlNode value) {
    if (!parent.key_refused) parent.node.items.push_back(std::move(value));
    parent.key_waits = false;
  }

  const std::string& file_;
  FaultList& faults_;
  std::vector<Open> stack_;
  YamlNode root_;
};

}  // namespace

std::optional<YamlNode> parseYaml(const std::string& file, std::string_view text, FaultList& faults) {
  if (text.size() > kMaxYamlBytes) {
    faults.error({.file = file}, "is larger than 8 MiB, the most that a YAML file may have",
                 "split it, or list folders instead of files and name a poses file instead of single poses");
    return std::nullopt;
  }
  // What a rule file says becomes facts of the map, which only UTF-8 can be.
  if (const auto offset = firstInvalidUtf8(text)) {
    faults.error(locate(file, text, *offset), "is not UTF-8", "save the file in UTF-8");
    return std::nullopt;
  }
  TreeBuilder builder(file, faults);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    if (parser.HandleNextDocument(builder)) {
      TreeBuilder ignored(file, faults);
      if (parser.HandleNextDocument(ignored)) faults.error({.file = file}, "more than one YAML document in a file");
    }
  } catch (const YAML::Exception& fault) {
    faults.error(placeOf(file, fault.mark), "this is no YAML: " + fault.msg, hintFor(text, fault));
    return std::nullopt;
  } catch (const InputError& fault) {
    for (const Diagnostic& diagnostic : fault.diagnostics()) faults.error(diagnostic.location, diagnostic.message);
    return std::nullopt;
  }
  return builder.takeRoot();
}

}  // namespace cluxel
