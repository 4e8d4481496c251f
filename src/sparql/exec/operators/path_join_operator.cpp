// SPDX-License-Identifier: Apache-2.0
// Joins solutions with the node pairs of a property path.
#include <algorithm>
#include <map>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/path_walker.hpp"
#include "sparql/plan/pattern_access.hpp"

namespace cluxel::sparql {
namespace {

class PathJoinOperator : public UnaryOperator {
 public:
  PathJoinOperator(OperatorPtr child, const TripleNode& pattern) : UnaryOperator(std::move(child)), pattern_(pattern) {
    std::vector<Slot> own;
    for (const PatternPlace* place : {&pattern_.subject, &pattern_.object}) {
      if (place->isSlot()) own.push_back(place->slot);
    }
    if (pattern_.graph.kind == GraphPlace::Kind::Slot) own.push_back(pattern_.graph.slot);
    for (const Slot slot : child_->slots()) {
      if (std::find(own.begin(), own.end(), slot) == own.end()) carried_.push_back(slot);
    }
    slots_ = mergedSlots(slots_, own);
  }
  std::string label(const PlanNames& names) const override {
    return "path  " + describe(pattern_, names.query, names.terms);
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    if (fresh) {
      for (const auto& [graph, walker] : walkers_) walker->forget();
      walkers_.clear();
    }
    in_.columns.resize(runtime().slot_count);
    in_.rows = row_ = 0;
    found_.clear();
    next_found_ = 0;
    waiting_.clear();
  }

  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (next_found_ == found_.size()) {
        found_.clear();
        next_found_ = 0;
        if (searchNextStart()) continue;
        if (row_ >= in_.rows) {
          finishSegment(out);
          if (!child_->next(in_)) break;
          row_ = 0;
        }
        current_ = row_++;
        search(current_);
        continue;
      }
      const Match& match = found_[next_found_++];
      write(out, pattern_.subject, match.subject);
      write(out, pattern_.object, match.object);
      if (pattern_.graph.kind == GraphPlace::Kind::Slot) write(out, {pattern_.graph.slot, kUnbound}, match.graph);
      ++out.rows;
      from_.push_back(static_cast<std::uint32_t>(current_));
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  struct Match {
    ValueId subject, object, graph;
  };
  /// The candidate start nodes of the current row's paths in one graph.
  struct Waiting {
    PathWalker* walker;
    rdf::TermId graph;
    PathWalker::Nodes starts;
    std::size_t next;
  };

  static void write(Batch& out, const PatternPlace& place, ValueId id) {
    if (!place.isSlot()) return;
    auto& column = out.columns[place.slot];
    if (column.size() == out.rows + 1) return;  // same variable at both ends
    column.push_back(id);
  }

  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    appendRows(in_, from_, carried_, out.rows - from_.size(), out);
    from_.clear();
  }

  ValueId idAt(const PatternPlace& place, std::size_t row) const {
    return place.isSlot() ? in_.at(place.slot, row) : place.constant;
  }

  void search(std::size_t row) {
    const std::vector<rdf::TermId>& named = runtime().dataset.named;
    switch (pattern_.graph.kind) {
      case GraphPlace::Kind::Default:
        return searchIn(row, rdf::kNoTerm, runtime().dataset.default_graph);
      case GraphPlace::Kind::Constant:
        return searchIn(row, pattern_.graph.constant, oneGraph(pattern_.graph.constant));
      case GraphPlace::Kind::Slot:
        break;
    }
    const ValueId bound = in_.at(pattern_.graph.slot, row);
    for (const rdf::TermId graph : named) {
      if (bound == kUnbound || bound == graph) searchIn(row, graph, oneGraph(graph));
    }
  }

  static GraphFilter oneGraph(rdf::TermId graph) {
    GraphFilter filter;
    filter.kind = GraphFilter::Kind::One;
    filter.graph = graph;
    filter.may_repeat = false;
    return filter;
  }

  void searchIn(std::size_t row, rdf::TermId graph, const GraphFilter& filter) {
    std::unique_ptr<PathWalker>& walker = walkers_[graph];
    if (!walker) walker = std::make_unique<PathWalker>(runtime(), filter);
    const ValueId subject = idAt(pattern_.subject, row), object = idAt(pattern_.object, row);
    if (subject != kUnbound) {
      fromEnd(*walker, subject, object, true, graph);
    } else if (object != kUnbound) {
      fromEnd(*walker, object, kUnbound, false, graph);
    } else {
      waiting_.push_back({walker.get(), graph, walker->starts(*pattern_.path), 0});
    }
  }

  /// Evaluates the path from the next start node; one at a time, so that a consumer can stop early. False when none is
  /// left.
  bool searchNextStart() {
    while (!waiting_.empty() && waiting_.back().next == waiting_.back().starts.size()) waiting_.pop_back();
    if (waiting_.empty()) return false;
    Waiting& last = waiting_.back();
    fromEnd(*last.walker, last.starts[last.next++], kUnbound, true, last.graph);
    return true;
  }

  /// `end` is the bound end, `other` the required other end or kUnbound.
  void fromEnd(PathWalker& walker, ValueId end, ValueId other, bool forward, ValueId graph) {
    const bool same_variable =
        pattern_.subject.isSlot() && pattern_.object.isSlot() && pattern_.subject.slot == pattern_.object.slot;
    if (same_variable) other = end;
    const auto& reached = walker.reach(*pattern_.path, end, forward);
    const auto take = [&](ValueId node) {
      // With two unbound ends, paths of length zero exist for nodes of the graph only.
      if (node == end && pattern_.subject.isSlot() && pattern_.object.isSlot() && !walker.isNode(end)) return;
      found_.push_back(forward ? Match{end, node, graph} : Match{node, end, graph});
    };
    if (other != kUnbound) {
      if (std::binary_search(reached.begin(), reached.end(), other)) take(other);
      return;
    }
    for (const ValueId node : reached) take(node);
  }

  TripleNode pattern_;
  std::vector<Slot> carried_;
  std::map<rdf::TermId, std::unique_ptr<PathWalker>> walkers_;
  Batch in_;
  std::size_t row_ = 0, current_ = 0;
  std::vector<Match> found_;
  std::vector<Waiting> waiting_;
  std::size_t next_found_ = 0;
  std::vector<std::uint32_t> from_;
};

}  // namespace

OperatorPtr makePathJoin(OperatorPtr child, const TripleNode& pattern) {
  return std::make_unique<PathJoinOperator>(std::move(child), pattern);
}

}  // namespace cluxel::sparql
