// SPDX-License-Identifier: Apache-2.0
// The wording of what a watch tells.
#include "mapping/watch/watch_notes.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <utility>

namespace cluxel::mapping {

namespace fs = std::filesystem;

void WatchNotes::tellFaults(const FolderLook& before, const FolderLook& now) {
  if (!now.is_there)
    return tellOnce(told_fault_, folder_.string() + ": is no longer there; the watch goes on when it is there again");
  if (now.fault.empty())
    told_fault_.clear();
  else if (before.files == now.files)
    tellOnce(told_fault_, now.fault);
  for (const auto& [path, scan] : now.faulty) {
    const auto earlier = before.faulty.find(path);
    if (earlier == before.faulty.end() || earlier->second != scan) continue;
    if (std::exchange(told_faulty_[path], scan) != scan) tellFaulty(scan.fault);
  }
}

void WatchNotes::tellFaulty(const std::string& fault) {
  sink_.note(fault + "; it is tried again when the file changes");
}

void WatchNotes::tellFrame(const std::string& fault) {
  tellOnce(told_frame_, fault);
}

void WatchNotes::tellOfSet(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    std::string kind;
    std::copy_if(note.begin(), note.end(), std::back_inserter(kind),
                 [](unsigned char c) { return std::isdigit(c) == 0; });
    if (told_of_set_.insert(kind).second) sink_.note(note);
  }
}

void WatchNotes::tellRemoved(const std::vector<fs::path>& files) {
  if (files.empty()) return;
  const std::string others = files.size() > 1 ? " and " + std::to_string(files.size() - 1) + " others" : "";
  sink_.note(files.front().string() + others +
             ": no longer among the scans of the folder; the map keeps what came from there until it is retracted");
}

void WatchNotes::tellReplacedBefore(const fs::path& file, const std::vector<scan::ScanId>& earlier,
                                    const WatchedScans& watched) {
  for (const scan::ScanId& id : earlier)
    if (!watched.isHeld(id))
      sink_.note(file.string() + ": the map has another scan from a file of this name, cloud " + id.hex() +
                 "; retract it if this file has replaced that scan");
}

void WatchNotes::tellOnce(std::string& told, const std::string& message) {
  if (std::exchange(told, message) != message && !message.empty()) sink_.note(message);
}

}  // namespace cluxel::mapping
