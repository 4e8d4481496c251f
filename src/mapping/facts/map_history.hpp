// SPDX-License-Identifier: Apache-2.0
// The history graph: who ran what when, and from which files. Not part of the map function.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/change/object_changes.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// One run of a command that changed the map. Times in seconds since 1970.
struct Activity {
  std::string operation;  ///< "build", "extend"
  double started_s = 0, ended_s = 0;
  std::vector<std::pair<std::string, double>> stage_s = {};  ///< seconds by stage
};

/// Adds an activity that used `clouds` and `inputs`. Returns its IRI.
std::string addActivity(rdf::WriteTransaction& transaction, const Activity& activity, const std::vector<Cloud>& clouds,
                        const MapInputs& inputs);

/// A scan that `retract` took out of the map.
struct RetractedScan {
  scan::ScanId id;
  std::vector<std::string> sources;  ///< the files that it was read from
  std::string time;                  ///< when, the last time (xsd:dateTime)
};
/// Those that are not there now, by id; also of maps that were merged into this one. Cost: that of the history's
/// activities.
std::vector<RetractedScan> retractedScans(const rdf::ReadTransaction& transaction);

/// The IRIs of the runs that the history of a map tells of.
std::set<std::string> activitiesIn(const rdf::QuadReader& quads);

/// Adds that each object of `objects` was derived from others, by the activity.
void addLineage(rdf::WriteTransaction& transaction, const std::string& activity_iri, const ObjectChanges& changes);
/// Removes that these objects are gone: they have come back, or the history of another map says it.
void removeEndsOf(rdf::WriteTransaction& transaction, const std::vector<ContentHash>& present);

}  // namespace cluxel::mapping
