// SPDX-License-Identifier: Apache-2.0
// YAML as a plain tree that knows where each node stands and keeps repeated keys, so that they can be reported.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

struct YamlNode {
  enum class Kind { Null, Scalar, Sequence, Map } kind = Kind::Null;
  SourceLocation at;
  std::string text;  ///< of a scalar
  bool quoted = false;
  std::vector<YamlNode> keys;   ///< of a map, in the order written, each key once
  std::vector<YamlNode> items;  ///< of a sequence; of a map, the value of each key

  bool isMap() const { return kind == Kind::Map; }
  bool isSequence() const { return kind == Kind::Sequence; }
  bool isScalar() const { return kind == Kind::Scalar; }
  bool isNull() const { return kind == Kind::Null; }
  /// The value of `key`, or null.
  const YamlNode* find(std::string_view key) const;
  const YamlNode* keyNode(std::string_view key) const;
};

/// "a mapping", "a list", "text", "nothing".
std::string_view describeKind(const YamlNode& node);

/// Collects faults with the lines they stand in.
class FaultList {
 public:
  /// `text` must outlive the list's use for `file`.
  void addFile(std::string file, std::string text);
  void error(const SourceLocation& at, std::string message, std::string hint = {});
  void warning(const SourceLocation& at, std::string message, std::string hint = {});
  const std::vector<Diagnostic>& all() const { return faults_; }
  /// In the order of the files, then by place; equal faults once.
  std::vector<Diagnostic> sorted() const;
  std::size_t errorCount() const { return errors_; }

 private:
  void add(Severity severity, const SourceLocation& at, std::string message, std::string hint);
  std::vector<std::pair<std::string, std::string>> files_;
  std::vector<Diagnostic> faults_;
  std::size_t errors_ = 0, warnings_ = 0;
};

/// Parses one document. Faults of form (syntax, repeated keys, aliases, depth) go to `faults`; what could be read is
/// returned, a Null node when nothing could.
YamlNode parseYaml(const std::string& file, const std::string& text, FaultList& faults);

}  // namespace cluxel
