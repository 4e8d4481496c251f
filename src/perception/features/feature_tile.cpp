// SPDX-License-Identifier: Apache-2.0
// The feature stage: collect cluxels, build the graph, then fill the groups one by one.
#include "perception/features/feature_tile.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "cluxel/error.hpp"
#include "perception/features/feature_groups.hpp"

namespace cluxel::perception {
namespace {

void append(std::vector<std::string>& names, const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
}

/// Increase it when the formula of a column changes, so that models trained on the old formula are refused.
constexpr std::uint32_t kFeatureVersion = 1;

/// The groups after the support features, in column order.
struct FurtherGroup {
  bool FeatureParams::*is_on;
  std::vector<std::string> (*columns)();
  void (*fill)(const FeatureInput&, std::size_t column, FeatureRows&);
};
constexpr std::array<FurtherGroup, 4> kFurtherGroups{
    {{&FeatureParams::wide_shape, wideColumns, fillWideFeatures},
     {&FeatureParams::height, heightColumns, fillHeightFeatures},
     {&FeatureParams::pillar, pillarColumns, fillPillarFeatures},
     {&FeatureParams::intensity, intensityColumns, fillIntensityFeatures}}};

/// Shapes of the balls of own cluxels and of those that edges lead to.
std::vector<EigenShape> ballShapes(const Ring<CluxelTile>& ring, const RingCluxels& cluxels) {
  std::vector<EigenShape> shapes(cluxels.size());
  const auto keep = [&](std::size_t c, const EigenShape& shape) { shapes[c] = shape; };
  FourShapes four;
  for (std::size_t c = 0; c < shapes.size(); ++c)
    if (cluxels.near[c]) four.add(c, covarianceOf(ring[cluxels.name[c].ring]->ball[cluxels.name[c].index]), keep);
  four.finish(keep);
  return shapes;
}

}  // namespace

void describe(FeatureParams& params, ParameterVisitor& visitor) {
  visitor.flag({"features.hor", "1", 0, 1, "histogram of oriented residuals of the 2-ring"}, params.hor);
  visitor.flag({"features.shape", "1", 0, 1, "eigenvalue shape of ball, 1-ring and 2-ring"}, params.shape);
  visitor.flag({"features.wide_shape", "1", 0, 1, "eigenvalue shape of wide cubes"}, params.wide_shape);
  visitor.flag({"features.height", "1", 0, 1, "height above ground and profile of the cell stack"}, params.height);
  visitor.flag({"features.pillar", "1", 0, 1, "occupied cells beside, above and below"}, params.pillar);
  visitor.flag({"features.extent", "1", 0, 1, "sizes of the supports"}, params.extent);
  visitor.flag({"features.density", "1", 0, 1, "spacing of points and numbers of neighbours"}, params.density);
  visitor.flag({"features.intensity", "1", 0, 1, "mean and spread of the intensity"}, params.intensity);
}

void describe(PerceptionParams& params, ParameterVisitor& visitor) {
  describe(params.thin, visitor);
  describe(params.clustering, visitor);
  describe(params.ground, visitor);
  describe(params.features, visitor);
}

ContentHash FeatureLayout::hash() const {
  ContentHasher hasher;
  hasher.add(kFeatureVersion);
  for (const auto* names : {&columns, &edge_columns}) {
    hasher.add(static_cast<std::uint64_t>(names->size()));
    for (const auto& name : *names) hasher.addText(name);
  }
  return hasher.finish();
}

FeatureLayout featureLayout(const FeatureParams& params) {
  FeatureLayout layout{supportColumns(params), edgeColumns()};
  for (const auto& group : kFurtherGroups)
    if (params.*group.is_on) append(layout.columns, group.columns());
  return layout;
}

namespace {

FeatureTile featuresOfChosen(const Ring<CluxelTile>& cluxels, const Ring<GroundTile>& ground,
                             const FeatureParams& params, const std::vector<std::uint32_t>& chosen) {
  const CluxelTile& own = *cluxels[kRingCentre];
  const RingCluxels gathered = gatherCluxels(cluxels);
  const RingGraph graph = intersectionGraph(gathered);
  const auto ball = ballShapes(cluxels, gathered);
  const FeatureInput input{cluxels, ground, gathered, graph, ball, chosen};
  FeatureTile tile;
  tile.key = own.key;
  for (const auto& moments : own.own) {
    tile.center.push_back(moments.mean);
    tile.point_count.push_back(static_cast<std::uint32_t>(moments.count));
  }
  FeatureRows rows(own.size(), featureLayout(params).columns.size());
  std::size_t column = supportColumns(params).size();
  fillSupportFeatures(input, params, 0, rows);
  for (const auto& group : kFurtherGroups) {
    if (!(params.*group.is_on)) continue;
    group.fill(input, column, rows);
    column += group.columns().size();
  }
  tile.features = rows.take();
  fillEdges(input, tile);
  return tile;
}

}  // namespace

FeatureTile computeFeatures(const Ring<CluxelTile>& cluxels, const Ring<GroundTile>& ground,
                            const FeatureParams& params) {
  for (const CluxelTile* tile : cluxels)
    if (tile != nullptr && !tile->hasVolumes()) throw std::logic_error("features are computed without volumes");
  std::vector<std::uint32_t> all(cluxels[kRingCentre]->size());
  std::iota(all.begin(), all.end(), 0U);
  return featuresOfChosen(cluxels, ground, params, all);
}

void addRows(const Ring<CluxelTile>& cluxels, const Ring<GroundTile>& ground, const FeatureParams& params,
             const std::vector<std::uint32_t>& chosen, FeatureTile& tile) {
  FeatureTile rows = featuresOfChosen(cluxels, ground, params, chosen);
  const std::size_t columns = edgeColumns().size();
  tile.center = std::move(rows.center), tile.point_count = std::move(rows.point_count);
  tile.features = std::move(rows.features);
  tile.edge_features.assign(tile.edge_row_offset.back() * columns, 0.0F);
  for (const std::uint32_t c : chosen) {
    const std::size_t from = rows.edge_row_offset[c], count = rows.edge_row_offset[c + 1] - from;
    if (tile.edge_row_offset[c + 1] - tile.edge_row_offset[c] != count)
      throw Error(ErrorKind::StoreUnavailable, "a stored graph is of other cluxels; the map is damaged, build it anew");
    std::copy_n(rows.edge_features.begin() + static_cast<std::ptrdiff_t>(from * columns), count * columns,
                tile.edge_features.begin() + static_cast<std::ptrdiff_t>(tile.edge_row_offset[c] * columns));
  }
}

std::vector<std::string> intensityColumns() {
  return {"intensity.mean", "intensity.deviation", "intensity.known"};
}

void fillIntensityFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  const CluxelTile& own = input.own();
  if (own.intensity_mean.empty()) return;
  for (const std::uint32_t c : input.chosen) {
    auto out = rows.row(c, column, 3);
    out[0] = own.intensity_mean[c];
    out[1] = own.intensity_deviation[c];
    out[2] = 1.0F;
  }
}

}  // namespace cluxel::perception
