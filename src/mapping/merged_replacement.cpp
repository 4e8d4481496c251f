// SPDX-License-Identifier: Apache-2.0
// The result of hours is not dropped because another process has the target for a moment.
#include "mapping/merged_replacement.hpp"

#include <chrono>

#include "mapping/build/operator_statements.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

void replaceNow(const fs::path& merged, const fs::path& target, ProgressSink& sink) {
  if (!fs::exists(target) || fs::is_empty(target)) return rdf::replaceMapFile(merged, target);
  const rdf::WriteTransaction old = rdf::writeMap(target);
  const bool has_statements =
      !operatorStatements(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(old))).empty();
  rdf::replaceMapFile(merged, target);
  if (has_statements) sink.note(target.string() + ": is replaced; the operator statements that it had are dropped");
}

}  // namespace

void replaceByMerged(const fs::path& merged, const fs::path& target, ProgressSink& sink) {
  constexpr auto kPatience = std::chrono::minutes(10);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (bool is_told = false;; is_told = true) {
    try {
      return replaceNow(merged, target, sink);
    } catch (const rdf::MapBusy&) {
      if (std::chrono::steady_clock::now() >= deadline) throw;
      if (!is_told)
        sink.note(target.string() +
                  ": another process writes, copies or opens it; the merged map takes its place when that has ended, "
                  "or is dropped after 10 minutes");
    }
  }
}

}  // namespace cluxel::mapping
