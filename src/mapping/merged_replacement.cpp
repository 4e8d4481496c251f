// SPDX-License-Identifier: Apache-2.0
// The result of hours is not dropped because another process has the target for a moment, and what operators stated in
// the target is lost only when the caller says so: nothing can compute it again.
#include "mapping/merged_replacement.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>

#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/statements/statement_history.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

bool holdsNothing(const fs::path& target) {
  return !fs::exists(target) || fs::is_empty(target);
}

std::set<std::string> textsWithout(const std::set<std::string>& withdrawn, const rdf::QuadReader& map) {
  std::vector<Quad> quads = operatorStatements(map);
  std::erase_if(quads, [&](const Quad& quad) { return withdrawn.contains(quad.subject.text); });
  return canonicalTextsOf(quads);
}

/// Whether operators stated or withdrew something in `old` that the maps together do not know.
bool isMoreStatedIn(const rdf::QuadReader& old, const std::vector<const rdf::QuadReader*>& maps) {
  std::vector<const rdf::QuadReader*> all = maps;
  all.push_back(&old);
  const std::vector<ContentHash> ends = withdrawnAmong(maps), all_ends = withdrawnAmong(all);
  std::set<std::string> withdrawn, texts;
  for (const ContentHash& id : all_ends) withdrawn.insert(rdf::iriOfStatement(id));
  for (const rdf::QuadReader* map : maps) {
    for (const Statement& statement : storedStatements(*map)) {
      const bool is_ended = std::binary_search(all_ends.begin(), all_ends.end(), statement.id());
      if (is_ended && !std::binary_search(ends.begin(), ends.end(), statement.id())) return true;
    }
    texts.merge(textsWithout(withdrawn, *map));
  }
  const std::set<std::string> own = textsWithout(withdrawn, old);
  return !std::includes(texts.begin(), texts.end(), own.begin(), own.end());
}

[[noreturn]] void refuseToDropStatements(const fs::path& target) {
  throw Error(ErrorKind::InvalidArgument,
              target.string() +
                  ": has operator statements, or withdrawals, that the maps to be merged do not have; they would be "
                  "lost. Merge it, too, into another file to keep them",
              Remedy::DropStatements);
}

void replaceNow(const fs::path& merged, const fs::path& target, bool drop_statements, ProgressSink& sink) {
  if (holdsNothing(target)) return rdf::replaceMapFile(merged, target);
  const rdf::WriteTransaction old = rdf::writeMap(target);
  bool is_more_stated = false;
  {
    const auto environment = rdf::Environment::open(merged, rdf::OpenMode::ReadOnly);
    const rdf::ReadTransaction transaction = environment->read();
    const rdf::QuadReader result(transaction);
    is_more_stated = isMoreStatedIn(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(old)), {&result});
  }
  if (is_more_stated && !drop_statements) refuseToDropStatements(target);
  rdf::replaceMapFile(merged, target);
  if (is_more_stated) sink.note(target.string() + ": is replaced; operator statements that only it had are dropped");
}

}  // namespace

void requireMapOrNothing(const fs::path& target) {
  if (fs::is_directory(target))
    throw Error(ErrorKind::StoreUnavailable, target.string() + ": is a folder, a map was expected");
  if (!holdsNothing(target)) rdf::Environment::open(target, rdf::OpenMode::ReadOnly);
}

void requireStatementsKept(const fs::path& target, const std::vector<const rdf::QuadReader*>& maps) {
  if (holdsNothing(target)) return;
  const auto environment = rdf::Environment::open(target, rdf::OpenMode::ReadOnly);
  const rdf::ReadTransaction transaction = environment->read();
  if (isMoreStatedIn(rdf::QuadReader(transaction), maps)) refuseToDropStatements(target);
}

void replaceByMerged(const fs::path& merged, const fs::path& target, bool drop_statements, ProgressSink& sink) {
  constexpr auto kPatience = std::chrono::minutes(10);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (bool is_told = false;; is_told = true) {
    try {
      return replaceNow(merged, target, drop_statements, sink);
    } catch (const rdf::MapBusy&) {
      if (std::chrono::steady_clock::now() >= deadline) throw;
      if (!is_told)
        sink.note(target.string() +
                  ": another process writes, copies or opens it; the merged map takes its place when that has ended, "
                  "or is dropped after 10 minutes");
    }
  }
}

}  // namespace cluxel::mapping
