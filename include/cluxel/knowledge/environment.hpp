// SPDX-License-Identifier: Apache-2.0
// One LMDB file as an environment with transactions; the map's quads and blocks live in it side by side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel {

enum class OpenMode { ReadOnly, ReadWrite, Create };  ///< Create: the file must not exist yet

class ReadTransaction;
class WriteTransaction;

/// An open map file. One process opens a file once: opening it again gives the same environment. Thread-safe.
/// Errors: Error (StoreUnavailable) naming the file and the remedy: not a map, newer format, locked, disk full.
class Environment : public std::enable_shared_from_this<Environment> {
 public:
  static std::shared_ptr<Environment> open(const std::filesystem::path& file, OpenMode mode);
  /// An environment in a temporary file that vanishes with it: for queries over Turtle files, and for tests.
  static std::shared_ptr<Environment> temporary();
  virtual ~Environment() = default;

  /// A snapshot; one thread at a time may use it. Cost: microseconds.
  virtual ReadTransaction read() const = 0;
  /// The one writer; waits for another writer of this process, errors when another process writes.
  virtual WriteTransaction write() = 0;
  virtual const std::filesystem::path& file() const = 0;
  /// Writes a compact copy to `target`.
  virtual void compactTo(const std::filesystem::path& target) const = 0;
};

/// A consistent view of the environment at one commit. Also the base of a write transaction, which sees its own writes.
class ReadTransaction {
 public:
  struct Impl;
  explicit ReadTransaction(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}
  /// The bytes stored under `key` in the block table `table`, with their checksum verified; valid while the transaction
  /// lives and, in a write transaction, until the next write. Throws Error (StoreUnavailable) when the checksum is
  /// wrong.
  std::optional<std::string_view> block(std::string_view table, std::string_view key) const;
  /// Visits the blocks whose key begins with `prefix`, in byte order of keys.
  void forEachBlock(std::string_view table, std::string_view prefix,
                    const std::function<void(std::string_view key, std::string_view bytes)>& visit) const;
  Impl& impl() const { return *impl_; }

 protected:
  std::shared_ptr<Impl> impl_;
};

/// All or nothing: without commit() nothing is kept.
class WriteTransaction : public ReadTransaction {
 public:
  using ReadTransaction::ReadTransaction;
  void putBlock(std::string_view table, std::string_view key, std::string_view bytes);
  bool eraseBlock(std::string_view table, std::string_view key);  ///< false when there was none
  void commit();
};

}  // namespace cluxel
