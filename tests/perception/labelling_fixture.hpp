// SPDX-License-Identifier: Apache-2.0
// A synthetic place: cluxels on a grid over two tiles, regions of one label, one informative feature with noise.
#pragma once

#include <cstdint>

#include "perception/training/training.hpp"

namespace cluxel::made_up {

using namespace scan;
using namespace perception;

/// Two tiles side by side with 16 x 16 cluxels each, 1 m apart; labels change every 4 m in x and y.
TrainingPlace place(std::uint32_t seed, int group);

/// Fast settings that suffice for such places.
TrainParams quickTraining();

/// A model trained on two such places.
LabelModel model();

}  // namespace cluxel::made_up
