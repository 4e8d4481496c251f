// SPDX-License-Identifier: Apache-2.0
// Statements go from the parser to the store one by one.
#include "mapping/change/rdf_loading.hpp"

#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/map_state.hpp"
#include "mapping/statements/named_resources.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// A store that this run has made, perhaps of an empty file; that is as it was unless the store is kept.
class NewStore {
 public:
  explicit NewStore(const fs::path& file) : file_(file), is_absent_(isAbsent(file)) {
    if (is_absent_) environment_ = rdf::Environment::open(file, rdf::OpenMode::Create);
    if (!is_absent_ && isEmpty(file)) environment_ = rdf::Environment::open(file, rdf::OpenMode::Fill);
  }
  ~NewStore() {
    if (!environment_ || is_kept_) return;
    environment_.reset();
    std::error_code ignored;
    if (is_absent_)
      fs::remove(file_, ignored);
    else
      fs::resize_file(file_, 0, ignored);
    fs::remove(file_.string() + "-lock", ignored);
  }
  NewStore(const NewStore&) = delete;
  NewStore& operator=(const NewStore&) = delete;
  void keep() { is_kept_ = true; }

 private:
  static bool isAbsent(const fs::path& file) {
    std::error_code ignored;
    return !fs::exists(file, ignored);
  }
  static bool isEmpty(const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) == 0;
  }

  fs::path file_;
  bool is_absent_, is_kept_ = false;
  std::shared_ptr<rdf::Environment> environment_;
};

void requireOperatorGraph(const fs::path& store, const fs::path& file, const std::string& graph) {
  if (graph == rdf::vocabulary::kGraphOperator) return;
  throw Error(ErrorKind::InvalidArgument, file.string() + ": has statements of graph <" + graph +
                                              ">, but in a map only graph <" +
                                              std::string(rdf::vocabulary::kGraphOperator) +
                                              "> may be written; load into a store of its own, not " + store.string());
}

std::uint64_t loadFile(const fs::path& store, const fs::path& file, const RdfLoadParams& params, bool is_map,
                       rdf::QuadWriter& writer) {
  rdf::RdfSource source = rdf::openRdfSource(file, Term::iri(params.graph));
  if (!params.base_iri.empty()) source.base_iri = params.base_iri;
  if (!is_map) return loadRdf(source, writer);
  std::uint64_t count = 0;
  rdf::parseRdf(source, [&](const Quad& quad) {
    requireOperatorGraph(store, file, quad.graph.text);
    writer.add(quad);
    ++count;
  });
  return count;
}

}  // namespace

RdfLoadReport loadRdfFiles(const fs::path& store, const std::vector<fs::path>& files, const RdfLoadParams& params,
                           ProgressSink& sink) {
  NewStore made(store);
  rdf::WriteTransaction transaction = rdf::writeMap(store);
  refuseUncommittedBuild(transaction, store);
  const bool is_map = requireFinished(store, transaction);
  RdfLoadParams own = params;
  if (is_map && own.graph.empty()) own.graph = rdf::vocabulary::kGraphOperator;
  const rdf::QuadReader reader(transaction);
  const std::uint64_t before = reader.size();
  const std::set<rdf::QuadIds> named_before = is_map ? quadsThatNameResources(transaction) : std::set<rdf::QuadIds>();
  RdfLoadReport report;
  rdf::QuadWriter writer(transaction);
  for (const fs::path& file : files) {
    report.statements += loadFile(store, file, own, is_map, writer);
    writer.flush();
  }
  report.added = reader.size() - before;
  if (is_map && report.added > 0) inferAfterUpdate(transaction, named_before, sink, {}, {.operation = "load"});
  if (is_map) noteStandingQuads(transaction, named_before, sink);
  transaction.commit();
  made.keep();
  return report;
}

}  // namespace cluxel::mapping
