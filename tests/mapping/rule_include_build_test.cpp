// SPDX-License-Identifier: Apache-2.0
// A build with a rule file that includes another: the map stores both texts and does not need the files any more.
#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "mapping/asking_rules.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace rules;
namespace {

constexpr const char* kBase = R"(apiVersion: cluxel.rules/v1
ruleset: { name: base, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Ground, clx:SmallObject]
rules:
  - id: ground/all
    class: clx:Ground
    description: All that is flat.
    seed: { label: horizontal_plane, where: [ { attribute: length, op: ">=", value: 5 m } ] }
    tree: { test: { attribute: normal_tilt, op: "<=", value: 30 deg }, yes: { accept: { confidence: 0.9 } }, no: { reject: steep } }
)";
constexpr const char* kOver = R"(apiVersion: cluxel.rules/v1
include: [ ../base.rules.yaml ]
rules:
  - id: small/raised
    class: clx:SmallObject
    description: What is raised a little.
    seed: { label_in: [horizontal_plane, vertical_plane, small_structure, scatter, column] }
    group: { near: 0.4 m }
    tree: { test: { attribute: top, op: between, min: 0.35 m, max: 1.2 m }, yes: { accept: { confidence: 0.7 } }, no: { reject: of another height } }
)";

/// Writes the base file, and a rule file that includes it.
MapInputFiles writtenRules(const ScratchFolder& folder, const std::string& over = kOver) {
  std::filesystem::create_directories(folder.path() / "mine");
  writeFile(folder.path() / "base.rules.yaml", kBase);
  writeFile(folder.path() / "mine/over.rules.yaml", over);
  MapInputFiles files;
  files.rules = {folder.path() / "mine/over.rules.yaml"};
  return files;
}

TEST(RuleInclude, GoesIntoTheMapWithAllItsTexts) {
  const ScratchFolder folder;
  const MapInputFiles files = writtenRules(folder);
  writeScanFile(parkWithBench(), folder.path() / "park.pcd");
  const MapInputs inputs = readMapInputs(files, DataHome(test::sourceFolder()));
  EXPECT_EQ(inputs.rule_roots, 1U);
  EXPECT_EQ(inputs.rules.size(), 2U);
  std::filesystem::remove(folder.path() / "base.rules.yaml");
  std::filesystem::remove(folder.path() / "mine/over.rules.yaml");
  buildMap(scansOf({folder.path() / "park.pcd"}), inputs, folder.path() / "map.clx", {}, silence());
  const MapReader map(folder.path() / "map.clx");
  const MapSummary summary = map.summary();
  EXPECT_EQ(summary.objects_by_class.count("Ground"), 1U) << "by the included file";
  EXPECT_EQ(summary.objects_by_class.count("SmallObject"), 1U) << "by the including one";
  EXPECT_EQ(map.inputs().rules.size(), 2U);
  EXPECT_EQ(map.inputs().hash(), inputs.hash());
}

TEST(RuleInclude, CountsInTheInputsOfTheMap) {
  const ScratchFolder folder;
  const MapInputFiles files = writtenRules(folder);
  const DataHome home(test::sourceFolder());
  const ContentHash before = readMapInputs(files, home).hash();
  writeFile(folder.path() / "base.rules.yaml", std::string(kBase) + "# changed\n");
  EXPECT_NE(readMapInputs(files, home).hash(), before);
}

/// The faults that are told of a rule file, which includes the base file, when it is read and its texts are loaded.
std::string faultsOf(const std::string& over) {
  const ScratchFolder folder;
  try {
    parseInputs(readMapInputs(writtenRules(folder, over), DataHome(test::sourceFolder())));
  } catch (const InputError& fault) {
    std::string told;
    for (const Diagnostic& diagnostic : fault.diagnostics()) told += diagnostic.message + "\n";
    return told;
  }
  return {};
}

TEST(RuleInclude, FaultsAreThoseOfTheRulesAndNotOfTheInclude) {
  const std::string over = kOver;
  const auto with = [&](const std::string& from, const std::string& to) {
    return std::string(over).replace(over.find(from), from.size(), to);
  };
  EXPECT_EQ(faultsOf(over), "");
  EXPECT_EQ(faultsOf(with("attribute: top", "attribute: tpo")), "unknown attribute 'tpo'\n");
  EXPECT_EQ(faultsOf(over + "override: { remove: [ground/nothing] }\n"),
            "there is no rule 'ground/nothing' to override\n");
  const std::string missing = faultsOf(with("../base.rules.yaml", "../bass.rules.yaml"));
  EXPECT_NE(missing.find("bass.rules.yaml"), std::string::npos) << missing;
  EXPECT_EQ(missing.find("not among"), std::string::npos) << missing;
}

}  // namespace
}  // namespace cluxel::mapping
