// SPDX-License-Identifier: Apache-2.0
// Where the data folders lie: as given, beside the installed binary, or in the checkout.
#include "base/installation/data_home.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <vector>

#include "base/installation/own_binary.hpp"
#include "base/nearest_name.hpp"
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

namespace {

/// The names in a folder that end as `name` does; all names for one without ending.
std::vector<std::string> namesLike(const fs::path& folder, const fs::path& name) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (const fs::path& file = entry.path(); !name.has_extension() || file.extension() == name.extension())
      names.push_back(file.filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// The name that is meant by one with a slip or without its ending, which counts for little in a long name.
std::optional<std::string> nameMeant(const fs::path& name, const std::vector<std::string>& names) {
  const std::string last = name.filename().string(), stem = last.substr(0, last.find('.'));
  std::optional<std::string> whole;
  for (const std::string& known : names)
    if (!last.empty() && known.starts_with(last + ".") && (!whole || known.size() < whole->size())) whole = known;
  if (whole) return whole;
  const auto nearest = nearestName(last, names);
  const bool is_slip = nearest && editDistance(last, *nearest) <= std::max<std::size_t>(1, stem.size() / 3);
  return is_slip ? nearest : std::nullopt;
}

/// `folder`: of the data home, where the name was looked for after the working directory.
[[noreturn]] void refuseName(const fs::path& folder, const fs::path& name) {
  const bool is_path = name.has_parent_path();
  const fs::path beside = is_path ? name.parent_path() : fs::path(".");
  const std::vector<std::string> ours = namesLike(folder, name), theirs = namesLike(beside, name);
  auto meant = is_path ? std::nullopt : nameMeant(name, ours);
  if (!meant) meant = nameMeant(name, theirs);
  if (meant && is_path) meant = (beside / *meant).string();
  std::string text = "'" + name.string() + "' was not found";
  if (!name.is_absolute()) text += "; looked in the working directory and in " + folder.string();
  if (meant)
    text += "\n  hint: did you mean '" + *meant + "'?";
  else if (const std::string known = suggestion("", ours); !is_path && !known.empty())
    text += "\n  hint: " + known;
  else if (!is_path)
    throw Error(ErrorKind::FaultyInput, text, Remedy::NameHome);
  throw Error(ErrorKind::FaultyInput, text);
}

}  // namespace

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
  if (is_ours) return root_ / folder / name;
  if (is_there) return name;
  if (root_.empty() || !fs::is_directory(root_ / folder, ignored)) return locate(fs::path(folder) / name);  // throws
  refuseName(root_ / folder, name);
}

fs::path DataHome::locateFile(const std::string& folder, const fs::path& name, std::string_view ending) const {
  fs::path found = locate(folder, name);
  if (std::error_code ignored; fs::is_directory(found, ignored))
    throw InputError({.file = found.string()}, "is a folder, a file was expected",
                     "name its files: " + (found / "*").string() + std::string(ending));
  return found;
}

}  // namespace cluxel
