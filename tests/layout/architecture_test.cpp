// SPDX-License-Identifier: Apache-2.0
// What docs/architecture.md names exists, and what several modules need is written once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "test_paths.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path& root() {
  static const fs::path folder = cluxel::test::sourceFolder();
  return folder;
}

std::string textOf(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Path below src/ or include/ → text.
const std::map<std::string, std::string>& sources() {
  static const auto all = [] {
    std::map<std::string, std::string> found;
    for (const fs::path& top : {root() / "src", root() / "include"})
      for (const auto& entry : fs::recursive_directory_iterator(top))
        if (entry.is_regular_file()) found[fs::relative(entry.path(), top).generic_string()] = textOf(entry.path());
    return found;
  }();
  return all;
}

/// The spans between backticks, without blocks of code.
std::vector<std::string> codeSpansOf(std::string text) {
  text = std::regex_replace(text, std::regex("```[^`]*```"), "");
  std::vector<std::string> spans;
  const std::regex span("`([^`\n]+)`");
  for (std::sregex_iterator it(text.begin(), text.end(), span), end; it != end; ++it) spans.push_back((*it)[1]);
  return spans;
}

/// "scan/scan_layouts" is a header and its source, also when only the last part of a folder is written.
bool isPathOfSources(const std::string& name) {
  if (fs::exists(root() / name) || fs::exists(root() / "src" / name)) return true;
  return std::any_of(sources().begin(), sources().end(), [&](const auto& source) {
    const std::string path = "/" + source.first;
    return path.ends_with("/" + name) || path.ends_with("/" + name + ".hpp") || path.ends_with("/" + name + ".cpp");
  });
}

/// All identifiers of all sources.
const std::set<std::string>& words() {
  static const auto all = [] {
    std::set<std::string> found;
    for (const auto& [file, text] : sources()) {
      std::string word;
      for (const char c : text + " ") {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_') {
          word += c;
        } else {
          found.insert(word);
          word.clear();
        }
      }
    }
    return found;
  }();
  return all;
}

/// The last name of "scan::ScanSet::open" is an identifier of some source.
bool isNameInSources(const std::string& name) {
  return words().contains(name.substr(name.rfind(':') + 1));
}

TEST(Architecture, NamesFilesAndFunctionsThatExist) {
  const std::regex path("[a-z_]+(/[a-z_]+)+(\\.[ch]pp|\\.ts|/)?"), qualified("[A-Za-z_]+(::[A-Za-z_]+)+");
  std::size_t paths = 0, names = 0;
  for (std::string span : codeSpansOf(textOf(root() / "docs/architecture.md"))) {
    if (std::regex_match(span, path)) {
      ++paths;
      if (span.back() == '/') span.pop_back();
      EXPECT_TRUE(isPathOfSources(span)) << "docs/architecture.md names `" << span << "`";
    } else if (std::regex_match(span, qualified)) {
      ++names;
      EXPECT_TRUE(isNameInSources(span)) << "docs/architecture.md names `" << span << "`";
    }
  }
  EXPECT_GT(paths, 30U);
  EXPECT_GT(names, 10U);
}

/// Module → parts, from the table in docs/architecture.md.
std::map<std::string, std::set<std::string>> partsInTheTable() {
  std::map<std::string, std::set<std::string>> table;
  const std::string text = textOf(root() / "docs/architecture.md");
  const std::regex row(R"(\n\| (\w+) \| [^|\n]* \|([^|\n]*)\| `)"), word(R"(\w+)");
  for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) {
    const std::string parts = (*it)[2];
    auto& listed = table[(*it)[1]];
    for (std::sregex_iterator part(parts.begin(), parts.end(), word); part != end; ++part) listed.insert(part->str());
  }
  return table;
}

TEST(Architecture, ListsTheModulesAndTheirPartsAsTheFoldersAre) {
  std::map<std::string, std::set<std::string>> folders;
  for (const auto& module : fs::directory_iterator(root() / "src")) {
    const std::string name = module.path().filename();
    if (!module.is_directory() || name.ends_with("_module")) continue;  // a plugin, told in the text
    auto& parts = folders[name];
    for (const auto& part : fs::directory_iterator(module))
      if (part.is_directory()) parts.insert(part.path().filename());
  }
  EXPECT_EQ(partsInTheTable(), folders);
}

TEST(Architecture, WhatSeveralModulesNeedIsWrittenOnce) {
  const std::map<std::string, std::set<std::string>> homes{
      {"- 'A' + 'a'", {"base/ascii.hpp"}},         {"0x94d049bb133111eb", {"base/mixed_bits.hpp"}},
      {"mkdtemp", {"rdf/file/file_guards.cpp"}},   {"its build is unfinished", {"mapping/map_state.cpp"}},
      {"<yaml-cpp/", {"base/yaml/yaml_tree.cpp"}},
  };
  for (const auto& [text, expected] : homes) {
    std::set<std::string> found;
    for (const auto& [file, content] : sources())
      if (content.find(text) != std::string::npos) found.insert(file);
    EXPECT_EQ(found, expected) << "'" << text << "' is in another file than the one that is for it";
  }
}

}  // namespace
