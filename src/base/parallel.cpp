// SPDX-License-Identifier: Apache-2.0
// A shared counter hands out the pieces.
#include "base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace cluxel {

void parallelFor(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::mutex failure_mutex;
  std::size_t failed_piece = count;
  std::exception_ptr failure;
  const auto worker = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (i < failed_piece) failure = std::current_exception();
        failed_piece = std::min(failed_piece, i);
        next = count;  // all smaller pieces have been handed out already
      }
    }
  };
  const std::size_t extra = std::min<std::size_t>(std::max(threads, 1U), std::max<std::size_t>(count, 1)) - 1;
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 0; i < extra; ++i) pool.emplace_back(worker);
    worker();
  }
  if (failure) std::rethrow_exception(failure);
}

namespace {

/// The state that the threads of one parallelInOrder() share.
class OrderedPieces {
 public:
  OrderedPieces(std::size_t count, std::size_t ahead, const std::function<void(std::size_t)>& work)
      : count_(count), ahead_(std::max<std::size_t>(ahead, 1)), work_(work), is_done_(ahead_, 0) {}

  /// What the threads beside the calling one do.
  void workOn() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return hasEnded() || mayBegin(); });
      if (hasEnded()) return;
      workOnNext(lock);
    }
  }

  /// What the calling thread does: it works when nothing can be taken.
  void takeAll(const std::function<void(std::size_t)>& take) {
    std::unique_lock lock(mutex_);
    while (taken_ < count_ && !failure_) {
      if (isReady())
        takeNext(lock, take);
      else if (mayBegin())
        workOnNext(lock);
      else
        changed_.wait(lock, [this] { return isReady() || failure_; });
    }
  }

  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  bool hasEnded() const { return next_ == count_ || failure_; }
  bool mayBegin() const { return !hasEnded() && next_ < taken_ + ahead_; }
  bool isReady() const { return taken_ < next_ && is_done_[taken_ % ahead_] != 0; }

  void workOnNext(std::unique_lock<std::mutex>& lock) {
    const std::size_t piece = next_++;
    run(lock, piece, work_);
    is_done_[piece % ahead_] = 1;
    changed_.notify_all();
  }

  void takeNext(std::unique_lock<std::mutex>& lock, const std::function<void(std::size_t)>& take) {
    run(lock, taken_, take);
    is_done_[taken_++ % ahead_] = 0;
    changed_.notify_all();
  }

  void run(std::unique_lock<std::mutex>& lock, std::size_t piece, const std::function<void(std::size_t)>& call) {
    std::exception_ptr failure;
    lock.unlock();
    try {
      call(piece);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (!failure || piece >= failed_piece_) return;
    failure_ = failure;
    failed_piece_ = piece;
  }

  const std::size_t count_, ahead_;
  const std::function<void(std::size_t)>& work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<char> is_done_;  ///< of pieces that are not taken, by their number modulo ahead_
  std::size_t next_ = 0, taken_ = 0, failed_piece_ = static_cast<std::size_t>(-1);
  std::exception_ptr failure_;
};

}  // namespace

void parallelInOrder(std::size_t count, unsigned threads, std::size_t ahead,
                     const std::function<void(std::size_t)>& work, const std::function<void(std::size_t)>& take) {
  OrderedPieces pieces(count, ahead, work);
  const std::size_t extra = std::min<std::size_t>(std::max(threads, 1U), std::max<std::size_t>(count, 1)) - 1;
  {
    std::vector<std::jthread> pool;
    for (std::size_t i = 0; i < extra; ++i) pool.emplace_back([&] { pieces.workOn(); });
    pieces.takeAll(take);
  }
  pieces.rethrow();
}

}  // namespace cluxel
