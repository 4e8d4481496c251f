// SPDX-License-Identifier: Apache-2.0
// Finds the data folders: ontology, rules, queries, models, labels.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cluxel {

/// The one folder that holds the data folders. The first that is given or found of: the option `--home`, the variable
/// CLUXEL_HOME, share/cluxel of the prefix in which the program or library is installed, the checkout in which it was
/// built. The working directory is never searched.
class DataHome {
 public:
  /// `option` is the value of `--home`, or empty.
  static DataHome find(const std::filesystem::path& option = {});
  /// An empty root means that no home was found: locate() then fails.
  explicit DataHome(std::filesystem::path root) : root_(std::move(root)) {}

  /// `root/relative`. Throws Error (FaultyInput) with the path and the remedy when it does not exist.
  std::filesystem::path locate(const std::filesystem::path& relative) const;
  /// Finds what a user calls `name`. In this order: an existing file or a path that has a folder in it;
  /// `root/folder/name`; an entry of the working directory. So a folder of the working directory never hides a name of
  /// the data home. Throws Error (FaultyInput) that tells where it looked, and the nearest name there.
  std::filesystem::path locate(const std::string& folder, const std::filesystem::path& name) const;
  /// As locate(), for a file whose name has `ending`; of a folder the message tells to name its files.
  std::filesystem::path locateFile(const std::string& folder, const std::filesystem::path& name,
                                   std::string_view ending) const;
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

/// The data home that belongs to a program or library file: share/cluxel in one of the three folders above the file's
/// own, else the nearest folder above it that holds CMakeLists.txt and ontology/. Empty when there is none.
std::filesystem::path dataHomeOf(const std::filesystem::path& binary);

}  // namespace cluxel
