// SPDX-License-Identifier: Apache-2.0
// The index scan of a pattern, by blocks of the mapped pages.
#include "sparql/exec/operators/operators.hpp"
#include "sparql/plan/pattern_access.hpp"

namespace cluxel::sparql {
namespace {

const char* nameOf(rdf::QuadOrder order) {
  switch (order) {
    case rdf::QuadOrder::Spog:
      return "spog";
    case rdf::QuadOrder::Posg:
      return "posg";
    case rdf::QuadOrder::Ospg:
      return "ospg";
    case rdf::QuadOrder::Gspo:
      return "gspo";
    case rdf::QuadOrder::Psog:
      return "psog";
  }
  return "";
}

class ScanOperator : public Operator {
 public:
  ScanOperator(const TripleNode& pattern, rdf::QuadOrder order) : pattern_(pattern), order_(order) {
    std::vector<Slot> slots;
    for (const PatternPlace& place : placesOfPattern(pattern)) {
      if (place.isSlot()) slots.push_back(place.slot);
    }
    slots_ = mergedSlots(slots, {});
  }
  std::string label(const PlanNames& names) const override {
    return "scan " + std::string(nameOf(order_)) + "  " + describe(pattern_, names.query, names.terms);
  }

 protected:
  void reopen(bool) override {
    filter_ = graphFilterOf(pattern_, runtime().dataset);
    BoundMask mask = 0;
    rdf::QuadPattern pattern;
    const auto bind = [&](const PatternPlace& place, std::optional<rdf::TermId>& id, unsigned bit) {
      if (place.isSlot()) return;
      id = place.constant;
      mask |= bit;
    };
    bind(pattern_.subject, pattern.s, 1);
    bind(pattern_.predicate, pattern.p, 2);
    bind(pattern_.object, pattern.o, 4);
    if (pattern_.graph.kind == GraphPlace::Kind::Constant) {
      pattern.g = pattern_.graph.constant;
      mask |= 8;
    } else if (filter_.kind == GraphFilter::Kind::One && pattern_.graph.kind == GraphPlace::Kind::Default) {
      pattern.g = filter_.graph;
      mask |= 8;
    }
    bound_ = {pattern.s.value_or(0), pattern.p.value_or(0), pattern.o.value_or(0), pattern.g.value_or(0)};
    reader_ = EntryReader(pattern_, filter_, order_, mask);
    cursor_ = runtime().reader.scan(pattern, order_);
    block_ = {};
  }

  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (block_.empty()) {
        block_ = cursor_.nextBlock();
        if (block_.empty()) break;
        runtime().guard.work(block_.size());
      }
      take(out);
    }
    return out.rows > 0;
  }

 private:
  void take(Batch& out) {
    const std::size_t room = std::min(block_.size(), target() - out.rows);
    picked_.clear();
    if (reader_.admitsAll()) {
      for (std::uint32_t i = 0; i < room; ++i) picked_.push_back(i);
    } else {
      for (std::uint32_t i = 0; i < room; ++i) {
        if (reader_.admits(block_[i], bound_)) picked_.push_back(i);
      }
    }
    for (const auto& output : reader_.outputs()) {
      auto& column = out.columns[output.slot];
      column.resize(out.rows + picked_.size());
      ValueId* target = column.data() + out.rows;
      for (const std::uint32_t i : picked_) *target++ = block_[i].at(output.position);
    }
    out.rows += picked_.size();
    block_ = block_.subspan(room);
  }

  TripleNode pattern_;
  rdf::QuadOrder order_;
  GraphFilter filter_;
  EntryReader reader_;
  rdf::QuadCursor cursor_;
  std::span<const rdf::QuadKey> block_;
  std::array<ValueId, 4> bound_{};
  std::vector<std::uint32_t> picked_;
};

}  // namespace

OperatorPtr makeScan(const TripleNode& pattern, rdf::QuadOrder order) {
  return std::make_unique<ScanOperator>(pattern, order);
}

}  // namespace cluxel::sparql
