// SPDX-License-Identifier: Apache-2.0
// The laws of the layout: which wing may include which, what public headers may name, how long a file may be.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = CLUXEL_SOURCE_DIR;

/// The arrows: a wing and the wings it names directly; what those name is allowed as well.
const std::map<std::string, std::set<std::string>> kArrows{
    {"base", {}},
    {"scan", {"base"}},
    {"simulation", {"scan"}},
    {"perception", {"scan"}},
    {"knowledge", {"base"}},
    {"sparql", {"knowledge"}},
    {"reasoning", {"perception", "sparql"}},
    {"mapping", {"reasoning"}},
    {"tasks", {"mapping"}},
    {"app", {"tasks", "simulation"}},
    {"redland_modules", {"sparql"}},
};

std::set<std::string> reachable(const std::string& wing) {
  std::set<std::string> all{wing};
  for (const std::string& next : kArrows.at(wing)) all.merge(reachable(next));
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

/// "scan" for src/scan/x.cpp and include/cluxel/scan/x.hpp.
std::string wingOf(const fs::path& path) {
  return path.parent_path().filename().string();
}

std::vector<std::string> includesOf(const fs::path& path) {
  static const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<std::string> names;
  for (const std::string& line : linesOf(path))
    if (std::smatch match; std::regex_search(line, match, include)) names.push_back(match[1]);
  return names;
}

/// The wing that an include names, or empty for a header of the system.
std::string wingOfInclude(std::string name) {
  if (name.starts_with("cluxel/")) name = name.substr(7);
  const std::string first = name.substr(0, name.find('/'));
  return kArrows.contains(first) && name.find('/') != std::string::npos ? first : std::string{};
}

TEST(Layout, IncludesRunOnlyAlongTheArrows) {
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src"})) {
    ASSERT_TRUE(kArrows.contains(wingOf(file))) << file << " lies in no wing";
    const auto allowed = reachable(wingOf(file));
    for (const std::string& name : includesOf(file)) {
      const std::string wing = wingOfInclude(name);
      EXPECT_TRUE(wing.empty() || allowed.contains(wing)) << file << " includes " << name;
    }
  }
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

/// What a heavy package is walled in by: files whose names begin so, and no more of them than these. Redland's C tables
/// of callbacks fill two modules (docs/decisions.md).
struct Wall {
  std::string name;
  std::size_t most;
};

TEST(Layout, HeavyPackagesStayInFewFilesThatAreNamedForThem) {
  const std::map<std::string, Wall> walls{
      {"pcl/", {"pcl_", 2}},       {"yaml-cpp/", {"yaml_", 2}}, {"lmdb", {"lmdb_", 1}},
      {"librdf", {"redland_", 7}}, {"raptor", {"rdf_", 1}},     {"rasqal", {"", 0}},
      {"embree", {"ray_", 2}},     {"boost/graph/", {"", 3}},   {"boost/geometry", {"geometry", 2}}};
  for (const auto& [package, wall] : walls) {
    std::set<fs::path> users;
    for (const fs::path& file : sourcesBelow({"src"}))
      for (const std::string& name : includesOf(file))
        if (name.starts_with(package)) users.insert(file);
    for (const fs::path& file : users)
      EXPECT_TRUE(file.filename().string().starts_with(wall.name)) << file << " includes " << package;
    EXPECT_LE(users.size(), wall.most) << package << " is included by too many files";
  }
}

/// A unit is a header and a source of its name. Where several sources make one unit (operators, makers, readers), each
/// includes the header of its wing that declares what it defines.
TEST(Layout, EverySourceHasAHeaderInItsWing) {
  for (const fs::path& file : sourcesBelow({"src"})) {
    const std::string wing = wingOf(file), name = file.stem().string() + ".hpp";
    if (file.extension() != ".cpp" || wing == "redland_modules" || name == "main.hpp") continue;
    const bool has_own = fs::exists(kRoot / "include/cluxel" / wing / name) || fs::exists(kRoot / "src" / wing / name);
    const auto includes = includesOf(file);
    const bool joins_a_unit = std::any_of(includes.begin(), includes.end(),
                                          [&](const std::string& include) { return wingOfInclude(include) == wing; });
    EXPECT_TRUE(has_own || joins_a_unit) << file << " defines what no header of its wing declares";
  }
}

TEST(Layout, EveryHeaderOfAWingIsIncludedBySomeSource) {
  std::set<std::string> included;
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src"}))
    for (const std::string& name : includesOf(file))
      included.insert(name.starts_with("cluxel/") ? name.substr(7) : name);
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src"}))
    if (file.extension() == ".hpp") {
      EXPECT_TRUE(included.contains(wingOf(file) + "/" + file.filename().string())) << file << " is included by nobody";
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
  constexpr std::size_t kLongest = 350;
  for (const fs::path& file : sourcesBelow({"include/cluxel", "src", "tests", "bench"})) {
    const auto lines = linesOf(file);
    ASSERT_GE(lines.size(), 2U) << file;
    EXPECT_EQ(lines[0], "// SPDX-License-Identifier: Apache-2.0") << file;
    EXPECT_TRUE(lines[1].starts_with("// ")) << file << " does not say what it is for";
    EXPECT_LE(lines.size(), kLongest) << file << " is longer than " << kLongest << " lines: split it";
  }
}

}  // namespace
