// SPDX-License-Identifier: Apache-2.0
// COUNT, SUM, AVG, MIN, MAX, SAMPLE, GROUP_CONCAT.
#include "sparql/functions/aggregate.hpp"

#include <algorithm>
#include <cmath>

#include "sparql/functions/functions.hpp"
#include "sparql/values/comparison.hpp"

namespace cluxel::sparql {

using Function = ast::AggregateFunction;

bool ExactSum::add(const Value& value, const QueryTerms& terms) {
  if (!value.isNumeric()) return false;
  type_ = std::max(type_, value.type);
  if (value.type == Value::Type::Float || value.type == Value::Type::Double) {
    addReal(value.number);
    return true;
  }
  if (value.type == Value::Type::Integer && !value.payload) {
    const std::int64_t before = small_;
    if (!__builtin_add_overflow(before, value.integer, &small_)) return true;
    exact_ = Decimal::add(exact_, Decimal(before)).value_or(exact_);
    small_ = value.integer;
    return true;
  }
  const auto sum = Decimal::add(exact_, terms.exactOf(value));
  if (sum) exact_ = *sum;
  return sum.has_value();
}

namespace {

/// Numbers above this limit are summed separately, scaled down by kScale. Intermediate overflow would depend on the
/// order of rows; now only an overflow of the final sum is reported.
constexpr double kGreat = 0x1p1000, kScale = 0x1p-100;

void addTo(std::vector<double>& partials, double value) {
  std::size_t kept = 0;
  for (double partial : partials) {
    if (std::abs(value) < std::abs(partial)) std::swap(value, partial);
    const double high = value + partial;
    const double low = partial - (high - value);
    if (low != 0) partials[kept++] = low;
    value = high;
  }
  partials.resize(kept);
  partials.push_back(value);
}

double totalOf(const std::vector<double>& partials) {
  double high = 0, low = 0;
  std::size_t i = partials.size();
  while (i > 0) {
    const double before = high;
    const double next = partials[--i];
    high = before + next;
    low = next - (high - before);
    if (low != 0) break;
  }
  // Ties are decided by the lower-order partials.
  if (i > 0 && ((low < 0 && partials[i - 1] < 0) || (low > 0 && partials[i - 1] > 0))) {
    const double twice = low * 2, shifted = high + twice;
    if (twice == shifted - high) high = shifted;
  }
  return high;
}

}  // namespace

void ExactSum::addReal(double value) {
  if (!std::isfinite(value)) {
    special_ += value;
    is_special_ = true;
  } else if (std::abs(value) >= kGreat) {
    addTo(great_partials_, value * kScale);
  } else {
    addTo(partials_, value);
  }
}

double ExactSum::realTotal() const {
  if (is_special_) return special_;
  if (totalOf(great_partials_) == 0) return totalOf(partials_);
  std::vector<double> all = great_partials_;  // combined before rounding
  for (const double partial : partials_) addTo(all, partial * kScale);
  return totalOf(all) / kScale;
}

Value ExactSum::total() const {
  const Decimal exact = Decimal::add(exact_, Decimal(small_)).value_or(exact_);
  switch (type_) {
    case Value::Type::Integer:
      return Value::ofInteger(exact);
    case Value::Type::Decimal:
      return Value::ofDecimal(exact);
    case Value::Type::Float:
      return Value::ofFloat(static_cast<float>(realTotal() + exact.toDouble()));
    default:
      return Value::ofDouble(exact.isZero() ? realTotal() : realTotal() + exact.toDouble());
  }
}

bool Accumulator::isRepeated(const AggregateSpec& spec, ValueId id, Runtime& runtime) {
  if (!spec.distinct) return false;
  if (!seen_) seen_ = std::make_unique<IdSet>();
  const std::size_t before = seen_->bytes();
  const bool is_new = seen_->insert(id);
  if (seen_->bytes() != before) runtime.guard.charge(seen_->bytes() - before);
  return !is_new;
}

void Accumulator::addId(const AggregateSpec& spec, ValueId id, Runtime& runtime) {
  if (spec.function == Function::Count) {
    if (id != kUnbound && !isRepeated(spec, id, runtime)) ++count_;
    return;
  }
  if (id != kUnbound && isRepeated(spec, id, runtime)) return;
  take(spec, runtime.terms.valueOf(id), runtime);
}

void Accumulator::add(const AggregateSpec& spec, const Value& value, Runtime& runtime) {
  if (value && spec.distinct && isRepeated(spec, runtime.terms.intern(value), runtime)) return;
  take(spec, value, runtime);
}

void Accumulator::countDistinctRow(std::span<const ValueId> row, Runtime& runtime) {
  if (!seen_rows_) seen_rows_ = std::make_unique<RowSet>(row.size());
  const std::size_t before = seen_rows_->bytes();
  if (seen_rows_->insert(row.data()).second) ++count_;
  if (seen_rows_->bytes() != before) runtime.guard.charge(seen_rows_->bytes() - before);
}

std::size_t Accumulator::bytes() const {
  return (seen_ ? seen_->bytes() : 0) + (seen_rows_ ? seen_rows_->bytes() : 0) +
         (texts_ ? texts_->size() * sizeof(Value) : 0);
}

void Accumulator::countText(const Value& value, const AggregateSpec& spec, Runtime& runtime) {
  std::string scratch;
  text_bytes_ += runtime.terms.textOf(value, scratch).size() + spec.separator.size();
  requireTextSize(text_bytes_);
}

void Accumulator::take(const AggregateSpec& spec, const Value& value, Runtime& runtime) {
  switch (spec.function) {
    case Function::Count:
      if (value) ++count_;
      return;
    case Function::Sum:
    case Function::Avg:
      if (!sum_) sum_ = std::make_unique<ExactSum>();
      ++count_;
      error_ = error_ || !sum_->add(value, runtime.terms);
      return;
    case Function::Sample:
      if (value && (!best_ || orderOf(value, best_, runtime.terms) < 0)) best_ = value;
      return;
    case Function::Min:
      error_ = error_ || !value;
      if (value && (!best_ || orderOf(value, best_, runtime.terms) < 0)) best_ = value;
      return;
    case Function::Max:
      error_ = error_ || !value;
      if (value && (!best_ || orderOf(value, best_, runtime.terms) > 0)) best_ = value;
      return;
    case Function::GroupConcat:
      error_ = error_ || !value || value.type == Value::Type::Blank;
      if (error_) return;
      if (!texts_) texts_ = std::make_unique<std::vector<Value>>();
      texts_->push_back(value);
      runtime.guard.charge(sizeof(Value));
      runtime.guard.spend(sizeof(Value));
      countText(value, spec, runtime);
      return;
  }
}

ValueId Accumulator::result(const AggregateSpec& spec, Runtime& runtime) {
  QueryTerms& terms = runtime.terms;
  switch (spec.function) {
    case Function::Count:
      return terms.intern(Value::ofInteger(static_cast<std::int64_t>(count_)));
    case Function::Sum:
      if (error_) return kUnbound;
      return terms.intern(sum_ ? sum_->total() : Value::ofInteger(0));
    case Function::Avg:
      if (error_) return kUnbound;
      if (!sum_) return terms.intern(Value::ofInteger(0));
      return terms.intern(divideValues(sum_->total(), Value::ofInteger(static_cast<std::int64_t>(count_)), terms));
    case Function::Sample:
      return terms.intern(best_);
    case Function::Min:
    case Function::Max:
      return error_ ? kUnbound : terms.intern(best_);
    case Function::GroupConcat:
      if (error_) return kUnbound;
      break;
  }
  std::string text;
  if (texts_) {
    std::stable_sort(texts_->begin(), texts_->end(),
                     [&terms](const Value& a, const Value& b) { return orderOf(a, b, terms) < 0; });
    for (std::size_t i = 0; i < texts_->size(); ++i) {
      if (i > 0) text += spec.separator;
      text += terms.textOf((*texts_)[i]);
    }
  }
  return terms.intern(Value::string(std::move(text)));
}

}  // namespace cluxel::sparql
