// SPDX-License-Identifier: Apache-2.0
// Readers of a commit find its layers in what is kept with the commit.
#include "mapping/commit_layers.hpp"

#include <pthread.h>

#include <utility>

namespace cluxel::mapping {

namespace {
constexpr const char* kName = "layers";
using Kept = std::weak_ptr<CommitLayers>;  // a commit that nobody reads holds no layers

/// A forked child process has another one: the thread that held the mutex does not exist there.
std::mutex& findingMutex() {
  static auto* mutex = new std::mutex;
  static const int registered = ::pthread_atfork(nullptr, nullptr, [] { mutex = new std::mutex; });
  static_cast<void>(registered);
  return *mutex;
}

}  // namespace

HeldStages::~HeldStages() {
  for (const auto& held : {newest_, before_})
    if (held) held->holders.fetch_sub(1, std::memory_order_release);
}

void HeldStages::hold(const std::shared_ptr<SharedStages>& stages) {
  stages->holders.fetch_add(1, std::memory_order_relaxed);
  before_ = std::exchange(newest_, stages);
}

std::shared_ptr<CommitLayers> CommitLayers::of(const rdf::QuadReader& quads) {
  const std::lock_guard lock(findingMutex());
  if (const auto kept = std::static_pointer_cast<const Kept>(quads.kept(kName)))
    if (auto layers = kept->lock()) return layers;
  auto layers = std::make_shared<CommitLayers>();
  quads.keep(kName, std::make_shared<const Kept>(layers));
  return layers;
}

const TileStages& CommitLayers::readStages(const rdf::ReadTransaction& transaction, const perception::LabelModel& model,
                                           const MapParams& params, bool with_points, HeldStages& mine) {
  if (mine.newest() && (!with_points || mine.newest()->has_points)) return mine.newest()->stages;
  const std::lock_guard lock(stages_mutex_);
  // Points are added to stages that no other reader has in hand: they would change while it reads them.
  const int mine_held = mine.newest() && mine.newest() == stages_ ? 1 : 0;
  const bool may_change = stages_ && stages_->holders.load(std::memory_order_acquire) == mine_held;
  if (!stages_ || (with_points && !stages_->has_points && !may_change)) {
    const auto read = std::make_shared<SharedStages>(model, params);
    read->stages.load(transaction);
    stages_ = read;
  }
  if (with_points && !stages_->has_points) {
    stages_->stages.loadPoints(transaction);
    stages_->has_points = true;
  }
  if (mine.newest() != stages_) mine.hold(stages_);
  return stages_->stages;
}

}  // namespace cluxel::mapping
