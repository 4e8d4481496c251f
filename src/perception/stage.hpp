// SPDX-License-Identifier: Apache-2.0
// The names of perception's stages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cluxel::perception {

/// The stages that write one output per tile, in the order in which they run.
enum class Stage : std::uint8_t { Points, Cluxels, Ground, Features, Labels, Summaries, Even, Components, Contacts };
inline constexpr std::size_t kStageCount = 9;

/// "points", "cluxels", "ground", "features", "labels", "summaries", "even", "components", "contacts".
std::string_view nameOf(Stage stage);

}  // namespace cluxel::perception
