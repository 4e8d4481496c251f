// SPDX-License-Identifier: Apache-2.0
// Evaluates a pattern for the stored geometries around a place, the nearest first, until the consumer has enough.
#include <algorithm>
#include <queue>

#include "rdf/store/geometry_index.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/spatial/range_test.hpp"

namespace cluxel::sparql {
namespace {

class NearestSourceOperator : public Operator {
 public:
  NearestSourceOperator(OperatorPtr places, Pipeline body, NearestScan scan)
      : places_(std::move(places)), body_(std::move(body)), scan_(std::move(scan)) {
    slots_ = body_.top->slots();
    std::erase(slots_, body_.origin);
  }
  std::string label(const PlanNames& names) const override {
    return "nearest first by R-tree  ?" + names.query.slot_names[scan_.slot] + " around " +
           describe(scan_.place, names.query, names.terms);
  }
  void stopWhen(std::function<bool(double)> is_enough) override { is_enough_ = std::move(is_enough); }

 protected:
  void reopen(bool) override {
    places_->open(runtime(), true);
    index_ = runtime().reader.geometries();
    rows_ = Batch(runtime().slot_count);
    chunk_ = Batch(runtime().slot_count);
    first_.clear();
    given_ = 0;
    streams_.clear();
    queue_ = {};
    started_ = active_ = false;
    is_fresh_ = true;
    chunk_rows_ = kFirstChunk;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    inputs.push_back(places_.get());
    inputs.push_back(body_.top.get());
  }
  bool produce(Batch& out) override {
    if (!started_) start();
    while (true) {
      if (active_ && body_.top->next(out)) {
        out.columns[body_.origin].clear();
        return true;
      }
      out.reset();
      active_ = nextChunk();
      if (!active_) return false;
      body_.start(runtime(), chunk_, is_fresh_);
      is_fresh_ = false;
    }
  }

 private:
  using Candidate = std::pair<std::uint32_t, ValueId>;  ///< row of rows_, geometry
  struct Next {
    double min_distance;
    std::size_t stream;
    bool operator<(const Next& other) const { return min_distance > other.min_distance; }
  };
  struct Stream {
    std::uint32_t row;
    rdf::NearestGeometries geometries;
    rdf::NearestGeometries::Found found;
  };

  /// Reads the places. What has no known distance comes first, as ORDER BY has it.
  void start() {
    started_ = true;
    const auto strange = strangeObjects();
    Batch in(runtime().slot_count);
    while (places_->next(in)) {
      for (std::uint32_t row = 0; row < in.rows; ++row) startAround(in, row, *strange);
    }
  }

  void startAround(const Batch& in, std::uint32_t row, const std::vector<ValueId>& strange) {
    const auto place_row = static_cast<std::uint32_t>(rows_.rows);
    appendRows(in, {row}, places_->slots(), rows_.rows, rows_);
    ++rows_.rows;
    padColumns(rows_, places_->slots());
    for (const ValueId id : strange) first_.emplace_back(place_row, id);
    Evaluator evaluator(runtime());
    const KnownBox place = mapBoxOf(evaluator.value(scan_.place, in, row), runtime().functions);
    if (place.known != Known::Value) {
      constexpr float kFar = std::numeric_limits<float>::infinity();
      for (const rdf::TermId id : index_->meeting({-kFar, -kFar, kFar, kFar})) first_.emplace_back(place_row, id);
      return;
    }
    for (const rdf::TermId id : index_->loose()) first_.emplace_back(place_row, id);
    const Box2& box = place.box;
    streams_.push_back({place_row, {index_, rdf::FlatBox::around(box.min_x, box.min_y, box.max_x, box.max_y)}, {}});
    advance(streams_.size() - 1);
  }

  void advance(std::size_t stream) {
    Stream& one = streams_[stream];
    if (one.geometries.next(one.found)) queue_.push({one.found.min_distance, stream});
  }

  /// The objects of the predicate that are not geometries, which the index does not hold. Kept for the commit.
  std::shared_ptr<const std::vector<ValueId>> strangeObjects() {
    const rdf::QuadReader& reader = runtime().reader;
    const std::string name = "no geometries of " + std::to_string(scan_.predicate);
    auto known = std::static_pointer_cast<const std::vector<ValueId>>(reader.kept(name));
    if (known) return known;
    const auto wkt = reader.idOf(Term::iri(std::string(rdf::vocabulary::kGeo) + "wktLiteral"));
    rdf::QuadPattern pattern;
    pattern.p = scan_.predicate;
    rdf::QuadCursor cursor = reader.scan(pattern, rdf::QuadOrder::Posg);
    auto strange = std::make_shared<std::vector<ValueId>>();
    rdf::TermId last = rdf::kNoTerm;
    for (auto block = cursor.nextBlock(); !block.empty(); block = cursor.nextBlock()) {
      for (const rdf::QuadKey& key : block) {
        const rdf::TermId object = key.at(1);
        if (object == last) continue;
        last = object;
        if (!wkt || reader.valueOf(object).datatype != *wkt) strange->push_back(object);
      }
      runtime().guard.work(block.size());
    }
    reader.keep(name, strange);
    return strange;
  }

  /// Fills chunk_ with the next candidates; false when none is left or wanted.
  bool nextChunk() {
    std::vector<Candidate> candidates;
    while (given_ < first_.size() && candidates.size() < kLastChunk) candidates.push_back(first_[given_++]);
    if (candidates.empty() && !queue_.empty() && is_enough_ && is_enough_(queue_.top().min_distance)) return false;
    while (candidates.size() < chunk_rows_ && given_ == first_.size() && !queue_.empty()) {
      const Next next = queue_.top();
      queue_.pop();
      candidates.emplace_back(streams_[next.stream].row, streams_[next.stream].found.literal);
      advance(next.stream);
    }
    chunk_rows_ = std::min(chunk_rows_ * 2, kLastChunk);
    if (candidates.empty()) return false;
    chunk_.reset();
    std::vector<std::uint32_t> picks;
    auto& geometries = chunk_.columns[scan_.slot];
    for (const auto& [row, geometry] : candidates) {
      picks.push_back(row);
      geometries.push_back(geometry);
    }
    appendRows(rows_, picks, places_->slots(), 0, chunk_);
    chunk_.rows = candidates.size();
    runtime().guard.work(chunk_.rows);
    return true;
  }

  static constexpr std::size_t kFirstChunk = 64, kLastChunk = 2048;
  OperatorPtr places_;
  Pipeline body_;
  NearestScan scan_;
  std::function<bool(double)> is_enough_;
  std::shared_ptr<const rdf::GeometryIndex> index_;
  Batch rows_, chunk_;
  std::vector<Candidate> first_;  ///< candidates without a known distance
  std::size_t given_ = 0;
  std::vector<Stream> streams_;
  std::priority_queue<Next> queue_;
  bool started_ = false, active_ = false, is_fresh_ = true;
  std::size_t chunk_rows_ = kFirstChunk;
};

}  // namespace

OperatorPtr makeNearestSource(OperatorPtr places, Pipeline body, NearestScan scan) {
  return std::make_unique<NearestSourceOperator>(std::move(places), std::move(body), std::move(scan));
}

}  // namespace cluxel::sparql
