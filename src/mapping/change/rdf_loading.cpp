// SPDX-License-Identifier: Apache-2.0
// Statements go from the parser to the store one by one.
#include "mapping/change/rdf_loading.hpp"

#include <optional>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/held_notes.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/map_state.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/refused_quad.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

bool isAbsent(const fs::path& file) {
  std::error_code ignored;
  return !fs::exists(file, ignored);
}
bool isEmpty(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) == 0;
}

/// A store that this run has made, perhaps of an empty file; that is as it was unless the store is kept, or somebody
/// else has written to it meanwhile.
class NewStore {
 public:
  explicit NewStore(const fs::path& file) : file_(file), is_absent_(isAbsent(file)) {
    if (is_absent_) environment_ = rdf::Environment::open(file, rdf::OpenMode::Create);
    if (!is_absent_ && isEmpty(file)) environment_ = rdf::Environment::open(file, rdf::OpenMode::Fill);
  }
  ~NewStore() {
    if (!environment_ || is_kept_) return;
    try {
      std::error_code ignored;
      {
        const rdf::WriteTransaction alone = environment_->write();
        if (rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(alone)).size() > 0) return;
        if (is_absent_) fs::remove(file_, ignored);
      }
      environment_.reset();
      if (!is_absent_) fs::resize_file(file_, 0, ignored);
      fs::remove(file_.string() + "-lock", ignored);
    } catch (const Error&) {  // somebody else has it: it stays
    }
  }
  NewStore(const NewStore&) = delete;
  NewStore& operator=(const NewStore&) = delete;
  void keep() { is_kept_ = true; }

 private:
  fs::path file_;
  bool is_absent_, is_kept_ = false;
  std::shared_ptr<rdf::Environment> environment_;
};

/// What a dry run writes to, and forgets: of a store that is not there or empty, a temporary one.
rdf::WriteTransaction triedStore(const fs::path& store, ProgressSink& sink) {
  const bool could_be_made = isAbsent(store) && fs::is_directory(fs::absolute(store).parent_path());
  if (could_be_made || isEmpty(store)) return rdf::Environment::temporary()->write();
  return writeOrCopy(store, true, sink);
}

void requireOperatorGraph(const fs::path& store, const Quad& quad) {
  if (quad.graph.text == rdf::vocabulary::kGraphOperator) return;
  throw RefusedQuad(quad, "<" + quad.subject.text + "> stands in graph <" + quad.graph.text +
                              ">, but in a map only graph <" + std::string(rdf::vocabulary::kGraphOperator) +
                              "> may be written; load into a store of its own, not " + store.string());
}

rdf::RdfSource sourceOf(const fs::path& file, const RdfLoadParams& params) {
  rdf::RdfSource source = rdf::openRdfSource(file, Term::iri(params.graph));
  if (!params.base_iri.empty()) source.base_iri = params.base_iri;
  return source;
}

std::uint64_t loadFile(const fs::path& store, const rdf::RdfSource& source, bool is_map, rdf::QuadWriter& writer) {
  if (!is_map) return loadRdf(source, writer);
  std::uint64_t count = 0;
  rdf::parseRdf(source, [&](const Quad& quad) {
    requireOperatorGraph(store, quad);
    writer.add(quad);
    ++count;
  });
  return count;
}

/// Names the file and the line that state what was refused. The files are read again.
[[noreturn]] void failAtPlace(const RefusedQuad& refused, const std::vector<fs::path>& files,
                              const RdfLoadParams& params) {
  std::error_code ignored;
  for (const fs::path& file : files) {
    if (!fs::is_regular_file(file, ignored)) continue;
    const SourceLocation place =
        rdf::placeOf(sourceOf(file, params), [&](const Quad& quad) { return refused.is(quad); });
    if (!place.file.empty()) throw InputError(place, refused.what());
  }
  throw InputError({.file = files.size() == 1 ? files.front().string() : ""}, refused.what());
}

/// What was loaded, and what follows from it.
RdfLoadReport load(rdf::WriteTransaction& transaction, const fs::path& store, const std::vector<fs::path>& files,
                   const RdfLoadParams& params, bool is_map, ProgressSink& notes) {
  const rdf::QuadReader reader(transaction);
  const std::uint64_t before = reader.size();
  const std::set<rdf::QuadIds> named_before = is_map ? quadsThatNameResources(transaction) : std::set<rdf::QuadIds>();
  RdfLoadReport report;
  report.is_map = is_map;
  rdf::QuadWriter writer(transaction);
  for (const fs::path& file : files) {
    report.statements += loadFile(store, sourceOf(file, params), is_map, writer);
    writer.flush();
  }
  report.added = reader.size() - before;
  if (is_map && report.added > 0)
    report.change = inferAfterUpdate(transaction, store, named_before, notes, {}, {.operation = "load"});
  if (is_map && !report.change.has_changes) tellMap(report.change, transaction);
  if (is_map) noteStandingQuads(transaction, named_before, notes);
  return report;
}

}  // namespace

RdfLoadReport loadRdfFiles(const fs::path& store, const std::vector<fs::path>& files, const RdfLoadParams& params,
                           ProgressSink& sink) {
  std::optional<NewStore> made;
  if (!params.dry_run) made.emplace(store);
  rdf::WriteTransaction transaction = params.dry_run ? triedStore(store, sink) : rdf::writeMap(store);
  refuseUncommittedBuild(transaction, store);
  const bool is_map = requireFinished(store, transaction);
  RdfLoadParams own = params;
  if (is_map && own.graph.empty()) own.graph = rdf::vocabulary::kGraphOperator;
  HeldNotes notes(sink);
  RdfLoadReport report;
  try {
    report = load(transaction, store, files, own, is_map, notes);
  } catch (const RefusedQuad& refused) {
    failAtPlace(refused, files, own);
  }
  if (!params.dry_run) {
    transaction.commit();
    made->keep();
  }
  notes.give();
  return report;
}

}  // namespace cluxel::mapping
