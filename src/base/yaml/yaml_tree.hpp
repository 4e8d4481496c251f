// SPDX-License-Identifier: Apache-2.0
// YAML as a plain tree of values that know their place, and the checks that all readers of YAML files share.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/yaml/fault_list.hpp"
#include "cluxel/error.hpp"

namespace cluxel {

struct YamlNode {
  enum class Kind { Null, Scalar, Sequence, Map } kind = Kind::Null;
  SourceLocation at;
  std::string text;             ///< of a scalar, without quotes and escapes
  std::vector<YamlNode> keys;   ///< of a map: scalars, in the order written, each once
  std::vector<YamlNode> items;  ///< of a sequence; of a map, the value of each key

  bool isMap() const { return kind == Kind::Map; }
  bool isSequence() const { return kind == Kind::Sequence; }
  bool isScalar() const { return kind == Kind::Scalar; }
  bool isNull() const { return kind == Kind::Null; }
  /// The value of `key` in a map, or null. Cost linear in the number of keys.
  const YamlNode* find(std::string_view key) const;
  const YamlNode* keyNode(std::string_view key) const;
};

/// "a mapping", "a list", "a single value", "nothing".
std::string_view describeKind(const YamlNode& node);

/// Parses one document; an empty text gives a Null node. Repeated keys, keys that are no scalars, anchors, aliases and
/// further documents are faults. Absent, with a fault, when the text is not YAML or nested more than 80 levels deep,
/// larger than 8 MiB, or not UTF-8.
/// `faults` must know `file`.
std::optional<YamlNode> parseYaml(const std::string& file, std::string_view text, FaultList& faults);

/// Faults the keys of a map that are not `known`, with "did you mean". `where` completes the message: " in 'rule'".
void refuseUnknownKeys(const YamlNode& map, std::span<const std::string> known, std::string_view where,
                       FaultList& faults);
/// The same for a value that must be a map; false, with a fault, when it is none.
bool checkMapping(const YamlNode& node, std::span<const std::string> known, FaultList& faults);

/// The finite number that is the whole of `text`; a leading '+' is allowed.
std::optional<double> parseNumber(std::string_view text);

// Values of files that need no units. What does not fit is a fault that calls the value `what`.

/// A finite number.
std::optional<double> numberOf(const YamlNode& node, std::string_view what, FaultList& faults);
/// Exactly `count` finite numbers; rows (sequences of sequences) are joined.
std::optional<std::vector<double>> numbersOf(const YamlNode& node, std::size_t count, std::string_view what,
                                             FaultList& faults);
/// A text that is not empty.
std::optional<std::string> textOf(const YamlNode& node, std::string_view what, FaultList& faults);

}  // namespace cluxel
