// SPDX-License-Identifier: Apache-2.0
// DELETE/INSERT … WHERE: the quads that the templates give for the solutions of the pattern.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "cluxel/sparql/update_engine.hpp"
#include "sparql/algebra.hpp"
#include "sparql/runtime.hpp"

namespace cluxel::sparql {

struct Changes {
  std::vector<Quad> removed, inserted;
};

class ModifyRun {
 public:
  ModifyRun(const QuadReader& reader, const ast::Update& update, const ast::UpdateOperation& operation,
            const ast::Modify& modify, const UpdateOptions& options);

  std::string label_prefix;  ///< of blank nodes that functions make
  std::uint64_t seed = 0;
  Term default_graph;                        ///< of templates that name none
  std::function<std::string()> fresh_label;  ///< for the blank nodes of templates

  /// What all solutions together remove and insert; the store is not touched.
  Changes changes();

 private:
  using Blanks = std::map<std::string, Term>;  ///< of one solution, by the template's label
  Dataset dataset() const;
  AlgebraQuery algebra(Guard& guard);
  void prepare(FunctionContext& functions) const;
  std::optional<Term> filled(const ast::PatternTerm& place, const Batch& batch, std::size_t row, Blanks& blanks);
  void instantiate(const std::vector<ast::QuadTemplate>& templates, const Batch& batch, std::size_t row, Blanks& blanks,
                   Guard& guard, std::vector<Quad>& out);

  const QuadReader& reader_;
  const ast::Update& update_;
  const ast::UpdateOperation& operation_;
  const ast::Modify& modify_;
  const UpdateOptions& options_;
  QueryTerms terms_;
  std::vector<Slot> slot_of_variable_;
};

}  // namespace cluxel::sparql
