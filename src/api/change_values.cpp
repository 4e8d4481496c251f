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

namespace cluxel {

namespace {

std::map<ContentHash, std::string> classNames(const std::vector<mapping::ObjectMembers>& objects,
                                              const rdf::ClassNames& class_names) {
  std::map<ContentHash, std::string> names;
  for (const mapping::ObjectMembers& object : objects) names.emplace(object.id, class_names.nameOf(object.class_iri));
  return names;
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
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  Eigen::Isometry3d T_map_sensor;
  T_map_sensor.matrix() = Eigen::Map<const RowMajor>(pose.T_map_sensor.data());
  if (const auto fault = scan::faultOfPose(T_map_sensor))
    throw Error(ErrorKind::InvalidArgument, "the pose for cloud " + pose.cloud + " " + *fault);
  return T_map_sensor;
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
