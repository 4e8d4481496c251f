// SPDX-License-Identifier: Apache-2.0
// How the facts of a SPARQL rule follow a change: what the rule reads, and the variable by whose values its solutions
// can be evaluated apart.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/map_inputs.hpp"
#include "sparql/syntax/ast.hpp"

namespace cluxel::mapping {

namespace ast = sparql::ast;

/// One branch of a UNION that every solution goes through.
struct UnionBranch {
  std::size_t number = 0;  ///< of the UNION
  std::size_t branch = 0;
};

/// A triple pattern of the WHERE clause, at any depth. Paths of sequences and inverses are patterns of their steps.
struct ReadPattern {
  enum class Need {
    Always,     ///< each solution has a triple for it
    InABranch,  ///< each solution has one for it, or for another branch of its UNION
    No
  };
  ast::TriplePattern triple;
  std::vector<Term> links;  ///< of a path: the properties that it walks
  bool has_key = false;     ///< the key is its subject or its object
  Need need = Need::No;
  std::optional<UnionBranch> branch;  ///< all solutions that take this branch have a triple for it
};

struct RuleShape {
  enum class Following {
    ByKey,    ///< of a change, the solutions of the affected values of the key are evaluated
    AsWhole,  ///< the rule is evaluated for the whole map
    Never     ///< what it reads cannot be told: everything is inferred anew
  };
  NamedText rule;
  ast::Query query;  ///< with paths taken apart
  Following following = Following::ByKey;
  std::string reason;          ///< why it is not followed by key
  ast::VariableIndex key = 0;  ///< ByKey
  bool is_grouped = false;     ///< the patterns stand in a sub-select that groups by the key
  bool is_plain = false;       ///< only triple patterns, filters, BIND and VALUES: each row names its triples
  bool is_monotone =
      false;  ///< ByKey; with more facts no solution is lost: it neither negates, groups nor has OPTIONAL
  std::vector<ReadPattern> reads;
  std::vector<std::size_t> branches;  ///< how many each UNION has, of those in UnionBranch
};

/// Throws InputError when the rule cannot be parsed.
RuleShape shapeOf(const NamedText& rule);

}  // namespace cluxel::mapping
