// SPDX-License-Identifier: Apache-2.0
// The exit codes of the program, and which of them each kind of library error has.
#pragma once

#include <array>

#include "cluxel/error.hpp"

namespace cluxel::app {

enum class ExitCode : int {
  Done = 0,
  NegativeFinding = 1,   ///< a check failed, an ASK was false, an evaluation stayed below its bar
  Usage = 2,             ///< the command line is wrong
  NoRows = 3,            ///< a query had no solution, or nothing has the name
  FaultyInput = 4,       ///< unreadable scans, faulty query, update, RDF, rules, ontology, labels or model
  StoreUnavailable = 5,  ///< the map cannot be opened, locked or written
  BudgetExceeded = 6,    ///< a deadline, row or memory budget ran out
};

/// What the help and the man page say about a code.
struct ExitCodeHelp {
  ExitCode code;
  const char* meaning;
};
inline constexpr std::array<ExitCodeHelp, 7> kExitCodeHelp{
    {{ExitCode::Done, "done"},
     {ExitCode::NegativeFinding, "negative finding (check failed, ASK false)"},
     {ExitCode::Usage, "usage"},
     {ExitCode::NoRows, "no rows"},
     {ExitCode::FaultyInput, "unreadable input, faulty query, update, RDF or rules"},
     {ExitCode::StoreUnavailable, "store unavailable"},
     {ExitCode::BudgetExceeded, "budget exceeded"}}};

constexpr ExitCode exitCodeOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::InvalidArgument:
      return ExitCode::Usage;
    case ErrorKind::NotFound:
      return ExitCode::NoRows;
    case ErrorKind::FaultyInput:
      return ExitCode::FaultyInput;
    case ErrorKind::StoreUnavailable:
      return ExitCode::StoreUnavailable;
    case ErrorKind::BudgetExceeded:
      return ExitCode::BudgetExceeded;
  }
  return ExitCode::FaultyInput;
}

}  // namespace cluxel::app
