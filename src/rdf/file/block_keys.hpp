// SPDX-License-Identifier: Apache-2.0
// The number and a hash of all keys of each block table. A block has a checksum, which cannot tell that a block is
// gone.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

/// Independent of the order of keys; hashes add up modulo 2^64.
struct KeySum {
  std::uint64_t count = 0, hash = 0;
  bool operator==(const KeySum&) const = default;
  void add(std::string_view full_key);
  void remove(std::string_view full_key);
};

/// The keys of all block tables of a commit, as they are in the file.
struct PresentKeys {
  std::map<std::string, KeySum, std::less<>> of_table;
  bool in_order = true;  ///< so that each key is found

  void add(std::string_view full_key);
};

/// The key sums of one transaction. They are stored in the main database, one record a table.
class BlockKeys {
 public:
  /// To be called before a write transaction adds or removes a block.
  void noteAdded(const ReadTransaction::Impl& transaction, std::string_view table, std::string_view full_key);
  void noteRemoved(const ReadTransaction::Impl& transaction, std::string_view table, std::string_view full_key);
  /// Writes the sums that have changed.
  void store(const ReadTransaction::Impl& transaction) const;
  /// Compares the keys of a table with its sum, and looks up each key. Done once in a transaction. Skipped for tables
  /// that the transaction has changed, and for maps of earlier versions, which have no sums. Throws Error
  /// (StoreUnavailable). Cost: about 1 us a key, unless LmdbEnvironment::presentKeys() knows them.
  void verify(const ReadTransaction::Impl& transaction, std::string_view table);
  /// What this transaction made of the keys of the commit before.
  PresentKeys after(PresentKeys before) const;
  /// The tables that have a sum.
  static std::vector<std::string> tablesOf(const ReadTransaction::Impl& transaction);

 private:
  struct Table {
    KeySum sum, before;  ///< before: when the transaction changed it first
    bool is_changed = false, is_verified = false;
  };
  Table& changed(const ReadTransaction::Impl& transaction, std::string_view table);

  std::map<std::string, Table, std::less<>> tables_;
};

}  // namespace cluxel::rdf
