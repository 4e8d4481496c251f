// SPDX-License-Identifier: Apache-2.0
// Faults in the order of files and places.
#include "base/yaml/fault_list.hpp"

#include <algorithm>
#include <tuple>

#include "base/shown_line.hpp"

namespace cluxel {

void FaultList::addFile(std::string file, std::string text) {
  files_.emplace_back(std::move(file), std::move(text));
}

void FaultList::error(const SourceLocation& at, std::string message, std::string hint) {
  if (++errors_ <= kMaxFaults) add(Severity::Error, at, std::move(message), std::move(hint));
}

void FaultList::warning(const SourceLocation& at, std::string message, std::string hint) {
  if (++warnings_ <= kMaxFaults) add(Severity::Warning, at, std::move(message), std::move(hint));
}

void FaultList::add(Severity severity, const SourceLocation& at, std::string message, std::string hint) {
  Diagnostic fault;
  fault.severity = severity;
  fault.location = at;
  fault.message = std::move(message);
  fault.hint = std::move(hint);
  for (const auto& [file, text] : files_)
    if (file == at.file) fault.source_line = shownLine(text, at.line);
  faults_.push_back(std::move(fault));
}

std::vector<Diagnostic> FaultList::sorted() const {
  auto fileNumber = [this](const Diagnostic& fault) {
    const auto found =
        std::find_if(files_.begin(), files_.end(), [&](const auto& file) { return file.first == fault.location.file; });
    return found - files_.begin();
  };
  auto place = [&](const Diagnostic& fault) {
    return std::tuple(fileNumber(fault), fault.location.line, fault.location.column);
  };
  std::vector<Diagnostic> faults = faults_;
  std::stable_sort(faults.begin(), faults.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
  const auto last = std::unique(faults.begin(), faults.end(), [&](const Diagnostic& a, const Diagnostic& b) {
    return place(a) == place(b) && a.message == b.message;
  });
  faults.erase(last, faults.end());
  const std::string file = files_.empty() ? "" : files_.front().first;
  if (errors_ > kMaxFaults) faults.push_back(furtherFaults(Severity::Error, file, errors_ - kMaxFaults));
  if (warnings_ > kMaxFaults) faults.push_back(furtherFaults(Severity::Warning, file, warnings_ - kMaxFaults));
  return faults;
}

void FaultList::throwIfErrors() const {
  if (errors_ > 0) throw InputError(sorted());
}

}  // namespace cluxel
