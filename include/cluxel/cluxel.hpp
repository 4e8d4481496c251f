// SPDX-License-Identifier: Apache-2.0
// The library in one header: build, open, ask, update and explain semantic maps of laser scans.
#pragma once

#include <string_view>

#include "cluxel/answer.hpp"
#include "cluxel/error.hpp"
#include "cluxel/export.hpp"
#include "cluxel/ground_ways.hpp"
#include "cluxel/inventory_item.hpp"
#include "cluxel/map.hpp"
#include "cluxel/object.hpp"
#include "cluxel/object_search.hpp"
#include "cluxel/point_cloud.hpp"
#include "cluxel/progress.hpp"
#include "cluxel/term.hpp"
#include "cluxel/visit_changes.hpp"

namespace cluxel {

/// The version of the library that is loaded: "0.1.0".
CLUXEL_API std::string_view version();

}  // namespace cluxel
