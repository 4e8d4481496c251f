// SPDX-License-Identifier: Apache-2.0
// The only file that sees yaml-cpp: builds the tree from its events, because its own nodes drop repeated keys.
#include "reasoning/yaml_document.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>

#include "cluxel/base/shown_line.hpp"

namespace cluxel {

namespace {

constexpr std::size_t kMaxDepth = 80;
constexpr std::size_t kMaxBytes = 4U << 20U;

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string file, FaultList& faults) : file_(std::move(file)), faults_(faults) {}

  YamlNode takeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuseAnchor(mark, anchor);
    add(nodeAt(mark, YamlNode::Kind::Null));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    faults_.error(place(mark), "YAML aliases are not part of the rule language", "use a constant: $name");
    add(nodeAt(mark, YamlNode::Kind::Null));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuseAnchor(mark, anchor);
    YamlNode node = nodeAt(mark, YamlNode::Kind::Scalar);
    node.text = value;
    node.quoted = tag == "!";
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    refuseAnchor(mark, anchor);
    open(nodeAt(mark, YamlNode::Kind::Sequence));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    refuseAnchor(mark, anchor);
    open(nodeAt(mark, YamlNode::Kind::Map));
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    bool key_waits = false;  ///< the last key has no value yet
    bool key_repeated = false;
  };

  SourceLocation place(const YAML::Mark& mark) const {
    SourceLocation location;
    location.file = file_;
    location.line = static_cast<std::size_t>(std::max(mark.line, 0)) + 1;
    location.column = static_cast<std::size_t>(std::max(mark.column, 0)) + 1;
    return location;
  }
  YamlNode nodeAt(const YAML::Mark& mark, YamlNode::Kind kind) const {
    YamlNode node;
    node.kind = kind;
    node.at = place(mark);
    return node;
  }
  void refuseAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor != 0)
      faults_.error(place(mark), "YAML anchors are not part of the rule language", "use a constant: $name");
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
    const YamlNode* earlier = key.isScalar() ? parent.node.keyNode(key.text) : nullptr;
    if (earlier != nullptr)
      faults_.error(key.at, "the key '" + key.text + "' stands here twice",
                    "it was given first in line " + std::to_string(earlier->at.line));
    parent.key_repeated = earlier != nullptr || !key.isScalar();
    parent.key_waits = true;
    if (!parent.key_repeated) parent.node.keys.push_back(std::move(key));
  }
  void addValue(Open& parent, YamlNode value) {
    if (!parent.key_repeated) parent.node.items.push_back(std::move(value));
    parent.key_waits = false;
  }

  std::string file_;
  FaultList& faults_;
  std::vector<Open> stack_;
  YamlNode root_;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size() && i < items.size(); ++i)
    if (keys[i].text == key) return &items[i];
  return nullptr;
}

const YamlNode* YamlNode::keyNode(std::string_view key) const {
  for (const YamlNode& node : keys)
    if (node.text == key) return &node;
  return nullptr;
}

std::string_view describeKind(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::Map:
      return "a mapping";
    case YamlNode::Kind::Sequence:
      return "a list";
    case YamlNode::Kind::Scalar:
      return "a single value";
    case YamlNode::Kind::Null:
      break;
  }
  return "nothing";
}

void FaultList::addFile(std::string file, std::string text) {
  files_.emplace_back(std::move(file), std::move(text));
}

void FaultList::error(const SourceLocation& at, std::string message, std::string hint) {
  if (++errors_ <= kMostFaults) add(Severity::Error, at, std::move(message), std::move(hint));
}

void FaultList::warning(const SourceLocation& at, std::string message, std::string hint) {
  if (++warnings_ <= kMostFaults) add(Severity::Warning, at, std::move(message), std::move(hint));
}

void FaultList::add(Severity severity, const SourceLocation& at, std::string message, std::string hint) {
  Diagnostic fault;
  fault.severity = severity;
  fault.location = at;
  fault.message = std::move(message);
  fault.hint = std::move(hint);
  for (const auto& [file, text] : files_)
    if (file == at.file) fault.source_line = shownLine(text, at.line);
  faults_.push_back(std::move(fault));
}

std::vector<Diagnostic> FaultList::sorted() const {
  auto fileNumber = [this](const Diagnostic& fault) {
    const auto found =
        std::find_if(files_.begin(), files_.end(), [&](const auto& file) { return file.first == fault.location.file; });
    return found - files_.begin();
  };
  auto place = [&](const Diagnostic& fault) {
    return std::tuple(fileNumber(fault), fault.location.line, fault.location.column);
  };
  std::vector<Diagnostic> faults = faults_;
  std::stable_sort(faults.begin(), faults.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
  const auto last = std::unique(faults.begin(), faults.end(), [&](const Diagnostic& a, const Diagnostic& b) {
    return place(a) == place(b) && a.message == b.message;
  });
  faults.erase(last, faults.end());
  const std::string file = files_.empty() ? "" : files_.front().first;
  if (errors_ > kMostFaults) faults.push_back(furtherFaults(Severity::Error, file, errors_ - kMostFaults));
  if (warnings_ > kMostFaults) faults.push_back(furtherFaults(Severity::Warning, file, warnings_ - kMostFaults));
  return faults;
}

YamlNode parseYaml(const std::string& file, const std::string& text, FaultList& faults) {
  SourceLocation start;
  start.file = file;
  if (text.size() > kMaxBytes) {
    faults.error(start, "longer than 4 MiB, which no rule file is");
    return {};
  }
  TreeBuilder builder(file, faults);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) faults.error(start, "the file is empty");
    TreeBuilder ignored(file, faults);
    if (parser.HandleNextDocument(ignored)) faults.error(start, "more than one YAML document in a file");
  } catch (const YAML::Exception& fault) {
    start.line = static_cast<std::size_t>(std::max(fault.mark.line, 0)) + 1;
    start.column = static_cast<std::size_t>(std::max(fault.mark.column, 0)) + 1;
    faults.error(start, "not YAML: " + fault.msg);
    return {};
  } catch (const InputError& fault) {
    for (const Diagnostic& diagnostic : fault.diagnostics()) faults.error(diagnostic.location, diagnostic.message);
    return {};
  }
  return builder.takeRoot();
}

}  // namespace cluxel
