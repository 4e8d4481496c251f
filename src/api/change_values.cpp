// SPDX-License-Identifier: Apache-2.0
// Ids become IRIs, and classes local names.
#include "api/change_values.hpp"

#include <algorithm>
#include <map>
#include <thread>

#include "cluxel/error.hpp"
#include "mapping/map_reader.hpp"
#include "rdf/map_iris.hpp"
#include "scan/poses/pose_files.hpp"
#include "tasks/merge_request.hpp"

namespace cluxel {

namespace {

std::map<ContentHash, std::string> classNames(const std::vector<mapping::ObjectMembers>& objects,
                                              const rdf::ClassNames& class_names) {
  std::map<ContentHash, std::string> names;
  for (const mapping::ObjectMembers& object : objects) names.emplace(object.id, class_names.nameOf(object.class_iri));
  return names;
}

Eigen::Isometry3d motionOf(const std::array<double, 16>& row_by_row) {
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  Eigen::Isometry3d motion;
  motion.matrix() = Eigen::Map<const RowMajor>(row_by_row.data());
  return motion;
}

}  // namespace

unsigned threadCountOf(unsigned threads) {
  return threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
}

mapping::ChangeParams changeParams(const ChangeOptions& options) {
  if (options.batch_points == 0) throw Error(ErrorKind::InvalidArgument, "batch_points: write a number above 0, not 0");
  mapping::ChangeParams params;
  params.threads = threadCountOf(options.threads);
  params.batch_points = options.batch_points;
  params.dry_run = options.dry_run;
  return params;
}

Eigen::Isometry3d poseOf(const CloudPose& pose) {
  const Eigen::Isometry3d T_map_sensor = motionOf(pose.T_map_sensor);
  if (const auto fault = scan::faultOfPose(T_map_sensor))
    throw Error(ErrorKind::InvalidArgument, "the pose for cloud " + pose.cloud + " " + *fault);
  return T_map_sensor;
}

MergeRequest mergeRequestOf(const std::vector<std::filesystem::path>& maps, const MergeOptions& options) {
  MergeRequest request;
  request.params.change =
      changeParams({.threads = options.threads, .batch_points = options.batch_points, .dry_run = options.dry_run});
  if (options.drop_statements && !options.force)
    throw Error(ErrorKind::InvalidArgument, "drop_statements goes with force only");
  request.params.force = options.force;
  request.params.drop_statements = options.drop_statements;
  for (const std::filesystem::path& map : maps) request.maps.push_back({map, Eigen::Isometry3d::Identity()});
  if (options.T_first_second) {
    Eigen::Isometry3d T_first_second = motionOf(*options.T_first_second);
    if (const auto fault = scan::faultOfTransform(T_first_second))
      throw Error(ErrorKind::InvalidArgument, fault->what + "; " + fault->remedy);
    T_first_second.linear() = scan::nearestRotation(T_first_second.linear());
    tasks::setTransform(request.maps, T_first_second);
  }
  if (!options.use.empty()) request.params.use = tasks::numberAmong(request.maps, options.use);
  return request;
}

MapChanges changesOf(const mapping::ChangeReport& report) {
  MapChanges changes;
  changes.scans_added = report.scans_added;
  changes.scans_already_there = report.scans_already_there;
  changes.scans_removed = report.scans_removed;
  changes.scans_moved = report.scans_moved;
  changes.tiles_changed = report.tiles_changed;
  changes.objects_unchanged = report.objects.unchanged;
  const auto before = classNames(report.before, report.class_names),
             after = classNames(report.after, report.class_names);
  const auto add = [&](ChangeKind kind, const ContentHash& id, const std::string& class_name,
                       const std::vector<ContentHash>& from) {
    ObjectChange change{kind, rdf::iriOfObject(id), class_name, {}};
    for (const ContentHash& origin : from) change.derived_from.push_back(rdf::iriOfObject(origin));
    changes.objects.push_back(std::move(change));
  };
  for (const ContentHash& id : report.objects.added) add(ChangeKind::Added, id, after.at(id), {});
  for (const ContentHash& id : report.objects.gone) add(ChangeKind::Gone, id, before.at(id), {});
  for (const auto& object : report.objects.changed)
    add(ChangeKind::Changed, object.id, after.at(object.id), object.from);
  for (const auto& object : report.objects.split) add(ChangeKind::Split, object.id, after.at(object.id), object.from);
  for (const auto& object : report.objects.joined) add(ChangeKind::Joined, object.id, after.at(object.id), object.from);
  for (const auto& object : report.objects.redecided)
    add(ChangeKind::Redecided, object.after.id, report.class_names.nameOf(object.after.class_iri), {});
  return changes;
}

}  // namespace cluxel
