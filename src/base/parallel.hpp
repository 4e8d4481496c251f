// SPDX-License-Identifier: Apache-2.0
// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace cluxel {

/// Calls `work(i)` once for every i in [0, count), on up to `threads` threads, in no order. Each call must write only
/// what belongs to its own i: then the outcome is the same for every number of threads. The exception of the smallest
/// failing i is thrown again; no further piece begins after a failure.
void parallelFor(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work);

/// The same, and calls `take(i)` on the calling thread in ascending order, each after its `work(i)` and while other
/// pieces are worked on. At most `ahead` pieces, one or more, are begun and not taken: piece i may write where piece
/// i - ahead has written. After a failure no further piece is taken.
void parallelInOrder(std::size_t count, unsigned threads, std::size_t ahead,
                     const std::function<void(std::size_t)>& work, const std::function<void(std::size_t)>& take);

}  // namespace cluxel
