// SPDX-License-Identifier: Apache-2.0
// Brings the files of a rule set together: includes, overrides, one order.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/reasoning/rule_set.hpp"
#include "reasoning/yaml_document.hpp"

namespace cluxel {

/// A rule set before anything in it has been understood: every node still knows its file and line.
struct GatheredRules {
  std::string name, version, description;
  std::vector<std::pair<YamlNode, YamlNode>> prefixes, constants;  ///< key, value
  std::vector<YamlNode> order;
  std::vector<YamlNode> rules;
  std::vector<RuleSource> sources;  ///< in the order they were read
};

/// Finds and reads a file: `name` as written, `from` the file that includes it (empty for a root). Gives the name by
/// which the file is known and its text, or says why not.
struct FoundSource {
  std::string key, shown, text;  ///< key: one per file, to find cycles; shown: in diagnostics and sources
  std::string fault;
};
using FindSource = std::function<FoundSource(const std::string& name, const std::string& from_key)>;

GatheredRules gatherRules(const std::vector<std::string>& roots, const FindSource& findSource, FaultList& faults);

}  // namespace cluxel
