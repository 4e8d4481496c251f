// SPDX-License-Identifier: Apache-2.0
// What a forked child process must not keep of its parent.
#pragma once

#include <cstdint>

namespace cluxel::rdf {

/// How many forks lie between this process and the first one that asked. Cost: reads one number.
std::uint64_t forkCount();

/// A forked child closes the descriptor before it does anything else. flock() and open file description locks belong to
/// all processes that have the descriptor: a child that kept it would hold them when its parent was killed. A child has
/// no other locks on the file yet, which it could lose. Numbers from 65536 on are not closed.
void closeInChildren(int descriptor);
/// Must be called before the descriptor is closed: its number may then be that of another file.
void keepInChildren(int descriptor);

}  // namespace cluxel::rdf
