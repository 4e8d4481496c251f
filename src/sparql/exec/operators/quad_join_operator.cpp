// SPDX-License-Identifier: Apache-2.0
// The index nested loop join: for each solution, a prefix lookup in the best index, or in a subject column of the
// predicate.
#include <algorithm>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/spatial/subject_column.hpp"
#include "sparql/plan/pattern_access.hpp"

namespace cluxel::sparql {
namespace {

class QuadJoinOperator : public UnaryOperator {
 public:
  QuadJoinOperator(OperatorPtr child, const TripleNode& pattern, bool by_column)
      : UnaryOperator(std::move(child)), pattern_(pattern), places_(placesOfPattern(pattern)), by_column_(by_column) {
    std::vector<Slot> own;
    for (const PatternPlace& place : places_) {
      if (place.isSlot()) own.push_back(place.slot);
    }
    for (const Slot slot : child_->slots()) {
      if (std::find(own.begin(), own.end(), slot) == own.end()) carried_.push_back(slot);
    }
    slots_ = mergedSlots(slots_, own);
  }

  std::string label(const PlanNames& names) const override {
    return (by_column_ ? "lookup by column  " : "lookup  ") + describe(pattern_, names.query, names.terms);
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    if (fresh || access_.empty()) {
      access_.clear();
      access_.resize(16);
      filter_ = graphFilterOf(pattern_, runtime().dataset);
      may_have_column_ = places_[0].isSlot() && !places_[1].isSlot() && places_[1].constant < kFirstComputed &&
                         places_[2].constant < kFirstComputed && pattern_.not_predicates.empty() &&
                         pattern_.graph.kind == GraphPlace::Kind::Default && hasColumns(filter_);
      kept_.reset();
      column_ = nullptr;
    }
    in_.columns.resize(runtime().slot_count);
    in_.rows = 0;
    row_ = expected_until_ = 0;
    active_ = nullptr;
    run_ = {};
  }

  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (active_ == nullptr && run_.empty() && !nextRow(out)) break;
      if (!run_.empty()) emitRun(out);
      if (active_ != nullptr) emit(out);
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  /// The access path for one set of bound positions.
  struct Access {
    OrderChoice choice;
    EntryReader reader;
    rdf::PrefixLookup lookup;
    rdf::QuadCursor cursor;  ///< used when nothing is bound
    std::array<std::uint8_t, 4> order_places{};
    std::vector<rdf::TermId> expected;  ///< prefixes of the next rows, for prefetching

    std::array<rdf::TermId, 4> prefixOf(const std::array<ValueId, 4>& bound) const {
      std::array<rdf::TermId, 4> prefix{};
      for (std::size_t i = 0; i < choice.prefix; ++i) prefix[i] = bound[order_places[i]];
      return prefix;
    }
  };

  /// Advances to the next child row and starts its lookup in active_; false at the end.
  bool nextRow(Batch& out) {
    while (true) {
      if (row_ >= in_.rows) {
        finishSegment(out);
        if (!child_->next(in_)) return false;
        row_ = expected_until_ = 0;
      }
      if (row_ >= expected_until_) expectRows();
      current_ = row_++;
      if (column_ != nullptr ? beginInColumn(current_) : begin(current_)) return true;
      if (out.rows >= target()) return true;
    }
  }

  /// Copies the ids bound by a row to bound_; none when the row cannot match.
  std::optional<BoundMask> bind(std::size_t row) {
    BoundMask mask = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const PatternPlace& place = places_[i];
      ValueId id = place.constant;
      if (place.isSlot()) id = in_.at(place.slot, row);
      bound_[i] = id;
      if (id == kUnbound) continue;
      if (id >= kFirstComputed) return std::nullopt;
      mask |= 1u << i;
    }
    if (pattern_.graph.kind == GraphPlace::Kind::Default) {
      if (filter_.kind == GraphFilter::Kind::One) {
        bound_[3] = filter_.graph;
        mask |= 8;
      }
    } else if ((mask & 8) != 0 && !filter_.admits(bound_[3])) {
      return std::nullopt;
    }
    return mask;
  }

  /// Prefetches the index positions of the next rows.
  void expectRows() {
    expected_until_ = std::min(row_ + kTogether, in_.rows);
    if (expected_until_ - row_ < kFewRows) return;
    if (may_have_column_ && expectInColumn()) return;
    for (std::size_t row = row_; row < expected_until_; ++row) {
      const auto mask = bind(row);
      if (!mask) continue;
      Access& access = accessFor(*mask);
      const auto prefix = access.prefixOf(bound_);
      access.expected.insert(access.expected.end(), prefix.begin(), prefix.begin() + access.choice.prefix);
    }
    for (const auto& access : access_) {
      if (!access || access->expected.empty()) continue;
      access->lookup.expect(access->expected, access->choice.prefix);
      access->expected.clear();
    }
  }

  /// Prefetches in the subject column; false when there is none.
  bool expectInColumn() {
    const auto& subjects = in_.columns[places_[0].slot];
    if (subjects.size() < expected_until_) return false;
    if (column_ == nullptr) {
      if (!kept_) kept_ = keptColumn(runtime().reader, {places_[1].constant, places_[2].constant}, filter_);
      may_have_column_ = runtime().guard.hasRoomFor(2 * kept_->bytes());
      if (!may_have_column_) return false;
      column_ = kept_->after(expected_until_ - row_, by_column_, runtime().reader, filter_, runtime().guard);
      if (column_ == nullptr) return false;
      runtime().guard.chargeOnce(column_, column_->bytes());
    }
    column_->expect({subjects.data() + row_, expected_until_ - row_});
    return true;
  }

  /// begin() for the subject column.
  bool beginInColumn(std::size_t row) {
    const ValueId subject = in_.at(places_[0].slot, row);
    if (subject == kUnbound) return begin(row);
    const ValueId object =
        places_[2].isSlot() ? in_.at(places_[2].slot, row) : kUnbound;  // constants are handled by the column
    run_ = object == kUnbound ? column_->find(subject) : column_->find(subject, object);
    if (run_.empty()) runtime().guard.work(1);
    return !run_.empty();
  }

  void emitRun(Batch& out) {
    const std::size_t taken = std::min(run_.size(), target() - out.rows);
    auto& subjects = padded(out.columns[places_[0].slot], out.rows);
    subjects.insert(subjects.end(), taken, run_.front().subject);
    if (places_[2].isSlot() && places_[2].slot != places_[0].slot) {
      auto& objects = padded(out.columns[places_[2].slot], out.rows);
      for (const SubjectColumn::Row& row : run_.first(taken)) objects.push_back(row.object);
    }
    from_.insert(from_.end(), taken, static_cast<std::uint32_t>(current_));
    out.rows += taken;
    run_ = run_.subspan(taken);
  }

  /// Starts the lookup of a row; false when the row cannot match.
  bool begin(std::size_t row) {
    const auto mask = bind(row);
    if (!mask) return false;
    Access& access = accessFor(*mask);
    access.reader.restart();
    if (access.choice.prefix == 0) {
      access.cursor = runtime().reader.scan(rdf::QuadPattern{}, rdf::QuadOrder::Spog);
      block_ = access.cursor.nextBlock();
    } else {
      const auto prefix = access.prefixOf(bound_);
      block_ = access.lookup.find({prefix.data(), access.choice.prefix});
    }
    if (block_.empty()) {
      runtime().guard.work(1);
      return false;
    }
    active_ = &access;
    return true;
  }

  Access& accessFor(BoundMask mask) {
    std::unique_ptr<Access>& access = access_[mask];
    if (!access) {
      access = std::make_unique<Access>();
      access->choice = chooseOrder(mask);
      access->order_places = placesOf(access->choice.order);
      access->reader = EntryReader(pattern_, filter_, access->choice.order, mask);
      if (access->choice.prefix > 0) access->lookup = runtime().reader.lookup(access->choice.order);
    }
    return *access;
  }

  void emit(Batch& out) {
    Access& access = *active_;
    std::size_t used = 0;
    const std::size_t room = target() - out.rows;
    std::size_t taken = 0;
    for (; used < block_.size() && taken < room; ++used) {
      if (!access.reader.admits(block_[used], bound_)) continue;
      ++taken;
      for (const auto& output : access.reader.outputs()) {
        padded(out.columns[output.slot], out.rows).push_back(block_[used].at(output.position));
      }
      for (std::size_t i = 0; i < 4; ++i) {
        if (places_[i].isSlot() && bound_[i] != kUnbound) writeBound(out, places_[i].slot, bound_[i]);
      }
      ++out.rows;
      from_.push_back(static_cast<std::uint32_t>(current_));
    }
    block_ = block_.subspan(used);
    runtime().guard.work(used - taken);
    if (!block_.empty()) return;
    block_ = access.choice.prefix == 0 ? access.cursor.nextBlock() : access.lookup.more();
    if (block_.empty()) active_ = nullptr;
  }

  static std::vector<ValueId>& padded(std::vector<ValueId>& column, std::size_t rows) {
    if (column.size() != rows) column.resize(rows, kUnbound);
    return column;
  }

  /// A slot may occur at two positions of the pattern.
  static void writeBound(Batch& out, Slot slot, ValueId id) {
    auto& column = out.columns[slot];
    if (column.size() == out.rows + 1) {
      column.back() = id;
    } else {
      padded(column, out.rows).push_back(id);
    }
  }

  /// Copies the unchanged columns for the rows produced from the current batch.
  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    appendRows(in_, from_, carried_, out.rows - from_.size(), out);
    from_.clear();
  }

  TripleNode pattern_;
  QuadPlaces places_;
  bool by_column_;  ///< the plan expects a subject column
  bool may_have_column_ = false;
  std::shared_ptr<const KeptColumn> kept_;
  const SubjectColumn* column_ = nullptr;
  std::span<const SubjectColumn::Row> run_;  ///< the column's rows for the current row
  std::vector<Slot> carried_;
  GraphFilter filter_;
  std::vector<std::unique_ptr<Access>> access_;
  Batch in_;
  static constexpr std::size_t kTogether = 64, kFewRows = 4;
  std::size_t row_ = 0, current_ = 0, expected_until_ = 0;
  std::array<ValueId, 4> bound_{};
  std::span<const rdf::QuadKey> block_;
  Access* active_ = nullptr;
  std::vector<std::uint32_t> from_;
};

}  // namespace

OperatorPtr makeQuadJoin(OperatorPtr child, const TripleNode& pattern, bool by_column) {
  return std::make_unique<QuadJoinOperator>(std::move(child), pattern, by_column);
}

}  // namespace cluxel::sparql
