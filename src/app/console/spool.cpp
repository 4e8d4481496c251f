// SPDX-License-Identifier: Apache-2.0
// Keeps an answer in an unnamed temporary file.
#include "app/console/spool.hpp"

#include <array>

#include "cluxel/error.hpp"

namespace cluxel::app {

Spool::Spool(bool keeps_back) : kept_(keeps_back ? std::tmpfile() : nullptr) {}

void Spool::write(std::string_view piece) {
  std::fwrite(piece.data(), 1, piece.size(), kept_ ? kept_.get() : stdout);
}

void Spool::finish() {
  if (kept_) {
    std::array<char, 65536> bytes;
    std::FILE* file = kept_.get();
    if (std::fflush(file) != 0 || std::ferror(file) != 0 || std::fseek(file, 0, SEEK_SET) != 0)
      throw Error(ErrorKind::StoreUnavailable,
                  "the answer cannot be kept in the folder for temporary files: is it full?");
    for (std::size_t count; (count = std::fread(bytes.data(), 1, bytes.size(), file)) > 0;)
      std::fwrite(bytes.data(), 1, count, stdout);
  }
  std::fflush(stdout);
}

}  // namespace cluxel::app
