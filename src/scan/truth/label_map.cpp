// SPDX-License-Identifier: Apache-2.0
// Reads label maps (labels/*.yaml) and reports all their faults at once.
#include <algorithm>
#include <charconv>

#include "base/ascii.hpp"
#include "base/file_bytes.hpp"
#include "base/nearest_name.hpp"
#include "base/yaml/yaml_tree.hpp"
#include "scan/truth/truth.hpp"
#include "scan/truth/truth_parsers.hpp"

namespace cluxel::scan {

namespace {

const std::vector<std::string> kFileKeys{"dataset", "cite", "coverage", "instance_field", "counts_as", "labels"};
const std::vector<std::string> kLabelKeys{"name", "primitive", "object", "part", "near"};
const std::vector<std::string> kNearKeys{"label", "within", "object"};

/// What can stand in an IRI after its last '#' or '/'. A colon would be that of a prefix.
bool isLocalName(std::string_view name) {
  return !name.empty() && std::none_of(name.begin(), name.end(), [](char c) {
    return static_cast<unsigned char>(c) <= 0x20 || c == 0x7F ||
           std::string_view(":#/<>\"{}|^`\\").find(c) != std::string_view::npos;
  });
}

class LabelMapReader {
 public:
  explicit LabelMapReader(FaultList& faults) : faults_(&faults) {}

  LabelMapContent read(const YamlNode& root) {
    LabelMapContent content;
    if (!checkMapping(root, kFileKeys, *faults_)) return content;
    const YamlNode* labels = root.find("labels");
    if (!labels || !labels->isMap() || labels->items.empty()) {
      faults_->error((labels ? *labels : root).at, "a label map needs 'labels', a mapping of ids that is not empty");
      return content;
    }
    readLabels(*labels, content.labels);
    if (const YamlNode* field = root.find("instance_field"))
      content.instance_field = textOf(*field, "instance_field", *faults_).value_or("");
    if (const YamlNode* coverage = root.find("coverage")) content.covers_all = coversAll(*coverage);
    if (const YamlNode* counts_as = root.find("counts_as")) readCountsAs(*counts_as, content);
    return content;
  }

 private:
  void readLabels(const YamlNode& labels, std::map<std::uint32_t, LabelMeaning>& entries) {
    for (std::size_t i = 0; i < labels.items.size(); ++i) {
      const YamlNode& key = labels.keys[i];
      const auto id = idOf(key);
      LabelMeaning meaning = readMeaning(labels.items[i]);
      if (id && !entries.emplace(*id, std::move(meaning)).second)
        faults_->error(key.at, "the id " + std::to_string(*id) + " stands twice");
    }
    checkNearIds(labels, entries);
  }

  bool coversAll(const YamlNode& value) {
    if (!value.isScalar() || (value.text != "all" && value.text != "some"))
      faults_->error(value.at, "coverage must be 'all' or 'some'",
                     "some: only some objects of a scan are labelled, and nothing is known of the other points");
    return value.text != "some";
  }

  void readCountsAs(const YamlNode& value, LabelMapContent& content) {
    if (!value.isMap()) {
      faults_->error(value.at, "counts_as must be a mapping of classes to classes of the truth",
                     "for example {Building: Static}");
      return;
    }
    const std::vector<std::string> known = truthClassNames(LabelMap(content));
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      const YamlNode& target = value.items[i];
      if (!isLocalName(value.keys[i].text))
        faults_->error(value.keys[i].at, "a key of counts_as must be a local name of the ontology, such as StreetSign");
      else if (!target.isScalar() || std::find(known.begin(), known.end(), target.text) == known.end())
        faults_->error(target.at, "the truth has no class '" + target.text + "'", suggestion(target.text, known));
      else
        content.counts_as.emplace(value.keys[i].text, target.text);
    }
  }

  std::optional<std::uint32_t> idOf(const YamlNode& value) {
    std::uint32_t id = 0;
    const char* end = value.text.data() + value.text.size();
    const auto [stop, error] = std::from_chars(value.text.data(), end, id);
    if (value.isScalar() && error == std::errc() && stop == end) return id;
    faults_->error(value.at, "a label id is a whole number from 0 to 4294967295");
    return std::nullopt;
  }

  LabelMeaning readMeaning(const YamlNode& value) {
    LabelMeaning meaning;
    if (!checkMapping(value, kLabelKeys, *faults_)) return meaning;
    if (const YamlNode* name = value.find("name"))
      meaning.name = textOf(*name, "name", *faults_).value_or("");
    else
      faults_->error(value.at, "a label needs a 'name'");
    if (const YamlNode* primitive = value.find("primitive")) meaning.primitive = readPrimitive(*primitive);
    meaning.object_class = localNameAt(value, "object");
    meaning.part = localNameAt(value, "part");
    if (meaning.part && !value.find("object"))
      faults_->error(value.at, "a 'part' needs an 'object' that it is part of");
    if (const YamlNode* near = value.find("near")) meaning.near = readNear(*near);
    return meaning;
  }

  std::optional<PrimitiveLabel> readPrimitive(const YamlNode& value) {
    if (const auto label = primitiveLabelOf(value.text)) return label;
    const std::vector<std::string> known(kPrimitiveLabelNames.begin(), kPrimitiveLabelNames.end());
    faults_->error(value.at, "unknown primitive '" + value.text + "'", suggestion(value.text, known));
    return std::nullopt;
  }

  std::optional<std::string> localNameAt(const YamlNode& mapping, const char* key) {
    const YamlNode* value = mapping.find(key);
    if (!value) return std::nullopt;
    if (value->isScalar() && isLocalName(value->text)) return value->text;
    faults_->error(value->at, std::string(key) + " must be a local name of the ontology, such as StreetSign");
    return std::nullopt;
  }

  std::optional<LabelMeaning::NearRule> readNear(const YamlNode& value) {
    if (!checkMapping(value, kNearKeys, *faults_)) return std::nullopt;
    for (const std::string& key : kNearKeys)
      if (!value.find(key)) faults_->error(value.at, "'near' needs '" + key + "'");
    const YamlNode* label = value.find("label");
    const YamlNode* within = value.find("within");
    const auto id = label ? idOf(*label) : std::nullopt;
    const auto distance_m = within ? metresOf(*within) : std::nullopt;
    const auto object_class = localNameAt(value, "object");
    if (!id || !distance_m || !object_class) return std::nullopt;
    return LabelMeaning::NearRule{*id, *distance_m, *object_class};
  }

  /// "0.6 m"
  std::optional<double> metresOf(const YamlNode& value) {
    double metres = 0;
    const std::string& text = value.text;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), metres);
    const std::string_view unit(stop, static_cast<std::size_t>(text.data() + text.size() - stop));
    const bool good = error == std::errc() && (unit == " m" || unit == "m") && metres > 0 && metres <= 100;
    if (good) return metres;
    faults_->error(value.at, "within must be a distance with its unit, above 0 and at most 100 m",
                   "write it as '0.6 m'");
    return std::nullopt;
  }

  void checkNearIds(const YamlNode& labels, const std::map<std::uint32_t, LabelMeaning>& entries) {
    for (const YamlNode& value : labels.items) {
      const YamlNode* near = value.find("near");
      const YamlNode* label = near ? near->find("label") : nullptr;
      std::uint32_t id = 0;
      if (!label) continue;
      const char* end = label->text.data() + label->text.size();
      if (std::from_chars(label->text.data(), end, id).ptr == end && !entries.contains(id))
        faults_->error(label->at, "the label " + label->text + " is not in this map");
    }
  }

  FaultList* faults_;
};

}  // namespace

LabelMapContent parseLabelMap(std::string_view text, const std::string& file) {
  FaultList faults(file, std::string(text));
  LabelMapContent content;
  if (const auto root = parseYaml(file, text, faults)) content = LabelMapReader(faults).read(*root);
  faults.throwIfErrors();
  return content;
}

LabelMap LabelMap::load(const std::filesystem::path& path) {
  return LabelMap(parseLabelMap(readFile(path), path.string()));
}

const LabelMeaning* LabelMap::find(std::uint32_t id) const {
  const auto entry = content_.labels.find(id);
  return entry == content_.labels.end() ? nullptr : &entry->second;
}

}  // namespace cluxel::scan
