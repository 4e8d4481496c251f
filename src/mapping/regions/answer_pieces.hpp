// SPDX-License-Identifier: Apache-2.0
// Answers for parts of clouds wait in a temporary file until all parts of a cloud are there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/sorting/temporary_bytes.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/regions/answered_clouds.hpp"

namespace cluxel::mapping {

/// Answers for some points of a cloud. The arrays are parallel.
struct AnswerPiece {
  std::vector<std::uint32_t> point;  ///< number in the cloud, ascending
  PointAnswers answers;

  void add(std::size_t number, std::uint32_t cluxel, std::uint8_t label, std::uint32_t object) {
    point.push_back(static_cast<std::uint32_t>(number));
    answers.cluxel.push_back(cluxel);
    answers.label.push_back(label);
    answers.object.push_back(object);
  }
  void addTo(LabelledPoints& labelled) const {
    for (std::size_t i = 0; i < point.size(); ++i) labelled.emplace_back(point[i], answers.label[i]);
  }
};

[[noreturn]] inline void refuseOutside(const Cloud& cloud) {
  refuseDamaged(cloud.source + ": has points in tiles that are not there");
}

/// Keeps the pieces of all clouds in a file.
class AnswerPieces {
 public:
  void add(const Cloud& cloud, const AnswerPiece& piece) {
    if (piece.point.empty()) return;
    const PointAnswers& answers = piece.answers;
    std::string bytes;
    append(bytes, piece.point), append(bytes, answers.cluxel), append(bytes, answers.object);
    append(bytes, answers.label);
    places_[cloud.id].push_back({file_.append(bytes), piece.point.size()});
  }

  /// The pieces must have all points of the cloud, each once.
  PointAnswers join(const Cloud& cloud, std::size_t count) const {
    PointAnswers all{std::vector<std::uint32_t>(count), std::vector<std::uint8_t>(count),
                     std::vector<std::uint32_t>(count)};
    std::size_t joined = 0;
    forEachPiece(cloud, [&](const AnswerPiece& piece) {
      for (std::size_t i = 0; i < piece.point.size(); ++i) {
        all.cluxel.at(piece.point[i]) = piece.answers.cluxel[i];
        all.label[piece.point[i]] = piece.answers.label[i];
        all.object[piece.point[i]] = piece.answers.object[i];
      }
      joined += piece.point.size();
    });
    if (joined != count) refuseOutside(cloud);
    return all;
  }

  /// The points of the pieces, ascending, with their labels.
  LabelledPoints labelled(const Cloud& cloud) const {
    LabelledPoints all;
    forEachPiece(cloud, [&](const AnswerPiece& piece) { piece.addTo(all); });
    std::sort(all.begin(), all.end());
    return all;
  }

 private:
  struct Place {
    std::uint64_t begin = 0;
    std::size_t count = 0;
  };

  template <typename T>
  static void append(std::string& bytes, const std::vector<T>& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }

  template <typename Visit>
  void forEachPiece(const Cloud& cloud, const Visit& visit) const {
    if (const auto places = places_.find(cloud.id); places != places_.end())
      for (const Place& place : places->second) visit(read(place));
  }

  AnswerPiece read(const Place& place) const {
    AnswerPiece piece;
    std::uint64_t at = place.begin;
    const auto take = [&](auto& values) {
      values.resize(place.count);
      const std::size_t bytes = values.size() * sizeof(values[0]);
      file_.read(at, reinterpret_cast<char*>(values.data()), bytes);
      at += bytes;
    };
    take(piece.point), take(piece.answers.cluxel), take(piece.answers.object), take(piece.answers.label);
    return piece;
  }

  TemporaryBytes file_;
  std::unordered_map<scan::ScanId, std::vector<Place>> places_;
};

}  // namespace cluxel::mapping
