// SPDX-License-Identifier: Apache-2.0
// The facade over mapping, SPARQL and tasks: opens the newest state for each call and hands values out.
#include "cluxel/map.hpp"

#include <algorithm>
#include <optional>

#include "api/answer_data.hpp"
#include "api/change_values.hpp"
#include "api/map_impl.hpp"
#include "api/object_query.hpp"
#include "api/point_query.hpp"
#include "base/installation/data_home.hpp"
#include "cluxel/cluxel.hpp"
#include "mapping/build/map_builder.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/named_clouds.hpp"
#include "sparql/query_engine.hpp"
#include "sparql/syntax/parser.hpp"
#include "tasks/explanation.hpp"
#include "tasks/named_class.hpp"

namespace cluxel {

std::string_view version() {
  return CLUXEL_VERSION;
}

namespace {

void buildFile(const std::vector<std::filesystem::path>& scans, const std::filesystem::path& file,
               const BuildOptions& options, ProgressSink& sink) {
  const scan::ScanSet set = scan::ScanSet::open(scans, {options.poses}, sink);
  const mapping::MapInputs inputs = mapping::readMapInputs({.ontology = options.ontology,
                                                            .rules = options.rules,
                                                            .sparql_rules = options.sparql_rules,
                                                            .model = options.model},
                                                           DataHome::find(options.home));
  mapping::BuildParams params;
  params.threads = threadCountOf(options.threads);
  params.batch_points = options.batch_points;
  params.force = options.force;
  params.refine_poses = options.refine_poses;
  params.drop_statements = options.drop_statements;
  mapping::buildMap(set, inputs, file, params, sink);
}

}  // namespace

Map::Map(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Map::Map(Map&&) noexcept = default;
Map& Map::operator=(Map&&) noexcept = default;
Map::~Map() = default;

Map Map::build(const std::vector<std::filesystem::path>& scans, const std::filesystem::path& file,
               const BuildOptions& options) {
  ProgressSink silence;
  return build(scans, file, options, silence);
}

Map Map::build(const std::vector<std::filesystem::path>& scans, const std::filesystem::path& file,
               const BuildOptions& options, ProgressSink& sink) {
  if (options.batch_points == 0) throw Error(ErrorKind::InvalidArgument, "batch_points: write a number above 0, not 0");
  if (options.drop_statements && !options.force)
    throw Error(ErrorKind::InvalidArgument, "drop_statements goes with force only");
  requirePath(file, "the map to be built");
  WritingCall call(file, sink);
  guarded([&] { buildFile(scans, file, options, call); }, &call);
  return open(file);
}

Map Map::open(const std::filesystem::path& file) {
  requirePath(file, "the map to be opened");
  return guarded([&] {
    auto impl = std::make_unique<Impl>(std::filesystem::absolute(file));
    impl->reading([](const mapping::MapReader&) {});
    return Map(std::move(impl));
  });
}

Map Map::open(const std::filesystem::path& file, ProgressSink& sink) {
  Map map = open(file);
  const bool is_finished = map.impl_->reading([](const mapping::MapReader& reader) { return reader.isFinished(); });
  if (!is_finished)
    sink.note(file.string() +
              ": warning: the build of this map is unfinished, so the answers are those of some of its "
              "scans; build it again with the same scans to finish it");
  return map;
}

const std::filesystem::path& Map::file() const {
  return impl_->file;
}

MapSummary Map::summary() const {
  const mapping::MapSummary stored = impl_->reading([](const mapping::MapReader& map) { return map.summary(); });
  MapSummary summary;
  summary.is_finished = stored.is_finished;
  summary.inputs_hash = stored.inputs_hash;
  summary.clouds = stored.clouds;
  summary.objects = stored.objects;
  summary.points = stored.points;
  summary.quads = stored.quads;
  summary.objects_by_class = stored.objects_by_class;
  return summary;
}

namespace {

/// Absent for 0. Throws Error (InvalidArgument) for a negative time.
std::optional<std::chrono::milliseconds> deadlineOf(std::chrono::milliseconds deadline) {
  if (deadline.count() < 0)
    throw Error(ErrorKind::InvalidArgument,
                "deadline: write a time above 0, or 0 for no limit, not " + std::to_string(deadline.count()) + " ms");
  if (deadline.count() == 0) return std::nullopt;
  return deadline;
}

/// Throws Error (InvalidArgument) for a variable that the query does not have.
std::vector<std::string> boundVariables(const std::vector<sparql::Binding>& bindings, std::string_view text,
                                        const sparql::QueryOptions& options) {
  std::vector<std::string> names;
  if (bindings.empty()) return names;
  sparql::SparqlParseOptions parsing;
  parsing.file = options.source_name;
  parsing.prefixes = options.prefixes;
  const sparql::ast::VariableTable variables = sparql::parseQuery(text, parsing).variables;
  for (const sparql::Binding& binding : bindings) {
    const bool is_there = std::any_of(variables.begin(), variables.end(),
                                      [&](const auto& one) { return !one.hidden && one.name == binding.first; });
    if (!is_there)
      throw Error(ErrorKind::InvalidArgument,
                  "the query has no variable '" + binding.first + "' to be bound; write names without '?'");
    names.push_back(binding.first);
  }
  return names;
}

}  // namespace

Answer Map::query(std::string_view text, const QueryOptions& options) const {
  const rdf::QuadReader reader = impl_->newestQuads();
  sparql::QueryOptions engine;
  if (options.strict_default_graph) engine.default_graph = sparql::DefaultGraph::Unnamed;
  engine.source_name = options.source_name;
  engine.prefixes = sparql::mapPrefixes();
  engine.budget.deadline = deadlineOf(options.deadline);
  engine.budget.max_rows = options.max_rows;
  engine.budget.max_memory_bytes = options.max_memory_bytes;
  engine.budget.poll = options.poll;
  const std::vector<sparql::Binding> bindings(options.bindings.begin(), options.bindings.end());
  const std::vector<std::string> names = boundVariables(bindings, text, engine);
  Answer::Data data;
  sparql::PreparedQuery prepared(reader, text, engine, names);
  data.result = prepared.evaluate(bindings);
  data.warnings = prepared.warnings();
  for (Diagnostic& note : prepared.notes()) data.warnings.push_back(std::move(note));
  return Answer::Data::answer(std::move(data));
}

UpdateCounts Map::update(std::string_view text, const UpdateOptions& options) {
  sparql::QueryBudget budget;
  budget.deadline = deadlineOf(options.deadline);
  budget.max_memory_bytes = options.max_memory_bytes;
  ProgressSink silence;
  return impl_->writing(silence, [&](WritingCall& sink) -> UpdateCounts {
    if (options.poll) budget.poll = [&] { sink.poll(options.poll); };
    const sparql::UpdateReport report = mapping::updateMap(
        impl_->file, std::string(text),
        {.query = {.budget = budget, .prefixes = sparql::mapPrefixes(), .source_name = options.source_name}}, sink);
    return {report.inserted, report.deleted};
  });
}

MapChanges Map::extend(const std::vector<std::filesystem::path>& scans, const ChangeOptions& options,
                       ProgressSink& sink) {
  return impl_->writing(sink, [&](ProgressSink& callbacks) {
    const scan::ScanSet set = scan::ScanSet::open(scans, {options.poses}, callbacks);
    return changesOf(mapping::extendMap(impl_->file, set, changeParams(options), callbacks));
  });
}

MapChanges Map::retract(const std::vector<std::string>& clouds, const ChangeOptions& options, ProgressSink& sink) {
  return impl_->writing(sink, [&](ProgressSink& callbacks) {
    const auto ids = mapping::cloudsNamed(impl_->file, clouds, callbacks,
                                          {mapping::IncludeRetracted::Yes, mapping::CompareFiles::Yes});
    return changesOf(mapping::retractScans(impl_->file, ids, changeParams(options), callbacks));
  });
}

MapChanges Map::repose(const std::vector<CloudPose>& poses, const ChangeOptions& options, ProgressSink& sink) {
  std::vector<std::string> names;
  for (const CloudPose& pose : poses) names.push_back(pose.cloud);
  return impl_->writing(sink, [&](ProgressSink& callbacks) {
    const auto ids = mapping::cloudsNamed(impl_->file, names, callbacks, {});
    std::vector<mapping::ScanPose> moves;
    for (std::size_t i = 0; i < ids.size(); ++i) moves.push_back({ids[i], poseOf(poses[i])});
    return changesOf(mapping::moveScans(impl_->file, moves, changeParams(options), callbacks));
  });
}

Map Map::merge(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
               const MergeOptions& options, ProgressSink& sink) {
  if (options.dry_run) throw Error(ErrorKind::InvalidArgument, "dry_run: a merge makes the map that it returns");
  mergeInto(maps, target, options, sink);
  return open(target);
}

MapChanges Map::mergeInto(const std::vector<std::filesystem::path>& maps, const std::filesystem::path& target,
                          const MergeOptions& options, ProgressSink& sink) {
  for (const std::filesystem::path& map : maps) requirePath(map, "a map to be merged");
  requirePath(target, "the merged map");
  const MergeRequest request = mergeRequestOf(maps, options);
  WritingCall call(target, sink);
  return guarded([&] { return changesOf(mapping::mergeMaps(request.maps, target, request.params, call)); }, &call);
}

Explanation Map::explain(const std::string& name) const {
  return impl_->reading([&](const mapping::MapReader& map) -> Explanation {
    const tasks::ExplanationTexts texts = tasks::explainThing(map, name);
    return {texts.text, texts.json};
  });
}

std::vector<Object> Map::objects() const {
  return objectsOf(impl_->newestQuads());
}

std::vector<Object> Map::objects(std::string_view class_name) const {
  const auto namespaces = [&] {
    return impl_->reading([](const mapping::MapReader& map) { return tasks::namespacesOf(map.inputs()); });
  };
  return objectsOf(impl_->newestQuads(), class_name, namespaces);
}

std::vector<Cloud> Map::clouds() const {
  return impl_->reading([](const mapping::MapReader& map) { return cloudsOf(map); });
}

PointCloud Map::points(const Cloud& cloud) const {
  return impl_->readingPoints(
      [&](const mapping::MapReader& map, mapping::KeptAnswers& answers) { return pointsOf(map, answers, cloud); });
}

PointCloud Map::points(const Object& object) const {
  return points(object.iri);
}

PointCloud Map::points(const std::string& object) const {
  return impl_->readingPoints(
      [&](const mapping::MapReader& map, mapping::KeptAnswers& answers) { return pointsOf(map, answers, object); });
}

}  // namespace cluxel
