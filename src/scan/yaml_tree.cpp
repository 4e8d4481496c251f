// SPDX-License-Identifier: Apache-2.0
// The only user of yaml-cpp in this wing. It listens to the parser's events: yaml-cpp's own tree hides
// duplicate keys and follows aliases, which can make a small file endless.
#include "scan/yaml_tree.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

#include "cluxel/base/nearest_name.hpp"
#include "cluxel/base/shown_line.hpp"

namespace cluxel {

namespace {

class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(YamlFaults& faults) : faults_(&faults) { open_.emplace_back(); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { add(valueAt(mark, YamlValue::Kind::Null)); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { refuseAnchor(mark); }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuseAnchor(mark);
    add(valueAt(mark, YamlValue::Kind::Null));
  }

  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& text) override {
    YamlValue value = valueAt(mark, YamlValue::Kind::Scalar);
    value.scalar = text;
    add(std::move(value));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open_.push_back(valueAt(mark, YamlValue::Kind::Sequence));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open_.push_back(valueAt(mark, YamlValue::Kind::Mapping));
  }
  void OnMapEnd() override {
    pairUp(open_.back());
    close();
  }

  YamlValue root() { return open_.front().items.empty() ? YamlValue{} : std::move(open_.front().items.front()); }

 private:
  static YamlValue valueAt(const YAML::Mark& mark, YamlValue::Kind kind) {
    YamlValue value;
    value.kind = kind;
    value.line = static_cast<std::size_t>(std::max(mark.line, 0)) + 1;
    value.column = static_cast<std::size_t>(std::max(mark.column, 0)) + 1;
    return value;
  }

  void refuseAnchor(const YAML::Mark& mark) {
    faults_->add(valueAt(mark, YamlValue::Kind::Null), "anchors and aliases are not supported", "write the value out");
  }

  void add(YamlValue value) { open_.back().items.push_back(std::move(value)); }

  void close() {
    YamlValue done = std::move(open_.back());
    open_.pop_back();
    add(std::move(done));
  }

  /// Keys and values arrive in turn.
  void pairUp(YamlValue& mapping) {
    std::vector<YamlValue> parts = std::move(mapping.items);
    mapping.items.clear();
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2) {
      if (parts[i].kind != YamlValue::Kind::Scalar) faults_->add(parts[i], "a key must be a single word");
      mapping.entries.push_back({std::move(parts[i]), std::move(parts[i + 1])});
    }
    faultDuplicates(mapping);
  }

  void faultDuplicates(const YamlValue& mapping) {
    std::vector<const YamlValue*> keys;
    for (const auto& [key, value] : mapping.entries) keys.push_back(&key);
    std::stable_sort(keys.begin(), keys.end(), [](auto* a, auto* b) { return a->scalar < b->scalar; });
    for (std::size_t i = 1; i < keys.size(); ++i)
      if (keys[i]->scalar == keys[i - 1]->scalar && keys[i]->kind == YamlValue::Kind::Scalar)
        faults_->add(*keys[i],
                     "'" + keys[i]->scalar + "' was given in line " + std::to_string(keys[i - 1]->line) + " already");
  }

  YamlFaults* faults_;
  std::vector<YamlValue> open_;  ///< the values being built, outermost first
};

void appendNumbers(const YamlValue& value, const char* what, YamlFaults& faults, std::vector<double>& numbers,
                   bool& whole) {
  for (const YamlValue& item : value.items) {
    if (item.kind == YamlValue::Kind::Sequence) {
      appendNumbers(item, what, faults, numbers, whole);
    } else if (const auto number = numberOf(item, what, faults)) {
      numbers.push_back(*number);
    } else {
      whole = false;
    }
  }
}

}  // namespace

const YamlValue* YamlValue::find(std::string_view key) const {
  for (const auto& [name, value] : entries)
    if (name.scalar == key) return &value;
  return nullptr;
}

void YamlFaults::add(const YamlValue& place, std::string message, std::string hint) {
  if (diagnostics_.size() >= kMostFaults) {
    ++further_;
    return;
  }
  Diagnostic diagnostic;
  diagnostic.location = {.file = file_, .line = place.line, .column = place.column};
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  diagnostic.source_line = shownLine(text_, place.line);
  diagnostics_.push_back(std::move(diagnostic));
}

void YamlFaults::throwIfAny() const {
  if (diagnostics_.empty()) return;
  std::vector<Diagnostic> in_order = diagnostics_;
  std::stable_sort(in_order.begin(), in_order.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return std::pair(a.location.line, a.location.column) < std::pair(b.location.line, b.location.column);
  });
  if (further_ > 0) in_order.push_back(furtherFaults(Severity::Error, file_, further_));
  throw InputError(std::move(in_order));
}

YamlValue parseYaml(std::string_view text, const std::string& file, YamlFaults& faults) {
  TreeBuilder builder(faults);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
  } catch (const YAML::Exception& e) {
    YamlValue place;
    place.line = static_cast<std::size_t>(std::max(e.mark.line, 0)) + 1;
    place.column = static_cast<std::size_t>(std::max(e.mark.column, 0)) + 1;
    YamlFaults fault(file, text);
    fault.add(place, "this is no YAML: " + e.msg);
    fault.throwIfAny();
  }
  return builder.root();
}

bool checkMapping(const YamlValue& value, const std::vector<std::string>& known, YamlFaults& faults) {
  if (value.kind != YamlValue::Kind::Mapping) {
    faults.add(value, "a mapping (key: value) was expected", suggestion("", known));
    return false;
  }
  for (const auto& [key, ignored] : value.entries)
    if (key.kind == YamlValue::Kind::Scalar && std::find(known.begin(), known.end(), key.scalar) == known.end())
      faults.add(key, "unknown key '" + key.scalar + "'", suggestion(key.scalar, known));
  return true;
}

std::optional<double> numberOf(const YamlValue& value, const char* what, YamlFaults& faults) {
  double number = 0;
  const char* begin = value.scalar.data();
  const char* end = begin + value.scalar.size();
  const auto [stop, error] = std::from_chars(begin != end && *begin == '+' ? begin + 1 : begin, end, number);
  const bool good =
      value.kind == YamlValue::Kind::Scalar && error == std::errc() && stop == end && std::isfinite(number);
  if (good) return number;
  faults.add(value, std::string(what) + " must be a finite number");
  return std::nullopt;
}

std::optional<std::vector<double>> numbersOf(const YamlValue& value, std::size_t count, const char* what,
                                             YamlFaults& faults) {
  std::vector<double> numbers;
  bool whole = true;
  if (value.kind == YamlValue::Kind::Sequence) appendNumbers(value, what, faults, numbers, whole);
  if (!whole) return std::nullopt;
  if (numbers.size() == count) return numbers;
  faults.add(value, std::string(what) + " must be a list of " + std::to_string(count) + " numbers");
  return std::nullopt;
}

std::optional<std::string> textOf(const YamlValue& value, const char* what, YamlFaults& faults) {
  if (value.kind == YamlValue::Kind::Scalar && !value.scalar.empty()) return value.scalar;
  faults.add(value, std::string(what) + " must be a text");
  return std::nullopt;
}

}  // namespace cluxel
