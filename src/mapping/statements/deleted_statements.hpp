// SPDX-License-Identifier: Apache-2.0
// What an update inserts about an object becomes a statement; here what it deletes withdraws the statement.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/statements/known_objects.hpp"
#include "mapping/statements/statement.hpp"

namespace cluxel::mapping {

class DeletedStatements {
 public:
  /// `transaction`: before the update. A statement that is malformed, which the update may mend, does not count.
  explicit DeletedStatements(const rdf::ReadTransaction& transaction);

  /// Notes which statements say what a quad says that the update deletes from graph `operator`. It need not be there.
  void add(const Quad& quad);
  /// Removes the statements noted of quads that are not in graph `operator` after the update, notes how many they are,
  /// and returns that.
  std::size_t withdraw(rdf::WriteTransaction& transaction, ProgressSink& sink) const;

  /// Where a triple comes from that the map says because of a statement, and how to delete it; empty when it does not.
  std::string remedyFor(const Quad& triple);

 private:
  using ByObject = std::map<std::string, std::vector<ContentHash>>;  ///< by the IRI of what they apply to
  /// Statements that say the same.
  struct Saying {
    std::vector<ContentHash> statements;
    std::optional<ByObject> by_object;  ///< once it is needed
  };

  const ByObject& byObject(Saying& saying) const;
  /// The statements of this about the object that the subject means now. Reads each statement once, however many quads
  /// are deleted.
  std::vector<ContentHash> thatSay(const Quad& triple);

  const rdf::ReadTransaction& transaction_;
  std::map<std::pair<std::string, Term>, Saying> saying_;  ///< by property and value
  std::optional<KnownObjects> known_;                      ///< once it is needed
  std::vector<std::pair<Quad, ContentHash>> deleted_;
};

}  // namespace cluxel::mapping
