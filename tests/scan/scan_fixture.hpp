// SPDX-License-Identifier: Apache-2.0
// Temporary folders, files and expected errors for the tests of the module scan.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "cluxel/progress.hpp"

namespace cluxel::test {

namespace fs = std::filesystem;

/// A temporary folder that is removed after the test.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "cluxel_scan_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  const fs::path& path() const { return path_; }
  fs::path write(const fs::path& name, const std::string& bytes) const {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  fs::path path_;
};

/// Records notes.
class NoteKeeper : public ProgressSink {
 public:
  void note(std::string_view message) override { notes.emplace_back(message); }
  std::vector<std::string> notes;
};

/// The message of the InputError that `act` throws; the test fails when it throws none.
template <typename Act>
std::string refusalOf(const Act& act) {
  try {
    act();
  } catch (const InputError& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

/// Little-endian bytes of numbers.
template <typename... Numbers>
std::string bytesOfAll(Numbers... numbers) {
  std::string bytes;
  const auto append = [&](auto number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    bytes.append(raw, sizeof number);
  };
  (append(numbers), ...);
  return bytes;
}

}  // namespace cluxel::test
