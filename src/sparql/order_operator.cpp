// SPDX-License-Identifier: Apache-2.0
// ORDER BY, with LIMIT as a selection of the least rows.
#include <algorithm>

#include "sparql/comparison.hpp"
#include "sparql/operators.hpp"
#include "sparql/order_key.hpp"
#include "sparql/row_table.hpp"
#include "sparql/values_ahead.hpp"

namespace cluxel::sparql {
namespace {

class OrderOperator : public UnaryOperator {
 public:
  OrderOperator(OperatorPtr child, std::vector<SortKey> keys, std::vector<Slot> tie_slots,
                std::optional<std::uint64_t> most_rows, std::vector<ExistsPlan> exists)
      : UnaryOperator(std::move(child)),
        keys_(std::move(keys)),
        most_rows_(most_rows),
        exists_(std::move(exists)),
        table_(child_->slots()) {
    for (const SortKey& key : keys_) ahead_.add(key.expression);
    for (const Slot slot : tie_slots) {
      const auto at = std::find(slots_.begin(), slots_.end(), slot);
      if (at != slots_.end()) tie_columns_.push_back(static_cast<std::size_t>(at - slots_.begin()));
    }
  }
  std::string label(const PlanNames& names) const override {
    std::string text = most_rows_ ? "first " + std::to_string(*most_rows_) + " by" : "sort by";
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
      if (most_rows_ && isCrowded(*most_rows_)) keepLeast();
    }
    sortAll();
  }

  /// More than twice as many rows as are wanted, which may be more than can be counted.
  bool isCrowded(std::uint64_t wanted) const {
    return table_.rows() > kSpareRows && (table_.rows() - kSpareRows) / 2 > wanted;
  }

  void take(const Batch& in, Evaluator& evaluator) {
    picks_.clear();
    for (std::uint32_t row = 0; row < in.rows; ++row) {
      ahead_.before(row, in, runtime().terms);
      const std::size_t before = fast_.size();
      for (std::size_t i = 0; i < keys_.size(); ++i) addKey(i, evaluator.value(keys_[i].expression, in, row), row == 0);
      if (is_full_ && !beatsLast(in, row, before)) {
        fast_.resize(before);
      } else {
        picks_.push_back(row);
      }
    }
    table_.append(in, picks_, runtime().guard);
    runtime().guard.charge(picks_.size() * keys_.size() * sizeof(OrderKey));
  }

  void addKey(std::size_t column, const Value& value, bool is_first) {
    const std::size_t width = keys_.size();
    const std::span<OrderKey> made = std::span(fast_).first(fast_.size() / width * width);
    const auto earlier = made.empty() ? made : made.subspan(column);
    fast_.push_back(columns_[column].add(value, runtime().terms, earlier, width));
    if (is_first && fast_.back().text != nullptr) ahead_.addTexts(keys_[column].expression);
  }

  void sortAll() {
    order_.resize(table_.rows());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    const auto before = [this](std::uint32_t a, std::uint32_t b) { return isBefore(a, b); };
    if (most_rows_ && *most_rows_ < order_.size()) {
      const auto middle = order_.begin() + static_cast<std::ptrdiff_t>(*most_rows_);
      std::nth_element(order_.begin(), middle, order_.end(), before);
      order_.erase(middle, order_.end());
    }
    std::sort(order_.begin(), order_.end(), before);
  }

  /// Drops all but the least rows, in order: from then on the last of them is what others have to beat.
  void keepLeast() {
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
    is_full_ = *most_rows_ > 0 && order_.size() == *most_rows_;
  }

  /// Less than 0: the row with the keys from `a` on comes before that with those from `b` on.
  std::strong_ordering orderOfKeys(std::size_t a, std::size_t b) const {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const auto order = compareKeys(fast_[a + i], fast_[b + i], runtime().terms);
      if (order != 0) return keys_[i].descending ? 0 <=> order : order;
    }
    return std::strong_ordering::equal;
  }

  bool isBefore(std::uint32_t a, std::uint32_t b) const {
    const auto order = orderOfKeys(a * keys_.size(), b * keys_.size());
    if (order != 0) return order < 0;
    const ValueId* left = table_.row(a);
    const ValueId* right = table_.row(b);
    return isTieBefore([&](std::size_t column) { return left[column]; }, right);
  }

  /// Whether a row, whose keys begin at `keys`, comes before the last of those kept.
  bool beatsLast(const Batch& in, std::size_t row, std::size_t keys) const {
    const std::size_t last = *most_rows_ - 1;
    const auto order = orderOfKeys(keys, last * keys_.size());
    if (order != 0) return order < 0;
    return isTieBefore([&](std::size_t column) { return in.at(slots_[column], row); }, table_.row(last));
  }

  /// Rows of equal keys are ordered by their terms, so that LIMIT cuts at the same place every time.
  template <typename IdAt>
  bool isTieBefore(const IdAt& left, const ValueId* right) const {
    for (const std::size_t column : tie_columns_) {
      if (left(column) == right[column]) continue;
      const auto order = termOrderOf(left(column), right[column], runtime().terms);
      if (order != 0) return order < 0;
    }
    return false;
  }

  /// Rows kept beyond those wanted before they are cut.
  static constexpr std::size_t kSpareRows = 256;
  std::vector<SortKey> keys_;
  std::vector<std::size_t> tie_columns_;
  std::optional<std::uint64_t> most_rows_;
  std::vector<ExistsPlan> exists_;
  RowTable table_;
  std::vector<OrderKey> fast_;  ///< of each row of the table
  std::vector<OrderColumn> columns_;
  ValuesAhead ahead_;
  std::vector<std::uint32_t> order_, picks_;
  bool is_full_ = false;  ///< the first rows of the table are the least so far, in order
  bool done_ = false, fresh_ = true;
  std::size_t given_ = 0;
};

}  // namespace

OperatorPtr makeOrder(OperatorPtr child, std::vector<SortKey> keys, std::vector<Slot> tie_slots,
                      std::optional<std::uint64_t> most_rows, std::vector<ExistsPlan> exists) {
  return std::make_unique<OrderOperator>(std::move(child), std::move(keys), std::move(tie_slots), most_rows,
                                         std::move(exists));
}

}  // namespace cluxel::sparql
