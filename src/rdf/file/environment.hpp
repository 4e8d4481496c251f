// SPDX-License-Identifier: Apache-2.0
// An LMDB environment with transactions; it holds the quads and blocks of a map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel::rdf {

/// Create: the file must not exist yet. Fill: as ReadWrite, and an empty file is accepted and becomes a map. ReadOnly
/// and ReadWrite refuse an empty file.
enum class OpenMode { ReadOnly, ReadWrite, Create, Fill };

class ReadTransaction;
class WriteTransaction;

/// Filled: all entries are written anew in the order of their keys, so that no page of the copy is half empty.
/// AsTheyAre: pages are copied as a whole, which takes about a tenth of the time.
enum class CopiedPages : std::uint8_t { Filled, AsTheyAre };

/// An open map file. A process opens a file once; opening it again returns the same environment. Thread-safe. A forked
/// child process opens it again: what its parent opened, transactions too, refuses there to read, to write and to
/// commit. Only a cursor that was open at the fork goes on, until the parent ends its transaction. Throws Error
/// (StoreUnavailable) with file and remedy: not a map, newer format, locked, disk full.
class Environment : public std::enable_shared_from_this<Environment> {
 public:
  static std::shared_ptr<Environment> open(const std::filesystem::path& file, OpenMode mode);
  /// An environment in a temporary file that is removed with it: for queries over Turtle files, and for tests.
  static std::shared_ptr<Environment> temporary();
  /// A copy of a map in a temporary file that is removed with the environment. Cost: as compactTo(), pages as they are.
  static std::shared_ptr<Environment> temporaryCopyOf(const std::filesystem::path& file);
  virtual ~Environment() = default;

  /// Opens a snapshot of the newest commit, for use by one thread at a time. Throws LockFileOutdated when the lock file
  /// does not know that commit: a map that is closed by all and opened again is read at its newest one. Cost:
  /// microseconds.
  virtual ReadTransaction read() const = 0;
  /// Starts the write transaction on the newest commit. Waits for another writer of this process. Throws MapBusy when
  /// another process writes for more than 1.5 s, or has the map open under another name as long.
  virtual WriteTransaction write() = 0;
  virtual const std::filesystem::path& file() const = 0;
  /// Writes a copy without free pages to `target`, which must not be there.
  virtual void compactTo(const std::filesystem::path& target, CopiedPages pages = CopiedPages::Filled) const = 0;
};

/// A snapshot of one commit. Also the base of a write transaction, which sees its own writes.
class ReadTransaction {
 public:
  struct Impl;
  explicit ReadTransaction(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  /// The block `key` of the block table `table`, with verified checksum. Valid until the transaction ends and, in a
  /// write transaction, until the next write. Throws Error (StoreUnavailable) when the checksum is wrong.
  std::optional<std::string_view> block(std::string_view table, std::string_view key) const;
  /// Visits the blocks whose key starts with `prefix`, in bytewise key order.
  void forEachBlock(std::string_view table, std::string_view prefix,
                    const std::function<void(std::string_view key, std::string_view bytes)>& visit) const;
  /// The number of the commit that it sees; of a write transaction, of the one that it began with.
  std::uint64_t commitNumber() const;
  Impl& impl() const { return *impl_; }

 protected:
  std::shared_ptr<Impl> impl_;
};

/// Atomic: without commit() all changes are rolled back.
class WriteTransaction : public ReadTransaction {
 public:
  using ReadTransaction::ReadTransaction;
  void putBlock(std::string_view table, std::string_view key, std::string_view bytes);
  /// False when the block holds these bytes already; then nothing is written.
  bool putIfDifferent(std::string_view table, std::string_view key, std::string_view bytes);
  /// A snapshot of the commit on which it builds.
  ReadTransaction before() const;
  bool eraseBlock(std::string_view table, std::string_view key);  ///< false when the block does not exist
  /// How many threads may sort and merge what is written; the outcome is the same. One, unless it is told.
  void useThreads(unsigned threads);
  /// Writes the pages that wait in memory to the file, where no reader sees them before the commit, and invalidates
  /// what was read through the transaction, as any write does. Blocks, and indexes that are written anew, do so by
  /// themselves when they are many. A page that changes again is written again.
  void writePages();
  /// Writes the indexes that wait in memory, as commit() does. Expects that nothing is waiting for a flush.
  void writeIndexes();
  void commit();
};

}  // namespace cluxel::rdf
