// SPDX-License-Identifier: Apache-2.0
// Reading and atomic writing of whole files.
#include "cluxel/base/file_bytes.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError({.file = path.string()}, what + ": " + std::strerror(errno));
}

}  // namespace

std::string readFile(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
    throw InputError({.file = path.string()}, "is a folder, a file was expected");
  const File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) refuse(path, "cannot be opened");
  std::string bytes;
  const auto size = fs::file_size(path, ignored);
  if (!ignored) bytes.reserve(size);
  char buffer[1 << 16];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file.get())) bytes.append(buffer, count);
  if (std::ferror(file.get())) refuse(path, "cannot be read");
  return bytes;
}

void writeFile(const fs::path& path, std::string_view bytes) {
  fs::path partial = path;
  partial += ".partial";
  File file(std::fopen(partial.c_str(), "wb"), &std::fclose);
  const auto fail = [&](const std::string& what) {
    const std::string reason = std::strerror(errno);
    std::remove(partial.c_str());
    throw Error(ExitCode::StoreUnavailable, path.string() + ": " + what + ": " + reason);
  };
  if (!file) fail("cannot be written");
  const bool whole = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  if (!whole || std::fflush(file.get()) != 0) fail("cannot be written whole");
  file.reset();
  std::error_code error;
  fs::rename(partial, path, error);
  if (error) {
    errno = error.value();
    fail("cannot be moved into place");
  }
}

}  // namespace cluxel
