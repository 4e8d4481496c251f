// SPDX-License-Identifier: Apache-2.0
// Reading and atomic writing of whole files.
#include "base/file_bytes.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <utility>

#include "base/file_pieces.hpp"
#include "cluxel/error.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError({.file = path.string()}, what + ": " + std::strerror(errno));
}

[[noreturn]] void refuseToWrite(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::StoreUnavailable, path.string() + ": " + what + ": " + std::strerror(errno));
}

/// A file that is being written. It has no name until it is whole, where the system can do that; else its name is taken
/// away again unless it was moved into place.
class WrittenFile {
 public:
  /// `meant`: the file that the user named, for messages.
  explicit WrittenFile(const fs::path& meant) : meant_(meant) {}
  WrittenFile(const WrittenFile&) = delete;
  WrittenFile& operator=(const WrittenFile&) = delete;
  ~WrittenFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!partial_.empty()) ::unlink(partial_.c_str());
  }

  /// Opens what is there and cannot be replaced: a pipe, a device.
  void openInPlace() {
    descriptor_ = ::open(meant_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) refuseToWrite(meant_, "cannot be written");
  }

  /// Makes a new file beside `target`. A process that is killed leaves nothing of one without a name.
  void openBeside(const fs::path& target) {
    target_ = target;
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (::access("/proc/self/fd", X_OK) == 0)  // names are given by it
      descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
    is_nameless_ = descriptor_ >= 0;
    if (!is_nameless_)
      withNewName([&](const std::string& name) {
        descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        return descriptor_ >= 0;
      });
    struct stat old {};
    if (::stat(target.c_str(), &old) == 0) (void)!::fchmod(descriptor_, old.st_mode & 07777U);
  }

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) refuseToWrite(meant_, "cannot be written whole");
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  /// What the disk refuses late shows here. Pipes and some file systems cannot be synchronised.
  void close() {
    if (!target_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS && errno != EOPNOTSUPP)
      refuseToWrite(meant_, "cannot be written whole");
    if (is_nameless_)
      withNewName([&](const std::string& name) {
        const std::string open_file = "/proc/self/fd/" + std::to_string(descriptor_);
        return ::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
      });
    if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR)
      refuseToWrite(meant_, "cannot be written whole");
  }

  void moveTo(const fs::path& target) {
    if (std::rename(partial_.c_str(), target.c_str()) != 0) refuseToWrite(meant_, "cannot be moved into place");
    partial_.clear();
    syncFolderOf(target);
  }

 private:
  /// Tries names beside the target until one is new. `make` returns false with errno.
  template <typename Make>
  void withNewName(const Make& make) {
    static std::atomic<unsigned> count{0};
    for (int attempt = 0; attempt < 1000; ++attempt) {
      const std::string name =
          target_.string() + ".partial-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
      if (make(name)) {
        partial_ = name;
        return;
      }
      if (errno != EEXIST) break;
    }
    refuseToWrite(meant_, "cannot be written");
  }

  const fs::path& meant_;
  fs::path target_;   ///< beside which it is written
  fs::path partial_;  ///< its name until it is moved
  bool is_nameless_ = false;
  int descriptor_ = -1;
};

/// Whether `path` leads to a pipe, a device or the like, which a file may not take the place of.
bool isSpecial(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// A named pipe without a writer waits for ever; one that the shell has opened ends.
bool isOpenedByShell(const fs::path& path) {
  const std::string name = path.string();
  return name == "/dev/stdin" || name.starts_with("/dev/fd/") || name.starts_with("/proc/self/fd/");
}

File opened(const fs::path& path) {
  std::error_code ignored;
  if (isSpecial(path) && !isOpenedByShell(path))
    throw InputError({.file = path.string()}, "is a pipe or a device, a file was expected",
                     "write its data to a file first");
  if (fs::is_directory(path, ignored)) throw InputError({.file = path.string()}, "is a folder, a file was expected");
  File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) refuse(path, "cannot be opened");
  return file;
}

}  // namespace

fs::path withoutLinks(fs::path path) {
  constexpr int kMaxLinks = 40;  // as many as the system follows
  std::error_code error;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / target;  // an absolute target replaces all
  }
  return path;
}

std::filesystem::path temporaryFolderPath() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (!error) return folder;
  const char* named = std::getenv("TMPDIR");
  throw Error(ErrorKind::StoreUnavailable, std::string(named != nullptr ? named : "/tmp") +
                                               ": the folder for temporary files cannot be used (" + error.message() +
                                               "); set TMPDIR to a folder that you may write");
}

void syncFolderOf(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

std::string readFile(const fs::path& path) {
  std::error_code ignored;
  const File file = opened(path);
  std::string bytes;
  const auto size = fs::file_size(path, ignored);
  if (!ignored) bytes.reserve(size);
  char buffer[1 << 16];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file.get())) bytes.append(buffer, count);
  if (std::ferror(file.get())) refuse(path, "cannot be read");
  return bytes;
}

std::string readBeginning(const fs::path& path, std::size_t count) {
  const File file = opened(path);
  std::string bytes(count, '\0');
  bytes.resize(std::fread(bytes.data(), 1, count, file.get()));
  if (std::ferror(file.get())) refuse(path, "cannot be read");
  return bytes;
}

bool mayBeThere(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) || !fs::status_known(status);
}

std::vector<fs::path> filesIn(const fs::path& folder, const std::vector<std::string_view>& endings) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (std::any_of(endings.begin(), endings.end(), [&](std::string_view ending) { return name.ends_with(ending); }))
      files.push_back(entry->path());
  }
  if (error) throw InputError({.file = folder.string()}, "the folder cannot be read: " + error.message());
  std::sort(files.begin(), files.end());
  return files;
}

void writeFile(const fs::path& path, std::string_view bytes) {
  writeFileInPieces(path, [bytes](const auto& take) { take(bytes); });
}

void writeFileInPieces(const fs::path& path,
                       const std::function<void(const std::function<void(std::string_view)>& take)>& fill) {
  constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;
  WrittenFile file(path);
  const bool is_special = isSpecial(path);
  const fs::path target = withoutLinks(path);
  if (is_special)
    file.openInPlace();
  else
    file.openBeside(target);
  std::string buffer;
  fill([&](std::string_view piece) {
    if (buffer.size() + piece.size() > kBufferBytes) {
      file.write(buffer);
      buffer.clear();
    }
    if (piece.size() >= kBufferBytes)
      file.write(piece);
    else
      buffer.append(piece);
  });
  file.write(buffer);
  file.close();
  if (!is_special) file.moveTo(target);
}

}  // namespace cluxel
