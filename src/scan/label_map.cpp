// SPDX-License-Identifier: Apache-2.0
// Reads label maps (labels/*.yaml) and reports all their faults at once.
#include <algorithm>
#include <charconv>

#include "cluxel/base/file_bytes.hpp"
#include "cluxel/base/nearest_name.hpp"
#include "cluxel/scan/truth.hpp"
#include "scan/label_map_text.hpp"
#include "scan/yaml_tree.hpp"

namespace cluxel {

namespace {

const std::vector<std::string> kFileKeys{"dataset", "cite", "labels"};
const std::vector<std::string> kLabelKeys{"name", "primitive", "object", "part", "near"};
const std::vector<std::string> kNearKeys{"label", "within", "object"};

bool isLocalName(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c) || c == '_' || c == '-'; });
}

class LabelMapReader {
 public:
  explicit LabelMapReader(YamlFaults& faults) : faults_(&faults) {}

  std::map<std::uint32_t, LabelMeaning> read(const YamlValue& root) {
    std::map<std::uint32_t, LabelMeaning> entries;
    if (!checkMapping(root, kFileKeys, *faults_)) return entries;
    const YamlValue* labels = root.find("labels");
    if (!labels || labels->kind != YamlValue::Kind::Mapping || labels->entries.empty()) {
      faults_->add(labels ? *labels : root, "a label map needs 'labels', a mapping of ids that is not empty");
      return entries;
    }
    for (const auto& [key, value] : labels->entries) {
      const auto id = idOf(key);
      LabelMeaning meaning = readMeaning(value);
      if (id && !entries.emplace(*id, std::move(meaning)).second)
        faults_->add(key, "the id " + std::to_string(*id) + " stands twice");
    }
    checkNearIds(*labels, entries);
    return entries;
  }

 private:
  std::optional<std::uint32_t> idOf(const YamlValue& value) {
    std::uint32_t id = 0;
    const char* end = value.scalar.data() + value.scalar.size();
    const auto [stop, error] = std::from_chars(value.scalar.data(), end, id);
    if (value.kind == YamlValue::Kind::Scalar && error == std::errc() && stop == end) return id;
    faults_->add(value, "a label id is a whole number from 0 to 4294967295");
    return std::nullopt;
  }

  LabelMeaning readMeaning(const YamlValue& value) {
    LabelMeaning meaning;
    if (!checkMapping(value, kLabelKeys, *faults_)) return meaning;
    if (const YamlValue* name = value.find("name"))
      meaning.name = textOf(*name, "name", *faults_).value_or("");
    else
      faults_->add(value, "a label needs a 'name'");
    if (const YamlValue* primitive = value.find("primitive")) meaning.primitive = readPrimitive(*primitive);
    meaning.object_class = localNameAt(value, "object");
    meaning.part = localNameAt(value, "part");
    if (meaning.part && !value.find("object")) faults_->add(value, "a 'part' needs an 'object' that it is part of");
    if (const YamlValue* near = value.find("near")) meaning.near = readNear(*near);
    return meaning;
  }

  std::optional<PrimitiveLabel> readPrimitive(const YamlValue& value) {
    if (const auto label = primitiveLabelOf(value.scalar)) return label;
    const std::vector<std::string> known(kPrimitiveLabelNames.begin(), kPrimitiveLabelNames.end());
    faults_->add(value, "unknown primitive '" + value.scalar + "'", suggestion(value.scalar, known));
    return std::nullopt;
  }

  std::optional<std::string> localNameAt(const YamlValue& mapping, const char* key) {
    const YamlValue* value = mapping.find(key);
    if (!value) return std::nullopt;
    if (value->kind == YamlValue::Kind::Scalar && isLocalName(value->scalar)) return value->scalar;
    faults_->add(*value, std::string(key) + " must be a local name of the ontology, such as StreetSign");
    return std::nullopt;
  }

  std::optional<LabelMeaning::NearRule> readNear(const YamlValue& value) {
    if (!checkMapping(value, kNearKeys, *faults_)) return std::nullopt;
    for (const std::string& key : kNearKeys)
      if (!value.find(key)) faults_->add(value, "'near' needs '" + key + "'");
    const YamlValue* label = value.find("label");
    const YamlValue* within = value.find("within");
    const auto id = label ? idOf(*label) : std::nullopt;
    const auto distance_m = within ? metresOf(*within) : std::nullopt;
    const auto object_class = localNameAt(value, "object");
    if (!id || !distance_m || !object_class) return std::nullopt;
    return LabelMeaning::NearRule{*id, *distance_m, *object_class};
  }

  /// "0.6 m"
  std::optional<double> metresOf(const YamlValue& value) {
    double metres = 0;
    const std::string& text = value.scalar;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
    const std::string_view unit(stop, static_cast<std::size_t>(text.data() + text.size() - stop));
    const bool good = error == std::errc() && (unit == " m" || unit == "m") && metres > 0 && metres <= 100;
    if (good) return metres;
    faults_->add(value, "within must be a distance with its unit, above 0 and at most 100 m", "write it as '0.6 m'");
    return std::nullopt;
  }

  void checkNearIds(const YamlValue& labels, const std::map<std::uint32_t, LabelMeaning>& entries) {
    for (const auto& [key, value] : labels.entries) {
      const YamlValue* near = value.find("near");
      const YamlValue* label = near ? near->find("label") : nullptr;
      std::uint32_t id = 0;
      if (!label) continue;
      const char* end = label->scalar.data() + label->scalar.size();
      if (std::from_chars(label->scalar.data(), end, id).ptr == end && !entries.contains(id))
        faults_->add(*label, "the label " + label->scalar + " is not in this map");
    }
  }

  YamlFaults* faults_;
};

}  // namespace

std::map<std::uint32_t, LabelMeaning> parseLabelMap(std::string_view text, const std::string& file) {
  YamlFaults faults(file, text);
  const YamlValue root = parseYaml(text, file, faults);
  std::map<std::uint32_t, LabelMeaning> entries = LabelMapReader(faults).read(root);
  faults.throwIfAny();
  return entries;
}

LabelMap LabelMap::load(const std::filesystem::path& path) {
  LabelMap map;
  map.entries_ = parseLabelMap(readFile(path), path.string());
  return map;
}

const LabelMeaning* LabelMap::find(std::uint32_t id) const {
  const auto entry = entries_.find(id);
  return entry == entries_.end() ? nullptr : &entry->second;
}

}  // namespace cluxel
