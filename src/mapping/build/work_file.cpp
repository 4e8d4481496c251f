// SPDX-License-Identifier: Apache-2.0
// Selects the file of a build and replaces the map by it.
#include "mapping/build/work_file.hpp"

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/statements/statement.hpp"
#include "mapping/statements/statement_history.hpp"
#include "rdf/file/map_check.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// How long a finished build waits for an update of the old map to end.
constexpr auto kPatience = std::chrono::minutes(10);

struct Found {
  enum class Kind { Nothing, Empty /* or killed before its first commit */, Build, OtherStore } kind = Kind::Nothing;
  std::optional<MapState> state = std::nullopt;  ///< of Build

  bool isNothing() const { return kind == Kind::Nothing || kind == Kind::Empty; }
  bool isFinished() const { return state && state->is_finished; }
};

bool holdsNothing(const rdf::ReadTransaction& transaction) {
  bool has_blocks = false;
  for (const std::string_view table : {tables::kMeta, tables::kScans})
    transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view) {
      const bool is_of_grid = key == tables::kGridKey || key == tables::kHeightsKey;  // early commits keep these
      has_blocks = has_blocks || table != tables::kMeta || !is_of_grid;
    });
  const rdf::QuadReader quads(transaction);
  return !has_blocks && quads.size() == 0 && quads.termCount() == 0;
}

Found lookAt(const fs::path& file) {
  using enum Found::Kind;
  std::error_code ignored;
  if (!mayBeThere(file)) return {};
  if (fs::is_directory(file, ignored))
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": is a folder, a map was expected");
  if (fs::is_regular_file(file, ignored) && (fs::file_size(file) == 0 || rdf::hasNoCommit(file))) return {Empty};
  const rdf::ReadTransaction transaction = rdf::Environment::open(file, rdf::OpenMode::ReadOnly)->read();
  if (const auto state = storedState(transaction)) return {Build, state};
  return {holdsNothing(transaction) ? Empty : OtherStore};
}

/// An unfinished build is continued only with the same inputs.
void requireSameInputs(const Found& found, const fs::path& file, const std::string& inputs_hash) {
  if (found.kind == Found::Kind::OtherStore)
    throw Error(ErrorKind::InvalidArgument, file.string() + ": is a store that no build has made; move it away");
  if (found.state && found.state->inputs_hash != inputs_hash)
    throw Error(ErrorKind::InvalidArgument,
                file.string() + ": holds " + (found.isFinished() ? "a" : "an unfinished") +
                    " build with another model, rules, ontology or version of Cluxel; repeat that command "
                    "to finish it, or remove the file");
}

void removeMap(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
  fs::remove(file.string() + "-lock", ignored);
}

}  // namespace

void refuseUncommittedBuild(const rdf::ReadTransaction& transaction, const fs::path& file) {
  if (!holdsNothing(transaction)) return;
  if (!hasBuildLock(withoutLinks(file)) && !hasEarlyCommit(transaction)) return;
  throw Error(ErrorKind::StoreUnavailable,
              file.string() +
                  ": holds nothing: the first build of it is running, or was killed before its first "
                  "commit; wait for it, or repeat the command");
}

bool hasBuildToDo(const fs::path& map) {
  const Found found = lookAt(withoutLinks(map));
  return found.isNothing() || (found.state && !found.isFinished());
}

WorkFile::WorkFile(const fs::path& map, const std::string& inputs_hash, bool force)
    : target_(withoutLinks(map)), lock_(target_) {
  chooseBetween(inputs_hash, force);
  const Found found = lookAt(path_);
  requireSameInputs(found, path_, inputs_hash);
  const auto mode = found.kind == Found::Kind::Nothing ? rdf::OpenMode::Create : rdf::OpenMode::Fill;
  environment_ = rdf::Environment::open(path_, mode);
  found_ = found.state;
}

void WorkFile::chooseBetween(const std::string& inputs_hash, bool force) {
  const fs::path beside = target_.string() + ".building";
  const Found there = lookAt(target_);
  path_ = target_;
  if (there.kind == Found::Kind::OtherStore || there.isFinished()) {
    if (!force)
      throw Error(
          ErrorKind::InvalidArgument,
          target_.string() + (there.isFinished() ? ": is a finished map" : ": is a store that no build has made"),
          Remedy::ReplaceMap);
    path_ = beside;
    replaces_ = true;
    return;
  }
  const Found stranded = lookAt(beside);
  if (!there.isNothing() || stranded.isNothing()) return;
  if (stranded.state && stranded.state->inputs_hash == inputs_hash)
    path_ = beside;  // the map to be replaced is gone: this file becomes the map
  else
    throw Error(ErrorKind::InvalidArgument,
                beside.string() +
                    ": is the result of another build, perhaps unfinished, and the map that it should replace no "
                    "longer exists; rename it, or remove it if it is not needed");
}

WorkFile::~WorkFile() {
  bool is_unused = false;
  try {
    is_unused = environment_ && !found_ && holdsNothing(environment_->read());
  } catch (const Error&) {
    // An unreadable file is kept for `cluxel doctor`.
  }
  environment_.reset();
  if (is_unused) removeMap(path_);
}

void WorkFile::reopen() {
  environment_.reset();
  environment_ = rdf::Environment::open(path_, rdf::OpenMode::ReadWrite);
}

void WorkFile::takeOverStatements(rdf::WriteTransaction& into, bool drop, ProgressSink& sink) {
  if (replaces_) {
    replaced_ = rdf::writeMap(target_, kPatience);
  } else if (!drop || path_ == target_) {
    return;
  }
  clearOperatorStatements(into);
  if (drop) return;
  const rdf::QuadReader old(static_cast<const rdf::ReadTransaction&>(*replaced_));
  copyStatementHistory(old, into);
  if (const std::uint64_t quads = copyOperatorStatements(old, into); quads > 0)
    sink.note("kept of the old map: " + std::to_string(quads) + (quads == 1 ? " quad" : " quads") +
              " of the operator's graph; statements about objects among them: " +
              std::to_string(storedStatements(old).size()));
}

void WorkFile::finish() {
  environment_.reset();
  if (path_ == target_) return;
  if (!replaces_ && !lookAt(target_).isNothing())
    throw Error(ErrorKind::StoreUnavailable, path_.string() + ": is finished, but meanwhile there is a map at " +
                                                 target_.string() + "; move one of them away");
  rdf::replaceMapFile(path_, target_);
  replaced_.reset();
}

}  // namespace cluxel::mapping
