// SPDX-License-Identifier: Apache-2.0
// The small operators: sources of rows, LIMIT and projection.
#include <algorithm>
#include <iterator>

#include "sparql/exec/operators/operators.hpp"

namespace cluxel::sparql {

std::vector<const Operator*> Operator::inputs() const {
  std::vector<const Operator*> result;
  listInputs(result);
  return result;
}

std::vector<Slot> mergedSlots(const std::vector<Slot>& a, const std::vector<Slot>& b) {
  std::vector<Slot> sorted_a = a, sorted_b = b, merged;
  std::sort(sorted_a.begin(), sorted_a.end());
  std::sort(sorted_b.begin(), sorted_b.end());
  std::set_union(sorted_a.begin(), sorted_a.end(), sorted_b.begin(), sorted_b.end(), std::back_inserter(merged));
  merged.erase(std::unique(merged.begin(), merged.end()), merged.end());
  return merged;
}

bool UnitOperator::produce(Batch& out) {
  if (done_) return false;
  done_ = true;
  out.rows = 1;
  for (const Slot slot : slots_) out.columns[slot].assign(1, runtime().parameters[slot]);
  return true;
}

InputOperator::InputOperator(const std::vector<Slot>& slots, Slot origin) : origin_(origin) {
  slots_ = mergedSlots(slots, {origin});
}

bool InputOperator::produce(Batch& out) {
  if (done_ || batch_->rows == 0) return false;
  done_ = true;
  out.rows = batch_->rows;
  for (const Slot slot : slots_) {
    if (slot != origin_) out.columns[slot] = batch_->columns[slot];
  }
  auto& numbers = out.columns[origin_];
  numbers.resize(out.rows);
  for (std::size_t row = 0; row < out.rows; ++row) numbers[row] = static_cast<ValueId>(row);
  return true;
}

namespace {

class ValuesOperator : public Operator {
 public:
  ValuesOperator(std::vector<Slot> slots, IdRows rows, std::string note)
      : columns_(std::move(slots)), rows_(std::move(rows)), note_(std::move(note)) {
    slots_ = mergedSlots(columns_, {});
  }
  std::string label(const PlanNames& names) const override {
    if (note_.empty()) return "VALUES, " + std::to_string(rows_.count) + " rows";
    std::string text = note_;
    for (const Slot slot : columns_) text += " ?" + names.query.slot_names[slot];
    return text;
  }

 protected:
  void reopen(bool) override { next_ = 0; }
  bool produce(Batch& out) override {
    out.rows = std::min(rows_.count - next_, std::size_t{kLastTarget});
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      auto& target = out.columns[columns_[column]];
      for (std::size_t row = 0; row < out.rows; ++row)
        target.push_back(rows_.cells[(next_ + row) * columns_.size() + column]);
    }
    next_ += out.rows;
    return out.rows > 0;
  }

 private:
  std::vector<Slot> columns_;
  IdRows rows_;
  std::string note_;
  std::size_t next_ = 0;
};

class ProjectOperator : public UnaryOperator {
 public:
  ProjectOperator(OperatorPtr child, const std::vector<Slot>& slots) : UnaryOperator(std::move(child)) {
    std::erase_if(slots_, [&](Slot slot) { return std::find(slots.begin(), slots.end(), slot) == slots.end(); });
  }
  std::string label(const PlanNames& names) const override {
    std::string text = "columns";
    for (const Slot slot : slots_) text += " ?" + names.query.slot_names[slot];
    return text;
  }

 protected:
  bool produce(Batch& out) override { return child_->next(out); }
};

class SliceOperator : public UnaryOperator {
 public:
  SliceOperator(OperatorPtr child, std::uint64_t offset, std::optional<std::uint64_t> limit)
      : UnaryOperator(std::move(child)), offset_(offset), limit_(limit) {}
  std::string label(const PlanNames&) const override {
    return (limit_ ? "LIMIT " + std::to_string(*limit_) : std::string()) +
           (offset_ != 0 ? " OFFSET " + std::to_string(offset_) : std::string());
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    skipped_ = given_ = 0;
  }
  bool produce(Batch& out) override {
    while ((!limit_ || given_ < *limit_) && child_->next(out)) {
      const std::size_t skip = static_cast<std::size_t>(std::min<std::uint64_t>(out.rows, offset_ - skipped_));
      skipped_ += skip;
      std::size_t keep = out.rows - skip;
      if (limit_) keep = static_cast<std::size_t>(std::min<std::uint64_t>(keep, *limit_ - given_));
      if (keep == 0) continue;
      given_ += keep;
      cut(out, skip, keep);
      return true;
    }
    return false;
  }

 private:
  void cut(Batch& out, std::size_t skip, std::size_t keep) const {
    for (const Slot slot : slots_) {
      auto& column = out.columns[slot];
      if (column.empty()) continue;
      column.resize(skip + keep);
      column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(skip));
    }
    out.rows = keep;
  }

  std::uint64_t offset_;
  std::optional<std::uint64_t> limit_;
  std::uint64_t skipped_ = 0, given_ = 0;
};

class GraphNamesOperator : public UnaryOperator {
 public:
  GraphNamesOperator(OperatorPtr child, const GraphPlace& graph) : UnaryOperator(std::move(child)), graph_(graph) {
    if (graph_.kind == GraphPlace::Kind::Slot) slots_ = mergedSlots(slots_, {graph_.slot});
  }
  std::string label(const PlanNames&) const override { return "names of graphs"; }

 protected:
  bool produce(Batch& out) override {
    Batch in(runtime().slot_count);
    while (out.rows == 0 && child_->next(in)) expand(in, out);
    return out.rows > 0;
  }

 private:
  void expand(const Batch& in, Batch& out) const {
    const std::vector<rdf::TermId>& named = runtime().dataset.named;
    std::vector<std::uint32_t> picks;
    std::vector<ValueId> graphs;
    for (std::uint32_t row = 0; row < in.rows; ++row) {
      const ValueId bound = graph_.kind == GraphPlace::Kind::Slot ? in.at(graph_.slot, row) : graph_.constant;
      for (const rdf::TermId graph : named) {
        if (bound != kUnbound && bound != graph) continue;
        picks.push_back(row);
        graphs.push_back(graph);
      }
    }
    appendRows(in, picks, child_->slots(), 0, out);
    out.rows = picks.size();
    if (graph_.kind == GraphPlace::Kind::Slot) out.columns[graph_.slot] = std::move(graphs);
  }

  GraphPlace graph_;
};

}  // namespace

OperatorPtr makeValues(std::vector<Slot> slots, IdRows rows, std::string note) {
  return std::make_unique<ValuesOperator>(std::move(slots), std::move(rows), std::move(note));
}
OperatorPtr makeProject(OperatorPtr child, const std::vector<Slot>& slots) {
  return std::make_unique<ProjectOperator>(std::move(child), slots);
}
OperatorPtr makeSlice(OperatorPtr child, std::uint64_t offset, std::optional<std::uint64_t> limit) {
  return std::make_unique<SliceOperator>(std::move(child), offset, limit);
}
OperatorPtr makeGraphNames(OperatorPtr child, const GraphPlace& graph) {
  return std::make_unique<GraphNamesOperator>(std::move(child), graph);
}

}  // namespace cluxel::sparql
