// SPDX-License-Identifier: Apache-2.0
// A shared counter hands out the pieces.
#include "base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace cluxel {

namespace {

/// What the threads of one parallelFor() share. A thread may begin after the work is done: it then finds it closed, and
/// nobody waits for it.
class SharedPieces {
 public:
  SharedPieces(std::size_t count, const std::function<void(std::size_t)>& work)
      : count_(count), work_(work), failed_piece_(count) {}

  /// Threads that were started and have not begun, of all loops of the process. They are few, though loops do not wait
  /// for them: a loop starts no more while as many have not begun as it may use.
  static std::atomic<std::size_t>& notBegun() {
    static std::atomic<std::size_t> count{0};
    return count;
  }

  /// What the threads beside the calling one do.
  void help() {
    --notBegun();
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_) return;
      ++helpers_;
    }
    workOn();
    const std::lock_guard lock(mutex_);
    if (--helpers_ == 0) left_.notify_all();
  }

  void workOn() {
    for (std::size_t i = next_++; i < count_; i = next_++) {
      try {
        work_(i);
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (i < failed_piece_) failure_ = std::current_exception();
        failed_piece_ = std::min(failed_piece_, i);
        next_ = count_;  // all smaller pieces have been handed out already
      }
    }
  }

  /// Waits for the threads that have begun. Nobody uses `work` afterwards.
  void close() {
    std::unique_lock lock(mutex_);
    is_closed_ = true;
    left_.wait(lock, [this] { return helpers_ == 0; });
  }

  void rethrow() {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  const std::size_t count_;
  const std::function<void(std::size_t)>& work_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;
  std::condition_variable left_;
  std::size_t helpers_ = 0, failed_piece_;
  bool is_closed_ = false;
  std::exception_ptr failure_;
};

/// Whether a thread could be started. Where the system has no more, work goes on with those that there are.
bool started(const std::function<void()>& run) {
  try {
    std::thread(run).detach();
    return true;
  } catch (const std::system_error&) {
    return false;
  }
}

}  // namespace

void parallelFor(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work) {
  const std::size_t extra = std::min<std::size_t>(std::max(threads, 1U), std::max<std::size_t>(count, 1)) - 1;
  const auto pieces = std::make_shared<SharedPieces>(count, work);
  for (std::size_t i = 0; i < extra && SharedPieces::notBegun() < extra; ++i) {
    ++SharedPieces::notBegun();
    if (!started([pieces] { pieces->help(); })) {
      --SharedPieces::notBegun();
      break;
    }
  }
  pieces->workOn();
  pieces->close();
  pieces->rethrow();
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
    try {
      for (std::size_t i = 0; i < extra; ++i) pool.emplace_back([&] { pieces.workOn(); });
    } catch (const std::system_error&) {  // the system has no more threads: work goes on with those that there are
    }
    pieces.takeAll(take);
  }
  pieces.rethrow();
}

}  // namespace cluxel
