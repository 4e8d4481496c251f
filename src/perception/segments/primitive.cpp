// SPDX-License-Identifier: Apache-2.0
// The table of primitive attributes: names for rules, properties for RDF, dimensions for unit checks.
#include "perception/segments/primitive.hpp"

namespace cluxel::perception {

const std::array<AttributeInfo, kAttributeCount>& attributeInfos() {
  using A = Attribute;
  using D = Dimension;
  static const std::array<AttributeInfo, kAttributeCount> infos{{
      {A::Height, "height", "height", D::Length, "vertical extent"},
      {A::HorizontalExtent, "horizontal_extent", "horizontalExtent", D::Length, "larger side of the upright box"},
      {A::HorizontalThickness, "horizontal_thickness", "horizontalThickness", D::Length,
       "smaller side of the upright box"},
      {A::Length, "length", "length", D::Length, "larger side of the upright box"},
      {A::Width, "width", "width", D::Length, "smaller side of the upright box"},
      {A::FootprintArea, "footprint_area", "footprintArea", D::Area, "area of occupied 0.25 m map cells"},
      {A::Volume, "volume", "volume", D::Volume, "volume of the upright box"},
      {A::Bottom, "bottom", "bottom", D::Length, "height of the lowest point above the local ground"},
      {A::Top, "top", "top", D::Length, "height of the highest point above the local ground"},
      {A::ElevationSpan, "elevation_span", "elevationSpan", D::Length, "top minus bottom"},
      {A::FreeHeightBelow, "free_height_below", "freeHeightBelow", D::Length,
       "median height above the ground scanned below it"},
      {A::NormalTilt, "normal_tilt", "normalTilt", D::Angle, "angle between the best plane's normal and the vertical"},
      {A::AxisTilt, "axis_tilt", "axisTilt", D::Angle, "angle between the main axis and the vertical"},
      {A::Linearity, "linearity", "linearity", D::Ratio, "(l1-l2)/l1 of the covariance's eigenvalues"},
      {A::Planarity, "planarity", "planarity", D::Ratio, "(l2-l3)/l1 of the covariance's eigenvalues"},
      {A::Scattering, "scattering", "scattering", D::Ratio, "l3/l1 of the covariance's eigenvalues"},
      {A::Radius, "radius", "radius", D::Length, "rms distance of points to the main axis"},
      {A::Roughness, "roughness", "roughness", D::Length, "rms distance to the best plane"},
      {A::PointCount, "point_count", "pointCount", D::Count, "number of points"},
      {A::CluxelCount, "cluxel_count", "cluxelCount", D::Count, "number of cluxels"},
      {A::Probability, "probability", "probability", D::Ratio, "mean probability of the label over its points"},
      {A::GroundContact, "ground_contact", "groundContact", D::Ratio,
       "share of its footprint cells whose lowest point is within 0.3 m of the ground"},
      {A::ViewCount, "view_count", "viewCount", D::Count, "number of scans with a point among its own"},
      {A::MeanIntensity, "mean_intensity", "meanIntensity", D::Ratio, "mean intensity of the returns, 0 without any"},
  }};
  return infos;
}

std::optional<Attribute> attributeOf(std::string_view name) {
  for (const AttributeInfo& info : attributeInfos())
    if (info.name == name) return info.attribute;
  return std::nullopt;
}

bool isOfAnEnd(Attribute attribute) {
  switch (attribute) {
    case Attribute::Top:
    case Attribute::Bottom:
    case Attribute::Height:
    case Attribute::ElevationSpan:
    case Attribute::Length:
    case Attribute::HorizontalExtent:
      return true;
    default:
      return false;
  }
}

}  // namespace cluxel::perception
