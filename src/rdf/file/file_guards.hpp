// SPDX-License-Identifier: Apache-2.0
// Preparations before LMDB opens a file: safe descriptors, temporary folders, file identity, and the locks of
// processes.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <compare>
#include <filesystem>
#include <functional>
#include <memory>
#include <utility>

namespace cluxel::rdf {

/// Owns a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }
  int release() { return std::exchange(number_, -1); }

 private:
  int number_;
};

/// A new folder that only this user can open, in the system's temporary folder or another one. It is removed with its
/// content; open descriptors keep the data.
class TemporaryFolder {
 public:
  /// When the folder cannot be made, path() is empty and errno says why.
  TemporaryFolder();
  explicit TemporaryFolder(const std::filesystem::path& parent);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  auto operator<=>(const FileIdentity&) const = default;
};
FileIdentity identityOf(int descriptor, const std::filesystem::path& file);
/// True when the path `file` refers to that file.
bool isNamed(const FileIdentity& identity, const std::filesystem::path& file);

/// Occupies the free ones of descriptors 0 to 2: a map opened as one of them would be overwritten by messages to stdout
/// or stderr.
class LowDescriptors {
 public:
  LowDescriptors();
  LowDescriptors(const LowDescriptors&) = delete;
  LowDescriptors& operator=(const LowDescriptors&) = delete;
  ~LowDescriptors();

 private:
  std::array<int, 3> taken_{-1, -1, -1};
};

/// The waiting for those who open or replace a map.
class NamePatience {
 public:
  explicit NamePatience(const std::filesystem::path& map);
  /// Pauses for a moment; throws MapBusy, which names the map, 5 s after the construction.
  void wait() const;

 private:
  std::filesystem::path map_;
  std::chrono::steady_clock::time_point end_;
};

/// A shared lock for opening a map file by its name, or an exclusive one for replacing it. Held briefly: for some
/// renames, or while LMDB opens a file and its number is compared; up to 3 s where the number is wrong. Has no effect
/// on file systems without such locks.
class NameLock {
 public:
  enum class Kind { Opening, Replacing };
  /// Waits up to 5 s for another process; throws MapBusy, which names `map`.
  NameLock(int descriptor, Kind kind, const std::filesystem::path& map);
  /// An exclusive lock, or none when another process has one.
  static std::unique_ptr<NameLock> withoutWaiting(int descriptor);
  NameLock(const NameLock&) = delete;
  NameLock& operator=(const NameLock&) = delete;
  ~NameLock();

 private:
  explicit NameLock(int descriptor) : descriptor_(descriptor) {}

  int descriptor_;
};

/// Writers exclude each other and whoever copies the map. The lock belongs to the descriptor and ends with it.
enum class WriteLock { Writing, Copying };
/// Waits up to 1.5 s; throws MapBusy.
void lockAgainstWriters(int descriptor, WriteLock kind, const std::filesystem::path& file);
/// Does not wait: false when another process holds the lock.
bool tryLockAgainstWriters(int descriptor, WriteLock kind, const std::filesystem::path& file);

/// Runs `work` while no process writes the map; false, without running it, when one does. A descriptor that can be
/// written excludes those who copy the map, too.
bool runWithoutWriters(int descriptor, const std::filesystem::path& file, const std::function<void()>& work);

/// Opening a named pipe waits for a writer, which may never come. Throws Error (StoreUnavailable) for what is neither a
/// file nor a folder, before it is opened.
void refusePipe(const std::filesystem::path& file);

}  // namespace cluxel::rdf
