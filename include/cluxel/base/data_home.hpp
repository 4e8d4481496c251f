// SPDX-License-Identifier: Apache-2.0
// Finds the data folders: ontology, rules, queries, models, labels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace cluxel {

/// Where to look, most wanted first: the option `--home`, CLUXEL_HOME, the working directory, beside the executable
/// and the folders above it.
class DataHome {
 public:
  /// `option` is the value of `--home`, or empty.
  static DataHome find(const std::filesystem::path& option = {});
  explicit DataHome(std::vector<std::filesystem::path> roots) : roots_(std::move(roots)) {}

  /// The first existing `root/relative`; an Error (FaultyInput) that lists the places looked at when there is none.
  std::filesystem::path locate(const std::filesystem::path& relative) const;
  /// `name` itself when it exists as a file or folder, else locate(folder / name).
  std::filesystem::path locate(const std::string& folder, const std::filesystem::path& name) const;
  const std::vector<std::filesystem::path>& roots() const { return roots_; }

 private:
  std::vector<std::filesystem::path> roots_;
};

}  // namespace cluxel
