// SPDX-License-Identifier: Apache-2.0
// The exit codes of the program, which are also the kinds of errors of the library.
#pragma once

namespace cluxel {

enum class ExitCode : int {
  Done = 0,
  NegativeFinding = 1,   ///< a check failed, an ASK was false, an evaluation stayed below its bar
  Usage = 2,             ///< the command line is wrong
  NoRows = 3,            ///< a query had no solution
  FaultyInput = 4,       ///< unreadable scans, faulty query, rules, ontology, labels or model
  StoreUnavailable = 5,  ///< the map cannot be opened, locked or written
  BudgetExceeded = 6,    ///< a deadline, row or memory budget ran out
};

}  // namespace cluxel
