// SPDX-License-Identifier: Apache-2.0
// YAML as a tree of values with their places, and the collecting of all faults of one file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

struct YamlEntry;

struct YamlValue {
  enum class Kind { Null, Scalar, Sequence, Mapping };
  Kind kind = Kind::Null;
  std::string scalar;
  std::size_t line = 0, column = 0;  ///< from 1
  std::vector<YamlValue> items;      ///< of a sequence
  std::vector<YamlEntry> entries;    ///< of a mapping, in the order written; keys are scalars

  const YamlValue* find(std::string_view key) const;
};

struct YamlEntry {
  YamlValue key, value;
};

/// The faults found so far in one authored file.
class YamlFaults {
 public:
  YamlFaults(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {}

  void add(const YamlValue& place, std::string message, std::string hint = {});
  /// Throws an InputError with all of them, if there are any.
  void throwIfAny() const;

 private:
  std::string file_;
  std::string_view text_;
  std::vector<Diagnostic> diagnostics_;
  std::size_t further_ = 0;  ///< faults that are only counted
};

/// The tree of the first document. Duplicate keys, anchors and aliases are faults; text that is no YAML
/// throws at once.
YamlValue parseYaml(std::string_view text, const std::string& file, YamlFaults& faults);

/// Faults keys that are not in `known`, with "did you mean"; also a value that is no mapping.
bool checkMapping(const YamlValue& value, const std::vector<std::string>& known, YamlFaults& faults);

/// A finite number; a fault that calls it `what` when it is none.
std::optional<double> numberOf(const YamlValue& value, const char* what, YamlFaults& faults);
/// Exactly `count` numbers; those of rows (sequences of sequences) are joined.
std::optional<std::vector<double>> numbersOf(const YamlValue& value, std::size_t count, const char* what,
                                             YamlFaults& faults);
/// A text that is not empty.
std::optional<std::string> textOf(const YamlValue& value, const char* what, YamlFaults& faults);

}  // namespace cluxel
