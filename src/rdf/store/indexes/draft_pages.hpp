// SPDX-License-Identifier: Apache-2.0
// Memory for the pages of an index that is being drafted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "rdf/file/file_guards.hpp"

namespace cluxel::rdf {

/// Pages of 4 KiB. The first 16 MiB are anonymous memory. The others lie in a file without a name: the kernel writes it
/// out like any other file, and it is gone when the process ends.
class DraftPages {
 public:
  static constexpr std::size_t kPageBytes = 4096;

  /// The file is made in `folder` when it is needed, or in the folder for temporary files when `folder` cannot be
  /// written. Where neither works, all pages are anonymous memory.
  explicit DraftPages(std::filesystem::path folder) : folder_(std::move(folder)) {}
  DraftPages(const DraftPages&) = delete;
  DraftPages& operator=(const DraftPages&) = delete;
  ~DraftPages();

  /// Its bytes are not set. Throws Error (StoreUnavailable) when the disk is full.
  std::uint8_t* take();
  void giveBack(std::uint8_t* page) { free_.push_back(page); }
  /// Of all pages, taken or not.
  std::size_t bytes() const;

 private:
  void addChunk();
  void openFile();
  void* mapOfFile();

  std::filesystem::path folder_;
  Descriptor file_;  ///< none as long as it is not needed, or when none could be made
  std::vector<void*> chunks_;
  std::vector<std::uint8_t*> free_;  ///< the last one is taken next
};

}  // namespace cluxel::rdf
