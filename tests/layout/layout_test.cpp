// SPDX-License-Identifier: Apache-2.0
// The laws of the layout: which module may include which, what public headers may name, how long a file may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "test_paths.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = cluxel::test::sourceFolder();

/// The arrows: a module and the modules it names directly; what those name is allowed as well.
const std::map<std::string, std::set<std::string>> kArrows{
    {"base", {}},
    {"scan", {"base"}},
    {"simulation", {"scan"}},
    {"perception", {"scan"}},
    {"rdf", {"base"}},
    {"sparql", {"rdf"}},
    {"rules", {"perception", "sparql"}},
    {"mapping", {"rules"}},
    {"tasks", {"mapping"}},
    {"api", {"tasks"}},
    {"serve", {"api"}},
    {"app", {"serve", "simulation"}},
    {"redland_module", {"rdf"}},
    {"pcl_module", {"scan"}},
};

std::set<std::string> reachable(const std::string& module) {
  std::set<std::string> all{module};
  for (const std::string& next : kArrows.at(module)) all.merge(reachable(next));
  return all;
}

std::vector<fs::path> sourcesBelow(const std::vector<std::string>& folders) {
  std::vector<fs::path> files;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") files.push_back(entry.path());
  return files;
}

std::vector<std::string> linesOf(const fs::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// How an #include names a header: "scan/formats/pcd_format.hpp", "cluxel/error.hpp".
std::string includeNameOf(const fs::path& path) {
  const std::string from_root = fs::relative(path, kRoot).generic_string();
  return from_root.substr(from_root.find('/') + 1);
}

/// "scan" for src/scan/formats/x.cpp and for the include "scan/formats/x.hpp"; empty for headers of the system.
std::string moduleOfInclude(const std::string& name) {
  const std::string first = name.substr(0, name.find('/'));
  return kArrows.contains(first) && name.find('/') != std::string::npos ? first : std::string{};
}

std::string moduleOf(const fs::path& path) {
  return moduleOfInclude(includeNameOf(path));
}

std::vector<std::string> includesOf(const fs::path& path) {
  static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> names;
  for (const std::string& line : linesOf(path))
    if (std::smatch match; std::regex_search(line, match, include)) names.push_back(match[1]);
  return names;
}

TEST(Layout, IncludesRunOnlyAlongTheArrows) {
  for (const fs::path& file : sourcesBelow({"src"})) {
    ASSERT_TRUE(kArrows.contains(moduleOf(file))) << file << " lies in no module";
    const auto allowed = reachable(moduleOf(file));
    for (const std::string& name : includesOf(file)) {
      const std::string module = moduleOfInclude(name);
      EXPECT_TRUE(module.empty() || allowed.contains(module)) << file << " includes " << name;
    }
  }
}

TEST(Layout, AModuleIsANamespace) {
  static const std::regex opening(R"(^namespace cluxel(::(\w+))?\b)");
  const std::set<std::string> in_plain_cluxel{"base", "api", "term.cpp"};
  for (const fs::path& file : sourcesBelow({"src"}))
    for (const std::string& line : linesOf(file)) {
      std::smatch match;
      if (!std::regex_search(line, match, opening) || line.find('{') == std::string::npos) continue;
      const std::string module = moduleOf(file);
      const bool is_plain = in_plain_cluxel.contains(module) || in_plain_cluxel.contains(file.filename().string());
      const bool is_forward = line.find('}') != std::string::npos || reachable(module).contains(match[2]);
      EXPECT_TRUE(is_plain ? match[2].length() == 0 || is_forward : match[2] == module || is_forward)
          << file << " opens " << line;
    }
}

TEST(Layout, AFolderHoldsFewEnoughFilesToBeSeenAtOnce) {
  constexpr std::size_t kMaxFiles = 30;
  std::map<fs::path, std::size_t> count;
  for (const fs::path& file : sourcesBelow({"src", "include"})) ++count[file.parent_path()];
  for (const auto& [folder, files] : count) EXPECT_LE(files, kMaxFiles) << folder << " wants subfolders";
}

TEST(Layout, TheInstalledApiIsAFacadeAndAtMostTwentyFiveHeaders) {
  EXPECT_LE(sourcesBelow({"include/cluxel"}).size(), 25U);
}

TEST(Layout, ExitCodesLiveInTheProgramOnly) {
  for (const fs::path& file : sourcesBelow({"src", "include"}))
    for (const std::string& line : linesOf(file))
      EXPECT_TRUE(moduleOf(file) == "app" || line.find("ExitCode") == std::string::npos) << file << ": " << line;
}

TEST(Layout, NamesOfOptionsLiveInTheProgramOnly) {
  static const std::regex option(R"re("(?:[^"\\]*[\s'`(,;])?--[a-z])re");
  for (const fs::path& file : sourcesBelow({"src", "include"}))
    for (const std::string& line : linesOf(file))
      EXPECT_TRUE(moduleOf(file) == "app" || !std::regex_search(line, option))
          << file << " names an option; give the error a Remedy: " << line;
}

TEST(Layout, WhatCommandsWriteReplacesNoMap) {
  for (const fs::path& file : sourcesBelow({"src/app"}))
    for (const std::string& line : linesOf(file))
      EXPECT_TRUE(file.filename() == "shared_options.cpp" || line.find("writeFile(") == std::string::npos)
          << file << " writes a file without writeOutput(): " << line;
}

TEST(Layout, PublicHeadersNameTheStandardLibraryAndEigenOnly) {
  for (const fs::path& file : sourcesBelow({"include/cluxel"}))
    for (const std::string& name : includesOf(file)) {
      const bool is_own = name.starts_with("cluxel/");
      const bool is_eigen = name.starts_with("Eigen/");
      const bool is_standard = name.find('/') == std::string::npos && name.find('.') == std::string::npos;
      EXPECT_TRUE(is_own || is_eigen || is_standard) << file << " includes " << name;
    }
}

TEST(Layout, ThePythonModuleSeesTheInstalledInterfaceOnly) {
  for (const fs::path& file : sourcesBelow({"python"}))
    for (const std::string& name : includesOf(file)) {
      const bool is_own = name.starts_with("cluxel/") || fs::exists(kRoot / "python" / name);
      const bool is_standard = name.find('/') == std::string::npos && name.find('.') == std::string::npos;
      EXPECT_TRUE(is_own || name.starts_with("pybind11/") || is_standard) << file << " includes " << name;
    }
}

/// The files that may include a heavy package: names that begin with `name`, and at most `max_files` of them. Redland's
/// tables of C callbacks need two modules (docs/decisions.md). PROJ places maps (tasks) and describes coordinate
/// systems (base).
struct Wall {
  std::string name;
  std::size_t max_files;
};

TEST(Layout, HeavyPackagesStayInFewFilesThatAreNamedForThem) {
  const std::map<std::string, Wall> walls{
      {"pcl/", {"pcl_", 2}},       {"yaml-cpp/", {"yaml_", 1}}, {"lmdb", {"lmdb_", 1}},
      {"librdf", {"redland_", 7}}, {"raptor", {"rdf_", 1}},     {"rasqal", {"", 0}},
      {"embree", {"ray_", 2}},     {"httplib.h", {"http_", 2}}, {"proj.h", {"proj_", 2}},
      {"zstd.h", {"zstd_", 1}},    {"boost/graph/", {"", 3}},   {"boost/geometry", {"geometry", 2}}};
  for (const auto& [package, wall] : walls) {
    std::set<fs::path> users;
    for (const fs::path& file : sourcesBelow({"src"}))
      for (const std::string& name : includesOf(file))
        if (name.starts_with(package)) users.insert(file);
    for (const fs::path& file : users)
      EXPECT_TRUE(file.filename().string().starts_with(wall.name)) << file << " includes " << package;
    EXPECT_LE(users.size(), wall.max_files) << package << " is included by too many files";
  }
}

/// A unit is a header and a source of its name. Where several sources make one unit (operators, makers, readers), each
/// includes the header of its module that declares what it defines.
TEST(Layout, EverySourceHasAHeaderInItsModule) {
  for (const fs::path& file : sourcesBelow({"src"})) {
    const std::string module = moduleOf(file), name = file.stem().string() + ".hpp";
    if (file.extension() != ".cpp" || module == "redland_module" || name == "main.hpp") continue;
    const bool has_own = fs::exists(file.parent_path() / name) || fs::exists(kRoot / "include/cluxel" / name);
    const auto includes = includesOf(file);
    const bool joins_a_unit = std::any_of(includes.begin(), includes.end(), [&](const std::string& include) {
      return moduleOfInclude(include) == module;
    });
    EXPECT_TRUE(has_own || joins_a_unit) << file << " defines what no header of its module declares";
  }
}

TEST(Layout, EveryHeaderOfAModuleIsIncludedBySomeSource) {
  std::set<std::string> included;
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src"}))
    for (const std::string& name : includesOf(file)) included.insert(name);
  for (const fs::path& file : sourcesBelow({"src"}))
    if (file.extension() == ".hpp") {
      EXPECT_TRUE(included.contains(includeNameOf(file))) << file << " is included by nobody";
    }
}

TEST(Layout, FileNamesAreUniqueInTheTree) {
  std::map<std::string, fs::path> seen;
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src"})) {
    const auto [place, is_new] = seen.emplace(file.filename().string(), file);
    EXPECT_TRUE(is_new) << file << " has the name of " << place->second;
  }
}

TEST(Layout, EveryFileOpensWithItsLicenceAndPurposeAndStaysShort) {
  constexpr std::size_t kMaxLines = 350;
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src", "python", "tests", "bench"})) {
    const auto lines = linesOf(file);
    ASSERT_GE(lines.size(), 2U) << file;
    EXPECT_EQ(lines[0], "// SPDX-License-Identifier: Apache-2.0") << file;
    EXPECT_TRUE(lines[1].starts_with("// ")) << file << " does not say what it is for";
    EXPECT_LE(lines.size(), kMaxLines) << file << " is longer than " << kMaxLines << " lines: split it";
  }
}

}  // namespace
