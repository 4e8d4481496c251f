// SPDX-License-Identifier: Apache-2.0
// Where the data folders lie: as given, beside the installed binary, or in the checkout.
#include "base/installation/data_home.hpp"

#include <cstdlib>
#include <vector>

#include "base/installation/own_binary.hpp"
#include "cluxel/error.hpp"

namespace cluxel {

namespace fs = std::filesystem;

fs::path dataHomeOf(const fs::path& binary) {
  constexpr std::size_t kMaxDepth = 3;  // prefix/lib/<architecture>/cluxel
  std::error_code ignored;
  std::vector<fs::path> folders;
  for (fs::path folder = binary.parent_path(); folder.has_relative_path(); folder = folder.parent_path())
    folders.push_back(folder);
  for (std::size_t depth = 1; depth <= kMaxDepth && depth < folders.size(); ++depth) {
    const fs::path share = folders[depth] / "share" / "cluxel";
    if (fs::is_directory(share / "ontology", ignored)) return share;
  }
  for (const fs::path& folder : folders)
    if (fs::exists(folder / "CMakeLists.txt", ignored) && fs::is_directory(folder / "ontology", ignored)) return folder;
  return {};
}

DataHome DataHome::find(const fs::path& option) {
  if (!option.empty()) return DataHome(option);
  if (const char* home = std::getenv("CLUXEL_HOME"); home != nullptr && *home != '\0') return DataHome(home);
  return DataHome(dataHomeOf(ownBinary()));
}

fs::path DataHome::locate(const fs::path& relative) const {
  std::error_code ignored;
  if (!root_.empty() && fs::exists(root_ / relative, ignored)) return root_ / relative;
  const std::string place = root_.empty() ? "there is neither an installation nor a checkout around the program"
                                          : "looked at " + (root_ / relative).string();
  throw Error(ErrorKind::FaultyInput, "'" + relative.string() + "' was not found; " + place, Remedy::NameHome);
}

fs::path DataHome::locate(const std::string& folder, const fs::path& name) const {
  std::error_code ignored;
  const bool is_there = fs::exists(name, ignored);
  if (is_there && (name.has_parent_path() || !fs::is_directory(name, ignored))) return name;
  const bool is_ours = !root_.empty() && fs::exists(root_ / folder / name, ignored);
  return is_there && !is_ours ? name : locate(fs::path(folder) / name);
}

}  // namespace cluxel
