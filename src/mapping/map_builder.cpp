// SPDX-License-Identifier: Apache-2.0
// Batches of scans into a map file; each batch is one transaction from points to facts.
#include "cluxel/mapping/map_builder.hpp"

#include <chrono>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "mapping/map_history.hpp"
#include "mapping/map_state.hpp"
#include "mapping/operator_statements.hpp"
#include "mapping/scan_store.hpp"
#include "mapping/semantic_layer.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

double nowSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void removeMap(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
  fs::remove(file.string() + "-lock", ignored);
}

/// The file to work in. A finished map that is replaced stays until the new one is finished.
struct WorkFile {
  fs::path path, target;
  std::shared_ptr<Environment> environment;
  bool is_fresh = false;

  void finish() {
    environment.reset();
    if (path == target) return;
    removeMap(target);
    fs::rename(path, target);
    removeMap(path);
  }
};

std::optional<MapState> stateOf(const fs::path& file) {
  return storedState(Environment::open(file, OpenMode::ReadOnly)->read());
}

/// Whether `file` holds an unfinished build of the same inputs. An unfinished build of others is an error.
bool isOwnUnfinished(const fs::path& file, const std::string& inputs_hash) {
  const auto state = stateOf(file);
  if (!state) return true;
  if (state->is_finished) return false;
  if (state->inputs_hash == inputs_hash) return true;
  throw Error(ExitCode::Usage, file.string() + ": holds an unfinished build with another model, rules or ontology; " +
                                   "repeat that command to finish it, or remove the file");
}

WorkFile openWorkFile(const fs::path& target, const std::string& inputs_hash, bool force) {
  WorkFile work;
  work.path = work.target = target;
  if (fs::exists(target) && !isOwnUnfinished(target, inputs_hash)) {
    if (!force)
      throw Error(ExitCode::Usage, target.string() + ": is a finished map; --force replaces it");
    work.path += ".building";
    if (fs::exists(work.path) && !isOwnUnfinished(work.path, inputs_hash)) removeMap(work.path);
  }
  work.is_fresh = !fs::exists(work.path);
  work.environment = Environment::open(work.path, work.is_fresh ? OpenMode::Create : OpenMode::ReadWrite);
  return work;
}

/// Takes the operator's statements of the map that is replaced over into its successor.
void keepStatements(const WorkFile& work, ProgressSink& sink) {
  const auto replaced = Environment::open(work.target, OpenMode::ReadOnly);
  WriteTransaction transaction = work.environment->write();
  const std::uint64_t count = copyOperatorStatements(QuadReader(replaced->read()), transaction);
  transaction.commit();
  if (count > 0)
    sink.note(std::to_string(count) + " operator statements of the old map are kept; --drop-statements leaves them out");
}

class MapBuild {
 public:
  MapBuild(const ScanSet& scans, const ParsedInputs& parsed, Environment& environment, const BuildParams& params,
           ProgressSink& sink)
      : scans_(scans), parsed_(parsed), environment_(environment), params_(params), sink_(sink),
        stages_(parsed.model, parsed.inputs.params) {}

  BuildReport run() {
    for (std::size_t next = 0; next < scans_.size();) next = addBatch(next);
    return report_;
  }

 private:
  /// Adds scans from `first` on until the batch is full, and commits; returns the first scan of the next batch.
  std::size_t addBatch(std::size_t first) {
    const double started_s = nowSeconds();
    WriteTransaction transaction = environment_.write();
    TileSet touched;
    std::uint64_t batch_points = 0;
    std::size_t next = first;
    for (; next < scans_.size() && batch_points < params_.batch_points; ++next) {
      const Scan scan = scans_.load(next);
      const TileSet tiles = storeScan(transaction, scan);
      report_.scans_already_there += tiles.empty() ? 1 : 0;
      batch_points += tiles.empty() ? 0 : scan.points.size();
      touched = unionOf(std::move(touched), tiles);
      sink_.progress("scans", next + 1, scans_.size());
    }
    if (!touched.empty() || next == scans_.size()) commitBatch(transaction, touched, next == scans_.size(), started_s);
    return next;
  }

  void commitBatch(WriteTransaction& transaction, const TileSet& touched, bool is_last, double started_s) {
    stages_.update(transaction, touched, params_.threads, sink_);
    stages_.loadAll(transaction);
    const SemanticCounts counts = writeSemanticLayer(transaction, parsed_, stages_, sink_);
    const std::vector<Cloud> clouds = storedClouds(transaction);
    storeInputs(transaction, parsed_.inputs);
    storeState(transaction, {is_last, parsed_.inputs.hash().hex()});
    addBuildActivity(transaction, clouds, parsed_.inputs, started_s, nowSeconds());
    transaction.commit();
    report_.scans = clouds.size();
    report_.points = 0;
    for (const Cloud& cloud : clouds) report_.points += cloud.point_count;
    report_.tiles = stages_.points().size();
    report_.cluxels = counts.cluxels, report_.primitives = counts.primitives, report_.objects = counts.objects;
    report_.quads = QuadReader(environment_.read()).size();
  }

  const ScanSet& scans_;
  const ParsedInputs& parsed_;
  Environment& environment_;
  const BuildParams& params_;
  ProgressSink& sink_;
  TileStages stages_;
  BuildReport report_;
};

}  // namespace

BuildReport buildMap(const ScanSet& scans, const MapInputs& inputs, const fs::path& file, const BuildParams& params,
                     ProgressSink& sink) {
  if (scans.size() == 0) throw Error(ExitCode::Usage, "there is no scan to build a map from");
  MapInputs complete = inputs;
  complete.map_origin = scans.mapOrigin();
  complete.crs = scans.crs();
  const ParsedInputs parsed = parseInputs(complete);
  WorkFile work = openWorkFile(file, complete.hash().hex(), params.force);
  try {
    if (work.path != work.target && !params.drop_statements) keepStatements(work, sink);
    const BuildReport report = MapBuild(scans, parsed, *work.environment, params, sink).run();
    work.finish();
    return report;
  } catch (...) {
    const bool is_empty = !storedState(work.environment->read());
    work.environment.reset();
    if (work.is_fresh && is_empty) removeMap(work.path);
    throw;
  }
}

}  // namespace cluxel
