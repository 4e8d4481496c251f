// SPDX-License-Identifier: Apache-2.0
// Opens maps: the process-wide table of open environments, and the checks before LMDB maps a file.
#include "rdf/file/environment.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <map>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/file/check/map_file_head.hpp"
#include "rdf/file/check/map_structure.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/forks.hpp"
#include "rdf/file/lmdb_environment.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/file/opening/lmdb_opening.hpp"
#include "rdf/file/private_copy.hpp"
#include "rdf/store/store_snapshot.hpp"
#include "rdf/terms/value_cache.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

/// The open environments of this process. LMDB's POSIX locks are lost when a process opens a file twice.
struct OpenEnvironments {
  std::recursive_mutex
      mutex;  ///< recursive, because an environment that fails to open is destroyed while the table is locked
  std::condition_variable_any closed;
  std::map<FileIdentity, std::weak_ptr<LmdbEnvironment>> entries;
  /// Private copies, by the file that was copied; the number is the commit.
  std::map<FileIdentity, std::pair<std::uint64_t, std::weak_ptr<LmdbEnvironment>>> copies;
};

/// A forked child process begins with an empty table: LMDB's registration as a reader and its locks are those of the
/// parent, and a thread that held the mutex does not exist in the child. The parent's table is never destroyed there.
OpenEnvironments& openEnvironments() {
  static auto* table = new OpenEnvironments;
  static const int registered = ::pthread_atfork(nullptr, nullptr, [] { table = new OpenEnvironments; });
  static_cast<void>(registered);
  return *table;
}

int openFile(const fs::path& file, OpenMode mode, bool& can_write) {
  refusePipe(file);
  const int creation = mode == OpenMode::Create ? O_CREAT | O_EXCL : 0;
  can_write = true;
  int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | creation, 0666);
  if (descriptor < 0 && mode == OpenMode::ReadOnly && (errno == EACCES || errno == EROFS || errno == EPERM)) {
    can_write = false;
    descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  }
  if (descriptor >= 0) return descriptor;
  if (errno == EEXIST)
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": exists already; choose another name or remove it");
  if (errno == EISDIR) throw Error(ErrorKind::StoreUnavailable, file.string() + ": is a folder, a map was expected");
  failStore(file, errno, mode == OpenMode::Create ? "create the map" : "open the map");
}

struct CheckedCommit {
  std::size_t commit = 0;
  PresentKeys keys;
};

/// Checks what LMDB reads of the current commit while a read transaction pins its pages.
CheckedCommit checkUnderSnapshot(MDB_env* handle, int descriptor, const fs::path& file, MapScope scope) {
  MDB_txn* raw = nullptr;
  checkLmdb(mdb_txn_begin(handle, nullptr, MDB_RDONLY, &raw), file, "read the map");
  const TxnHandle transaction(raw);
  return {mdb_txn_id(raw), checkMapStructure(descriptor, file, mdb_txn_id(raw), scope)};
}

/// The environment of a file that LMDB has opened.
std::shared_ptr<LmdbEnvironment> environmentOf(const fs::path& file, OpenedLmdb opened, Descriptor& descriptor,
                                               const MapFileHead& head, bool may_write) {
  const MapScope scope = may_write ? MapScope::Writing : MapScope::Reading;  // one walk for reading and writing
  CheckedCommit checked;
  if (head.file_size != 0) checked = checkUnderSnapshot(opened.handle.get(), descriptor.get(), file, scope);
  auto environment = std::make_shared<LmdbEnvironment>(file, std::move(opened), descriptor.release());
  if (may_write) environment->allowWriting();
  environment->noteStructure(checked.commit, scope == MapScope::Writing, std::move(checked.keys));
  environment->openTables();
  return environment;
}

struct stat statusOf(int descriptor, const fs::path& file) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) failStore(file, errno, "examine the map");
  return status;
}

/// An environment on a private copy of the map, or the one that was made of the same commit before.
std::shared_ptr<LmdbEnvironment> openCopy(const fs::path& file, const Descriptor& descriptor) {
  OpenEnvironments& table = openEnvironments();
  auto& [commit, known] = table.copies[identityOf(descriptor.get(), file)];
  if (auto open = known.lock(); open && commit == readMapFileHead(descriptor.get(), file).transaction) return open;
  PrivateCopy copy(file, descriptor.get());
  Descriptor bytes = copy.takeDescriptor();
  const MapFileHead head = readMapFileHead(bytes.get(), file);
  OpenedLmdb opened;
  opened.can_write = false;
  opened.handle = openLmdb(copy.file(), copy.file(), head.file_size, MDB_RDONLY | MDB_NOLOCK);
  auto environment = environmentOf(file, std::move(opened), bytes, head, false);
  environment->loseName();
  known = environment;
  commit = head.transaction;
  return environment;
}

/// An opened environment and whether others of this process may share it.
struct Opened {
  std::shared_ptr<LmdbEnvironment> environment;
  bool is_shared = true;
};

/// No environment when the file was replaced while it was being opened.
Opened openNew(const fs::path& file, Descriptor& descriptor, bool can_write, OpenMode mode, unsigned extra_flags) {
  const bool may_write = mode != OpenMode::ReadOnly;
  const MapFileHead head = readMapFileHead(descriptor.get(), file);
  if (head.file_size == 0 && mode != OpenMode::Create && mode != OpenMode::Fill)
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": is empty, a map was expected");
  OpenedLmdb opened = openLmdbByName({.file = file,
                                      .descriptor = descriptor.get(),
                                      .file_size = head.file_size,
                                      .mode = mode,
                                      .can_write = can_write,
                                      .flags = extra_flags});
  if (opened.outcome == LmdbOutcome::Renamed) return {};
  if (opened.outcome == LmdbOutcome::NeedsCopy) return {openCopy(file, descriptor), false};
  const bool is_shared = !opened.holds_writers;
  return {environmentOf(file, std::move(opened), descriptor, head, may_write), is_shared};
}

/// The environment from the process-wide table, or a new one; none when the file was replaced meanwhile.
std::shared_ptr<LmdbEnvironment> openAs(const fs::path& file, OpenMode mode, bool can_write, Descriptor& descriptor,
                                        unsigned extra_flags) {
  const FileIdentity identity = identityOf(descriptor.get(), file);
  OpenEnvironments& table = openEnvironments();
  std::unique_lock lock(table.mutex);
  for (auto entry = table.entries.find(identity); entry != table.entries.end(); entry = table.entries.find(identity)) {
    if (auto open = entry->second.lock()) {
      if (mode != OpenMode::ReadOnly) open->allowWriting();
      // Only who may write the map can put the number right.
      if (!open->canWrite() && open->isOutdated()) return openCopy(file, descriptor);
      return open;
    }
    table.closed.wait(lock);  // another thread is closing it
  }
  const Opened opened = openNew(file, descriptor, can_write, mode, extra_flags);
  if (opened.environment && opened.is_shared) table.entries[identity] = opened.environment;
  return opened.environment;
}

std::shared_ptr<LmdbEnvironment> openOnce(const fs::path& file, OpenMode mode, unsigned extra_flags) {
  const LowDescriptors low;
  constexpr int kMaxReplacements = 100;
  for (int attempt = 0; attempt < kMaxReplacements; ++attempt) {
    bool can_write = false;
    Descriptor descriptor(openFile(file, mode, can_write));
    try {
      if (auto environment = openAs(file, mode, can_write, descriptor, extra_flags)) return environment;
    } catch (...) {
      std::error_code ignored;
      if (mode == OpenMode::Create)
        for (const fs::path& made : {file, lockFileOf(file)}) fs::remove(made, ignored);
      throw;
    }
  }
  throw MapReplaced(file);
}

}  // namespace

std::shared_ptr<Environment> Environment::open(const fs::path& file, OpenMode mode) {
  // A symbolic link and its target must share one lock file.
  return openOnce(withoutLinks(fs::absolute(file)), mode, 0);
}

std::shared_ptr<Environment> Environment::temporary() {
  const TemporaryFolder folder;
  if (folder.path().empty()) failStore(temporaryFolderPath(), errno, "make a temporary map");
  auto environment = openOnce(folder.path() / "temporary.clx", OpenMode::Create, MDB_NOSYNC);
  environment->loseName();
  return environment;
}

std::shared_ptr<Environment> Environment::temporaryCopyOf(const fs::path& file) {
  const TemporaryFolder folder;
  if (folder.path().empty()) failStore(temporaryFolderPath(), errno, "make a temporary map");
  const fs::path copy = folder.path() / file.filename();
  open(file, OpenMode::ReadOnly)->compactTo(copy, CopiedPages::AsTheyAre);
  auto environment = openOnce(copy, OpenMode::ReadWrite, MDB_NOSYNC);
  environment->loseName();
  return environment;
}

LmdbEnvironment::LmdbEnvironment(fs::path file, OpenedLmdb opened, int data_lock)
    : file_(std::move(file)),
      use_(std::move(opened.use)),
      handle_(std::move(opened.handle)),
      data_lock_(data_lock),
      forks_(forkCount()),
      can_write_(opened.can_write),
      values_(std::make_unique<ValueCache>()) {
  closeInChildren(data_lock_);
}

std::uint64_t LmdbEnvironment::fileSize() const {
  refuseParents();
  return static_cast<std::uint64_t>(statusOf(data_lock_, file_).st_size);
}

std::uint64_t LmdbEnvironment::diskBytes() const {
  refuseParents();
  constexpr std::uint64_t kBlock = 512;  // of st_blocks, on every file system
  return static_cast<std::uint64_t>(statusOf(data_lock_, file_).st_blocks) * kBlock;
}

bool LmdbEnvironment::hasOtherNames() const {
  refuseParents();
  return statusOf(data_lock_, file_).st_nlink > 1;
}

bool LmdbEnvironment::punchHole(std::uint64_t begin, std::uint64_t bytes) const {
  refuseParents();
  int code = 0;
  do
    code = ::fallocate(data_lock_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(begin),
                       static_cast<off_t>(bytes));
  while (code != 0 && errno == EINTR);
  if (code == 0) return true;
  if (errno == EOPNOTSUPP || errno == ENOSYS) return false;
  failStore(file_, errno, "free space of the map");
}

bool LmdbEnvironment::isOfParent() const {
  return forks_ != forkCount();
}

void LmdbEnvironment::refuseParents() const {
  if (isOfParent())
    throw Error(ErrorKind::StoreUnavailable,
                file_.string() + ": was opened before this process was forked; open it again in this process");
}

LmdbEnvironment::~LmdbEnvironment() {
  // A process loses its own locks on a lock file with every descriptor of it that it closes. Those that hold locks of
  // the parent are closed already.
  if (isOfParent()) {
    static_cast<void>(handle_.release());
    static_cast<void>(use_.release());
    return;
  }
  struct stat status {};
  const bool known = ::fstat(data_lock_, &status) == 0;
  OpenEnvironments& table = openEnvironments();
  // The table stays locked until LMDB has closed the file, so that no thread opens it in between.
  const std::lock_guard lock(table.mutex);
  handle_.reset();
  use_.reset();
  keepInChildren(data_lock_);
  ::close(data_lock_);
  if (!known) return;
  const auto entry = table.entries.find({status.st_dev, status.st_ino});
  if (entry != table.entries.end() && entry->second.expired()) table.entries.erase(entry);
  table.closed.notify_all();
}

}  // namespace cluxel::rdf
