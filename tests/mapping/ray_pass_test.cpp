// SPDX-License-Identifier: Apache-2.0
// Observers take the views of scans in the same order for any number of threads.
#include "mapping/presence/ray_pass.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "base/content_hash.hpp"

namespace cluxel::mapping {
namespace {

using testing::ElementsAreArray;

constexpr int kClouds = 24;

Cloud cloudOf(int number) {
  Cloud cloud;
  cloud.id = ContentHasher().add(number).finish();
  cloud.source = std::to_string(number);
  cloud.has_pose = true;
  if (number % 5 != 0) cloud.time_s = (number * 7) % kClouds;  // every fifth has no time
  return cloud;
}

std::vector<Cloud> someClouds() {
  std::vector<Cloud> clouds;
  for (int i = 0; i < kClouds; ++i) clouds.push_back(cloudOf(i));
  return clouds;
}

/// As many rays as the number of the cloud, and one more.
scan::Scan scanOf(const Cloud& cloud) {
  scan::Scan scan;
  scan.has_pose = true;
  for (int i = 0; i <= std::stoi(cloud.source); ++i) {
    scan.points.x.push_back(static_cast<float>(5 + i));
    scan.points.y.push_back(1), scan.points.z.push_back(0);
  }
  return scan;
}

class RangeView : public ScanView {
 public:
  explicit RangeView(std::string cloud) : cloud_(std::move(cloud)) {}
  void look(const perception::ScanRays& rays, unsigned threads) override {
    EXPECT_GE(threads, 1U);
    range_m_ = rays.bundles().front().maxRange_m();
    // Scans of higher numbers are ready first, as far as they run at the same time.
    std::this_thread::sleep_for(std::chrono::microseconds(50 * (kClouds - std::stoi(cloud_))));
  }
  std::string told() const { return cloud_ + ": " + std::to_string(range_m_); }

 private:
  std::string cloud_;
  double range_m_ = 0;
};

/// Tells what it took, in order. Wants the clouds whose number is no multiple of `skipped`.
class Teller : public RayObserver {
 public:
  Teller(unsigned threads, int skipped) : RayObserver(threads), skipped_(skipped) {}
  bool wants(const Cloud& cloud) const override { return std::stoi(cloud.source) % skipped_ != 0; }
  std::unique_ptr<ScanView> view(const Cloud& cloud) const override {
    EXPECT_TRUE(wants(cloud));
    return std::make_unique<RangeView>(cloud.source);
  }
  void take(const ScanView& seen) override { told_.push_back(dynamic_cast<const RangeView&>(seen).told()); }
  const std::vector<std::string>& told() const { return told_; }

 private:
  int skipped_;
  std::vector<std::string> told_;
};

TEST(PassRays, ShowsScansInTheirOrderOnAnyNumberOfThreads) {
  const std::vector<Cloud> clouds = someClouds();
  std::vector<std::vector<std::string>> told;
  for (const unsigned threads : {1U, 2U, 5U, 40U}) {
    Teller odd(threads, 2), most(1, 3);
    std::atomic<int> loading = 0, loaded = 0;
    passRays(clouds, std::array<RayObserver*, 2>{&odd, &most}, [&](const Cloud& cloud) {
      EXPECT_EQ(++loading, 1) << "two scans are loaded at once";
      ++loaded;
      scan::Scan scan = scanOf(cloud);
      --loading;
      return scan;
    });
    EXPECT_EQ(loaded, 20) << "a scan that nobody wants is not loaded";  // 4 of 24 are multiples of 6
    told.push_back(odd.told());
    told.back().insert(told.back().end(), most.told().begin(), most.told().end());
    EXPECT_THAT(told.back(), ElementsAreArray(told.front())) << threads;
  }
  std::vector<std::string> in_time;
  for (const Cloud* cloud : timedClouds(clouds))
    if (std::stoi(cloud->source) % 2 != 0) in_time.push_back(cloud->source);
  ASSERT_EQ(told.front().size(), 12U + 16U);
  for (std::size_t i = 0; i < in_time.size(); ++i) EXPECT_EQ(told.front()[i].find(in_time[i] + ": "), 0U);
}

TEST(PassRays, ThrowsWhatLoadingThrows) {
  const std::vector<Cloud> clouds = someClouds();
  for (const unsigned threads : {1U, 4U}) {
    Teller teller(threads, 100);
    EXPECT_THROW(passRays(clouds, std::array<RayObserver*, 1>{&teller},
                          [](const Cloud& cloud) {
                            if (cloud.source == "11") throw std::runtime_error("gone");
                            return scanOf(cloud);
                          }),
                 std::runtime_error);
    EXPECT_LT(teller.told().size(), clouds.size());
  }
}

}  // namespace
}  // namespace cluxel::mapping
