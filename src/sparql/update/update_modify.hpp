// SPDX-License-Identifier: Apache-2.0
// DELETE/INSERT … WHERE: instantiates the templates for the solutions of the pattern.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sparql/algebra/algebra.hpp"
#include "sparql/exec/runtime.hpp"
#include "sparql/update_engine.hpp"

namespace cluxel::sparql {

/// A quad of a template for one solution.
struct ChangedQuad {
  Quad quad;
  bool names_graph = true;  ///< by GRAPH or WITH; else it is meant for the graphs that the pattern reads
};

struct Changes {
  std::vector<ChangedQuad> removed, inserted;
};

class ModifyRun {
 public:
  ModifyRun(const rdf::QuadReader& reader, const ast::Update& update, const ast::UpdateOperation& operation,
            const ast::Modify& modify, const UpdateOptions& options);

  std::string label_prefix;  ///< for blank nodes created by functions
  std::uint64_t seed = 0;
  Term default_graph;                        ///< for templates without a graph
  std::function<std::string()> fresh_label;  ///< labels for blank nodes of templates
  Guard::Usage used;                         ///< of the budget, by what went before

  /// The quads to remove and insert for all solutions; does not modify the store.
  Changes changes();
  Guard::Usage usedAfter() const { return used_after_; }
  const std::vector<ExpressionWarning>& warnings() const { return warnings_; }

 private:
  using Blanks = std::map<std::string, Term>;  ///< per solution, by label in the template
  Dataset dataset() const;
  AlgebraQuery algebra(Guard& guard);
  void prepare(FunctionContext& functions) const;
  std::optional<Term> filled(const ast::PatternTerm& place, const Batch& batch, std::size_t row, Blanks& blanks);
  void instantiate(const std::vector<ast::QuadTemplate>& templates, const Batch& batch, std::size_t row, Blanks& blanks,
                   Guard& guard, std::vector<ChangedQuad>& out);

  const rdf::QuadReader& reader_;
  const ast::Update& update_;
  const ast::UpdateOperation& operation_;
  const ast::Modify& modify_;
  const UpdateOptions& options_;
  QueryTerms terms_;
  std::vector<Slot> slot_of_variable_;
  std::vector<ExpressionWarning> warnings_;
  Guard::Usage used_after_;
};

}  // namespace cluxel::sparql
