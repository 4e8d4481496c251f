// SPDX-License-Identifier: Apache-2.0
// ORDER BY, with LIMIT as a selection of the least rows; and DISTINCT.
#include <algorithm>
#include <bit>
#include <cmath>

#include "sparql/comparison.hpp"
#include "sparql/operators.hpp"
#include "sparql/row_set.hpp"

namespace cluxel::sparql {
namespace {

/// A sort key that mostly decides by two numbers; equal ones are decided by their values.
struct FastKey {
  std::uint32_t rank = 0;
  ValueId id = kUnbound;
  std::uint64_t bits = 0;
};

std::uint64_t sortable(double number) {
  if (std::isnan(number)) return 0;
  if (number == 0) number = 0;   // -0 and 0 are equal
  const auto bits = std::bit_cast<std::uint64_t>(number);
  return (bits >> 63) != 0 ? ~bits : bits | (1ull << 63);
}

std::uint64_t sortable(std::string_view text) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    bits = bits << 8 | (i < text.size() ? static_cast<unsigned char>(text[i]) : 0u);
  }
  return bits;
}

FastKey fastKey(const Value& value, QueryTerms& terms) {
  FastKey key;
  key.id = terms.intern(value);
  key.rank = orderRankOf(value);
  if (value.isNumeric()) key.bits = sortable(value.number);
  if (value.isStringLike() || value.type == Value::Type::Iri) key.bits = sortable(terms.view(key.id).text);
  if (value.type == Value::Type::Boolean) key.bits = static_cast<std::uint64_t>(value.integer);
  return key;
}

class OrderOperator : public UnaryOperator {
 public:
  OrderOperator(OperatorPtr child, std::vector<SortKey> keys, std::vector<Slot> tie_slots,
                std::optional<std::uint64_t> most_rows, std::vector<ExistsPlan> exists)
      : UnaryOperator(std::move(child)), keys_(std::move(keys)), most_rows_(most_rows), exists_(std::move(exists)),
        table_(child_->slots()) {
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
    fast_.clear();
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
      table_.append(in, runtime().guard);
      runtime().guard.charge(in.rows * keys_.size() * sizeof(FastKey));
      for (std::size_t row = 0; row < in.rows; ++row) {
        for (const SortKey& key : keys_) fast_.push_back(fastKey(evaluator.value(key.expression, in, row), runtime().terms));
      }
      if (most_rows_ && table_.rows() > 2 * *most_rows_ + 4096) keepLeast();
    }
    sortAll();
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

  /// Drops all but the least rows.
  void keepLeast() {
    sortAll();
    RowTable kept(slots_);
    std::vector<FastKey> fast;
    for (const std::uint32_t row : order_) {
      kept.cells().insert(kept.cells().end(), table_.row(row), table_.row(row) + slots_.size());
      fast.insert(fast.end(), fast_.begin() + static_cast<std::ptrdiff_t>(row * keys_.size()),
                  fast_.begin() + static_cast<std::ptrdiff_t>((row + 1) * keys_.size()));
    }
    kept.setRows(order_.size());
    runtime().guard.release((table_.rows() - order_.size()) * (slots_.size() * sizeof(ValueId) + keys_.size() * sizeof(FastKey)));
    table_ = std::move(kept);
    fast_ = std::move(fast);
  }

  bool isBefore(std::uint32_t a, std::uint32_t b) const {
    const QueryTerms& terms = runtime().terms;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const FastKey& x = fast_[a * keys_.size() + i];
      const FastKey& y = fast_[b * keys_.size() + i];
      std::strong_ordering order = std::strong_ordering::equal;
      if (x.rank != y.rank) {
        order = x.rank <=> y.rank;
      } else if (x.bits != y.bits) {
        order = x.bits <=> y.bits;
      } else if (x.id != y.id) {
        order = valueOrderOf(terms.valueOf(x.id), terms.valueOf(y.id), terms);
      }
      if (order != 0) return keys_[i].descending ? order > 0 : order < 0;
    }
    const ValueId* left = table_.row(a);
    const ValueId* right = table_.row(b);
    for (const std::size_t column : tie_columns_) {
      if (left[column] == right[column]) continue;
      const auto order = termOrderOf(terms.valueOf(left[column]), terms.valueOf(right[column]), terms);
      if (order != 0) return order < 0;
    }
    return false;
  }

  std::vector<SortKey> keys_;
  std::vector<std::size_t> tie_columns_;
  std::optional<std::uint64_t> most_rows_;
  std::vector<ExistsPlan> exists_;
  RowTable table_;
  std::vector<FastKey> fast_;
  std::vector<std::uint32_t> order_;
  bool done_ = false, fresh_ = true;
  std::size_t given_ = 0;
};

class DistinctOperator : public UnaryOperator {
 public:
  DistinctOperator(OperatorPtr child, std::vector<Slot> slots)
      : UnaryOperator(std::move(child)), columns_(std::move(slots)), seen_(columns_.size()) {}
  std::string label(const PlanNames&) const override { return "distinct"; }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    seen_.clear();
    in_.columns.resize(runtime().slot_count);
  }
  bool produce(Batch& out) override {
    std::vector<ValueId> row(std::max<std::size_t>(columns_.size(), 1));
    while (child_->next(in_)) {
      kept_.clear();
      const std::size_t before = seen_.bytes();
      for (std::uint32_t i = 0; i < in_.rows; ++i) {
        for (std::size_t column = 0; column < columns_.size(); ++column) row[column] = in_.at(columns_[column], i);
        if (seen_.insert(row.data()).second) kept_.push_back(i);
      }
      runtime().guard.charge(seen_.bytes() - before);
      if (kept_.empty()) continue;
      appendRows(in_, kept_, slots_, 0, out);
      out.rows = kept_.size();
      return true;
    }
    return false;
  }

 private:
  std::vector<Slot> columns_;
  RowSet seen_;
  Batch in_;
  std::vector<std::uint32_t> kept_;
};

}  // namespace

OperatorPtr makeOrder(OperatorPtr child, std::vector<SortKey> keys, std::vector<Slot> tie_slots,
                      std::optional<std::uint64_t> most_rows, std::vector<ExistsPlan> exists) {
  return std::make_unique<OrderOperator>(std::move(child), std::move(keys), std::move(tie_slots), most_rows,
                                         std::move(exists));
}
OperatorPtr makeDistinct(OperatorPtr child, std::vector<Slot> slots) {
  return std::make_unique<DistinctOperator>(std::move(child), std::move(slots));
}

}  // namespace cluxel::sparql
