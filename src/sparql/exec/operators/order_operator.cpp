// SPDX-License-Identifier: Apache-2.0
// ORDER BY; with LIMIT a top-k selection.
#include <algorithm>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/order_key.hpp"
#include "sparql/exec/row_table.hpp"
#include "sparql/exec/values_ahead.hpp"
#include "sparql/values/comparison.hpp"

namespace cluxel::sparql {
namespace {

class OrderOperator : public UnaryOperator {
 public:
  OrderOperator(OperatorPtr child, std::vector<SortKey> keys, std::vector<Expr> ties,
                std::optional<std::uint64_t> max_rows, std::vector<ExistsPlan> exists)
      : UnaryOperator(std::move(child)),
        keys_(std::move(keys)),
        max_rows_(max_rows),
        exists_(std::move(exists)),
        table_(child_->slots()) {
    for (const SortKey& key : keys_) ahead_.add(key.expression);
    for (Expr& tie : ties) {
      const auto at = std::find(slots_.begin(), slots_.end(), tie.slot);
      if (tie.kind != Expr::Kind::Slot)
        ties_.push_back({kNoColumn, std::move(tie)});
      else if (at != slots_.end())
        ties_.push_back({static_cast<std::size_t>(at - slots_.begin()), {}});
    }
    if (max_rows_) child_->stopWhen([this](double distance) { return isEnough(distance); });
  }
  std::string label(const PlanNames& names) const override {
    std::string text = max_rows_ ? "first " + std::to_string(*max_rows_) + " by" : "sort by";
    for (const SortKey& key : keys_) {
      text += (key.descending ? " desc " : " ") + describe(key.expression, names.query, names.terms);
    }
    return text;
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    fresh_ = fresh;
    done_ = false;
    given_ = 0;
    table_.clear(runtime().guard);
    runtime().guard.release(fast_.size() * sizeof(OrderKey));
    fast_.clear();
    columns_.assign(keys_.size(), {});
    is_full_ = false;
    left_ = Batch(runtime().slot_count);
    right_ = Batch(runtime().slot_count);
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    for (const ExistsPlan& plan : exists_) inputs.push_back(plan.pipeline.top.get());
  }
  bool produce(Batch& out) override {
    if (!done_) collect();
    out.rows = std::min(order_.size() - given_, std::size_t{kLastTarget});
    for (std::size_t column = 0; column < slots_.size(); ++column) {
      auto& target = out.columns[slots_[column]];
      for (std::size_t i = 0; i < out.rows; ++i) target.push_back(table_.row(order_[given_ + i])[column]);
    }
    given_ += out.rows;
    return out.rows > 0;
  }

 private:
  void collect() {
    done_ = true;
    Batch in(runtime().slot_count);
    Evaluator evaluator(runtime());
    while (child_->next(in)) {
      if (!exists_.empty()) {
        answerExists(exists_, in, runtime(), fresh_);
        fresh_ = false;
      }
      take(in, evaluator);
      if (max_rows_ && isCrowded(*max_rows_)) keepFirst();
    }
    sortAll();
  }

  /// True when the buffer holds more than twice the requested rows; safe against overflow.
  bool isCrowded(std::uint64_t rows_needed) const {
    return table_.rows() > kSpareRows && (table_.rows() - kSpareRows) / 2 > rows_needed;
  }

  void take(const Batch& in, Evaluator& evaluator) {
    picks_.clear();
    if (fast_.size() + in.rows * keys_.size() > fast_.capacity())
      runtime().guard.requireRoomFor(fast_.size() * sizeof(OrderKey));
    for (std::uint32_t row = 0; row < in.rows; ++row) {
      ahead_.before(row, in, runtime().terms);
      const std::size_t before = fast_.size();
      const Value first = evaluator.value(keys_[0].expression, in, row);
      // A computed value gets a term only when its row may be kept.
      if (is_full_ && first.id == kUnbound &&
          !mayPrecede(first, fast_[(*max_rows_ - 1) * keys_.size()], keys_[0].descending, runtime().terms))
        continue;
      addKey(0, first);
      for (std::size_t i = 1; i < keys_.size(); ++i) addKey(i, evaluator.value(keys_[i].expression, in, row));
      if (is_full_ && !beatsLast(in, row, before)) {
        fast_.resize(before);
      } else {
        picks_.push_back(row);
      }
    }
    table_.append(in, picks_, runtime().guard);
    runtime().chargeForTerms();
    runtime().guard.charge(picks_.size() * keys_.size() * sizeof(OrderKey));
  }

  /// True when no row of this distance or more can be among the first rows; the first key is a distance.
  bool isEnough(double distance) {
    if (*max_rows_ == 0) return true;
    if (table_.rows() < *max_rows_) return false;
    keepFirst();
    return !mayPrecede(distance, fast_[(*max_rows_ - 1) * keys_.size()]);
  }

  void addKey(std::size_t column, const Value& value) {
    const std::size_t width = keys_.size();
    const std::span<OrderKey> made = std::span(fast_).first(fast_.size() / width * width);
    const auto earlier = made.empty() ? made : made.subspan(column);
    fast_.push_back(columns_[column].add(value, runtime().terms, earlier, width));
  }

  void sortAll() {
    runtime().guard.requireRoomFor(table_.rows() * sizeof(order_[0]));
    order_.resize(table_.rows());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    const auto before = [this](std::uint32_t a, std::uint32_t b) {
      runtime().guard.spend(kBytesOfComparison);
      return isBefore(a, b);
    };
    if (max_rows_ && *max_rows_ < order_.size()) {
      const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(*max_rows_);
      std::nth_element(order_.begin(), middle, order_.end(), before);
      order_.erase(middle, order_.end());
    }
    std::sort(order_.begin(), order_.end(), before);
  }

  /// Keeps the first rows in sort order; later rows must sort before the last of them.
  void keepFirst() {
    sortAll();
    RowTable kept(slots_);
    std::vector<OrderKey> fast;
    for (const std::uint32_t row : order_) {
      kept.cells().insert(kept.cells().end(), table_.row(row), table_.row(row) + slots_.size());
      fast.insert(fast.end(), fast_.begin() + static_cast<std::ptrdiff_t>(row * keys_.size()),
                  fast_.begin() + static_cast<std::ptrdiff_t>((row + 1) * keys_.size()));
    }
    kept.setRows(order_.size());
    runtime().guard.release((table_.rows() - order_.size()) *
                            (slots_.size() * sizeof(ValueId) + keys_.size() * sizeof(OrderKey)));
    table_ = std::move(kept);
    fast_ = std::move(fast);
    is_full_ = *max_rows_ > 0 && order_.size() == *max_rows_;
  }

  /// Three-way comparison of the rows whose keys start at `a` and `b`.
  std::strong_ordering orderOfKeys(std::size_t a, std::size_t b) const {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const auto order = compareKeys(fast_[a + i], fast_[b + i], runtime().terms);
      if (order != 0) return keys_[i].descending ? 0 <=> order : order;
    }
    return std::strong_ordering::equal;
  }

  bool isBefore(std::uint32_t a, std::uint32_t b) {
    const auto order = orderOfKeys(a * keys_.size(), b * keys_.size());
    if (order != 0) return order < 0;
    const ValueId *left = table_.row(a), *right = table_.row(b);
    return isTieBefore([left](std::size_t column) { return left[column]; }, right);
  }

  /// True when the row with these keys sorts before the last kept row.
  bool beatsLast(const Batch& in, std::size_t row, std::size_t keys) {
    const std::size_t last = *max_rows_ - 1;
    const auto order = orderOfKeys(keys, last * keys_.size());
    if (order != 0) return order < 0;
    return isTieBefore([&](std::size_t column) { return in.at(slots_[column], row); }, table_.row(last));
  }

  /// Orders rows with equal keys by their terms, so that LIMIT is deterministic.
  template <typename IdAt>
  bool isTieBefore(const IdAt& left, const ValueId* right) {
    for (const Tie& tie : ties_) {
      const bool is_column = tie.column != kNoColumn;
      const ValueId a = is_column ? left(tie.column) : computed(tie.expression, left, left_);
      const auto right_at = [right](std::size_t column) { return right[column]; };
      const ValueId b = is_column ? right[tie.column] : computed(tie.expression, right_at, right_);
      if (a == b) continue;
      const auto order = termOrderOf(a, b, runtime().terms);
      if (order != 0) return order < 0;
    }
    return false;
  }

  /// The term of an expression for one row.
  template <typename IdAt>
  ValueId computed(const Expr& expression, const IdAt& ids, Batch& scratch) {
    scratch.rows = 1;
    for (std::size_t column = 0; column < slots_.size(); ++column) scratch.columns[slots_[column]] = {ids(column)};
    return runtime().terms.intern(Evaluator(runtime()).value(expression, scratch, 0));
  }

  static constexpr std::size_t kBytesOfComparison = 16;
  /// Extra rows buffered before a selection.
  static constexpr std::size_t kSpareRows = 256;
  std::vector<SortKey> keys_;
  static constexpr std::size_t kNoColumn = static_cast<std::size_t>(-1);
  /// A column of the rows, or an expression over them.
  struct Tie {
    std::size_t column;
    Expr expression;
  };
  std::vector<Tie> ties_;
  Batch left_, right_;  ///< one row each, for expressions of ties
  std::optional<std::uint64_t> max_rows_;
  std::vector<ExistsPlan> exists_;
  RowTable table_;
  std::vector<OrderKey> fast_;  ///< keys of each row of the table
  std::vector<OrderColumn> columns_;
  ValuesAhead ahead_;
  std::vector<std::uint32_t> order_, picks_;
  bool is_full_ = false;  ///< the first rows of the table are the current top k, sorted
  bool done_ = false, fresh_ = true;
  std::size_t given_ = 0;
};

}  // namespace

OperatorPtr makeOrder(OperatorPtr child, std::vector<SortKey> keys, std::vector<Expr> ties,
                      std::optional<std::uint64_t> max_rows, std::vector<ExistsPlan> exists) {
  return std::make_unique<OrderOperator>(std::move(child), std::move(keys), std::move(ties), max_rows,
                                         std::move(exists));
}

}  // namespace cluxel::sparql
