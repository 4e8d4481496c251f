// SPDX-License-Identifier: Apache-2.0
// The search order of the data folders.
#include "cluxel/base/data_home.hpp"

#include <cstdlib>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

namespace fs = std::filesystem;

DataHome DataHome::find(const fs::path& option) {
  std::vector<fs::path> roots;
  if (!option.empty()) roots.push_back(option);
  if (const char* home = std::getenv("CLUXEL_HOME"); home != nullptr && *home != '\0') roots.emplace_back(home);
  std::error_code ignored;
  roots.push_back(fs::current_path(ignored));
  const fs::path executable = fs::read_symlink("/proc/self/exe", ignored);
  for (fs::path folder = executable.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    roots.push_back(folder);
    roots.push_back(folder / "share" / "cluxel");
  }
  return DataHome(std::move(roots));
}

fs::path DataHome::locate(const fs::path& relative) const {
  std::error_code ignored;
  for (const fs::path& root : roots_)
    if (fs::exists(root / relative, ignored)) return root / relative;
  std::string places;
  for (const fs::path& root : roots_) places += "\n  " + (root / relative).string();
  throw Error(ExitCode::FaultyInput, "'" + relative.string() + "' was not found; looked at:" + places +
                                         "\n  hint: name its folder with --home or CLUXEL_HOME");
}

fs::path DataHome::locate(const std::string& folder, const fs::path& name) const {
  std::error_code ignored;
  return fs::exists(name, ignored) ? name : locate(fs::path(folder) / name);
}

}  // namespace cluxel
