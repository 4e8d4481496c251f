// SPDX-License-Identifier: Apache-2.0
// Reads rule test files. All faults are reported at once, each with its place.
#include <algorithm>
#include <charconv>

#include "base/file_bytes.hpp"
#include "base/nearest_name.hpp"
#include "rules/language/rule_reading.hpp"
#include "rules/testing/box_scene_reader.hpp"
#include "rules/testing/rule_test_file.hpp"

namespace cluxel::rules {

namespace {

constexpr std::string_view kTestApiVersion = "cluxel.rules.test/v1";

class TestReader {
 public:
  TestReader(std::filesystem::path folder, const RuleSet& rules, RuleReading& reading)
      : folder_(std::move(folder)), rules_(rules), reading_(reading), faults_(reading.faults), boxes_(reading) {}

  std::vector<RuleTest> read(const YamlNode& root) {
    if (const YamlNode* defaults = root.find("defaults")) readDefaults(*defaults);
    const YamlNode* list = requireKey(root, "tests", "test file", faults_);
    if (list != nullptr && !list->isSequence()) faults_.error(list->at, "'tests' takes a list");
    std::vector<RuleTest> tests;
    if (list != nullptr)
      for (const YamlNode& node : list->items)
        if (checkKeys(node, "test", faults_)) tests.push_back(readTest(node, tests));
    return tests;
  }

 private:
  void readDefaults(const YamlNode& node) {
    if (!checkKeys(node, "defaults", faults_)) return;
    const YamlNode* ground = node.find("ground");
    if (ground == nullptr || !checkKeys(*ground, "ground", faults_)) return;
    if (const YamlNode* z = ground->find("z"))
      if (const auto length = readQuantity(*z, perception::Dimension::Length, reading_)) ground_z_m_ = length->value;
  }

  RuleTest readTest(const YamlNode& node, const std::vector<RuleTest>& earlier) {
    RuleTest test;
    test.at = node.at;
    test.boxes.ground_z_m = ground_z_m_;
    if (const YamlNode* name = requireKey(node, "name", "test", faults_))
      test.name = readText(*name, "a name", faults_).value_or("");
    if (const YamlNode* todo = node.find("todo")) test.todo = readFlag(*todo, faults_).value_or(false);
    std::size_t fixtures = 0;
    const YamlNode* like = node.find("like");
    if (like != nullptr) test.boxes = sceneLike(*like, earlier), ++fixtures;
    if (const YamlNode* primitives = node.find("primitives")) {
      boxes_.readPrimitives(*primitives, test.boxes);
      if (like == nullptr) ++fixtures;
    }
    for (const auto& [key, kind] : {std::pair{"cloud", SceneRequest::Kind::Cloud}, {"map", SceneRequest::Kind::Map}})
      if (const YamlNode* path = node.find(key)) {
        ++fixtures;
        if (const auto text = readText(*path, "a file", faults_)) test.scene = SceneRequest{kind, folder_ / *text};
      }
    if (fixtures != 1) faults_.error(node.at, "a test needs exactly one of: primitives, like, cloud, map");
    if (const YamlNode* views = node.find("views")) boxes_.readViews(*views, test.boxes);
    if (const YamlNode* adjacency = node.find("adjacency")) boxes_.readAdjacency(*adjacency, test.boxes);
    if (const YamlNode* expect = requireKey(node, "expect", "test", faults_)) readExpect(*expect, test);
    return test;
  }

  /// The boxes of an earlier test.
  BoxScene sceneLike(const YamlNode& name, const std::vector<RuleTest>& earlier) {
    std::vector<std::string> known;
    for (const RuleTest& test : earlier) {
      if (name.isScalar() && test.name == name.text && !test.scene) return test.boxes;
      known.push_back(test.name);
    }
    faults_.error(name.at, "no test of boxes above has the name '" + name.text + "'", suggestion(name.text, known));
    return {};
  }

  void readExpect(const YamlNode& node, RuleTest& test) {
    if (!checkKeys(node, "expect", faults_)) return;
    const std::size_t faults_before = faults_.errorCount();
    for (const YamlNode& item : listUnder(node, "objects", "objects", faults_)) readExpectedObject(item, test);
    if (const YamlNode* exactly = node.find("exactly"))
      test.expect.exactly = readFlag(*exactly, faults_).value_or(false);
    for (const YamlNode& item : listUnder(node, "not", "classes", faults_))
      if (const auto iri = readClass(item, reading_)) test.expect.absent.push_back(*iri);
    if (const YamlNode* count = node.find("count")) readCount(*count, test.expect);
    for (const YamlNode& item : listUnder(node, "reasons", "reasons", faults_)) readReason(item, test);
    if (const YamlNode* golden = node.find("golden")) readGolden(node, *golden, test.expect);
    if (faults_.errorCount() == faults_before && expectsNothing(test.expect))
      faults_.error(node.at, "a test that expects nothing cannot fail");
  }

  static bool expectsNothing(const Expectation& expect) {
    return expect.objects.empty() && !expect.exactly && expect.absent.empty() && expect.count.empty() &&
           expect.reasons.empty() && !expect.golden;
  }

  void readCount(const YamlNode& node, Expectation& expect) {
    if (!node.isMap()) faults_.error(node.at, "'count' maps classes to numbers, as in { clx:Tree: 2 }");
    for (std::size_t i = 0; i < node.items.size() && node.isMap(); ++i) {
      const auto iri = readClass(node.keys[i], reading_);
      const auto number = readQuantity(node.items[i], perception::Dimension::Count, reading_);
      if (number &&
          (number->value < 0 || number->value != static_cast<double>(static_cast<std::size_t>(number->value))))
        faults_.error(node.items[i].at, "a whole number is expected here");
      else if (iri && number)
        expect.count[*iri] = static_cast<std::size_t>(number->value);
    }
  }

  void readExpectedObject(const YamlNode& node, RuleTest& test) {
    if (!checkKeys(node, "expected object", faults_)) return;
    ExpectedObject object;
    object.at = node.at;
    if (const YamlNode* name = requireKey(node, "class", "expected object", faults_))
      object.class_iri = readClass(*name, reading_).value_or("");
    if (const YamlNode* primitives = node.find("primitives")) readParts(*primitives, test.boxes, object);
    if (const YamlNode* confidence = node.find("confidence")) readConfidence(*confidence, object);
    if (const YamlNode* rule = node.find("rule")) object.rule_id = readRuleId(*rule);
    test.expect.objects.push_back(std::move(object));
  }

  void readParts(const YamlNode& node, const BoxScene& boxes, ExpectedObject& object) {
    auto readNames = [&](const YamlNode& list, const std::string& part) {
      if (!list.isSequence()) faults_.error(list.at, "a list of primitives is expected here");
      for (const YamlNode& name : list.items) {
        boxes_.checkPrimitive(name, boxes);
        object.parts[part].push_back(name.text);
      }
    };
    if (!node.isMap()) return readNames(node, "");
    for (std::size_t i = 0; i < node.items.size(); ++i)
      if (const auto part = readClass(node.keys[i], reading_)) readNames(node.items[i], *part);
  }

  void readConfidence(const YamlNode& node, ExpectedObject& object) {
    const std::size_t end = node.text.find_first_not_of("<>=");
    const auto number =
        end == std::string::npos
            ? std::nullopt
            : parseNumber(node.text.substr(std::min(node.text.size(), node.text.find_first_not_of(' ', end))));
    const std::string op = node.text.substr(0, end);
    const std::map<std::string, Comparison> known{{">=", Comparison::GreaterEqual}, {">", Comparison::Greater},
                                                  {"<=", Comparison::LessEqual},    {"<", Comparison::Less},
                                                  {"", Comparison::Equal},          {"=", Comparison::Equal}};
    const auto comparison = known.find(op);
    if (!number || comparison == known.end())
      return faults_.error(node.at, "a bound for a confidence is expected here", "write \">= 0.9\"");
    object.confidence_is = comparison->second;
    object.confidence = *number;
  }

  std::string readRuleId(const YamlNode& node) {
    std::vector<std::string> known;
    for (const Rule& rule : rules_.rules) known.push_back(rule.id);
    if (rules_.find(node.text) == nullptr)
      faults_.error(node.at, "there is no rule '" + node.text + "'", suggestion(node.text, known));
    return node.text;
  }

  void readReason(const YamlNode& node, RuleTest& test) {
    if (!checkKeys(node, "expected reason", faults_)) return;
    ExpectedReason reason;
    reason.at = node.at;
    if (const YamlNode* primitive = requireKey(node, "primitive", "expected reason", faults_)) {
      boxes_.checkPrimitive(*primitive, test.boxes);
      reason.primitive = primitive->text;
    }
    if (const YamlNode* rule = requireKey(node, "rule", "expected reason", faults_)) reason.rule_id = readRuleId(*rule);
    if (const YamlNode* text = requireKey(node, "reason", "expected reason", faults_)) reason.reason = text->text;
    test.expect.reasons.push_back(std::move(reason));
  }

  void readGolden(const YamlNode& expect, const YamlNode& node, Expectation& expectation) {
    GoldenObjects golden;
    if (const auto text = readText(node, "a file", faults_)) golden.file = folder_ / *text;
    for (const auto& [key, field] :
         {std::pair{"iou", &golden.iou}, {"min_precision", &golden.min_precision}, {"min_recall", &golden.min_recall}})
      if (const YamlNode* value = expect.find(key)) {
        std::string text = value->text;
        if (text.starts_with(">=")) text = text.substr(std::min(text.size(), text.find_first_not_of(" ", 2)));
        const auto number = parseNumber(text);
        if (number && *number >= 0 && *number <= 1)
          *field = *number;
        else
          faults_.error(value->at, "a share between 0 and 1 is expected here");
      }
    if (golden.min_precision == 0 && golden.min_recall == 0)
      faults_.error(node.at, "'golden' needs min_precision or min_recall above 0, else it cannot fail");
    expectation.golden = std::move(golden);
  }

  std::filesystem::path folder_;
  const RuleSet& rules_;
  RuleReading& reading_;
  FaultList& faults_;
  BoxSceneReader boxes_;
  double ground_z_m_ = 0;
};

std::vector<std::filesystem::path> rulePaths(const YamlNode& root, const std::filesystem::path& folder,
                                             FaultList& faults) {
  std::vector<std::filesystem::path> paths;
  const YamlNode* list = requireKey(root, "rules", "test file", faults);
  if (list == nullptr) return paths;
  if (!list->isSequence()) faults.error(list->at, "'rules' takes a list of files");
  for (const YamlNode& item : list->items)
    if (const auto text = readText(item, "a file", faults)) paths.push_back(folder / *text);
  return paths;
}

}  // namespace

RuleTestFile readRuleTestFile(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                              const RuleLoadOptions& options) {
  const std::string text = readFile(file);
  FaultList faults(file.string(), text);
  const YamlNode root = parseRuleYaml(file.string(), text, faults);
  if (root.isNull() || !checkKeys(root, "test file", faults)) throw InputError(faults.sorted());
  if (const YamlNode* version = requireKey(root, "apiVersion", "test file", faults))
    if (version->text != kTestApiVersion)
      faults.error(version->at, "tests of version '" + version->text + "' cannot be read",
                   "this program reads " + std::string(kTestApiVersion));
  const auto paths = rulePaths(root, file.parent_path(), faults);
  faults.throwIfErrors();
  LoadedRules loaded = loadRules(paths, catalogue, options);
  RuleTestFile tests;
  tests.warnings = loaded.diagnostics;
  for (const std::filesystem::path& path : paths) tests.roots.push_back(path.lexically_normal().string());
  tests.rules = std::move(loaded).require();
  RuleReading reading{catalogue, options, faults};
  reading.prefixes = tests.rules.prefixes;
  tests.tests = TestReader(file.parent_path(), tests.rules, reading).read(root);
  faults.throwIfErrors();
  return tests;
}

}  // namespace cluxel::rules
