// SPDX-License-Identifier: Apache-2.0
// Which variables have a value in every solution of a pattern.
#pragma once

#include <set>

#include "sparql/syntax/ast.hpp"

namespace cluxel::mapping {

using Variables = std::set<sparql::ast::VariableIndex>;

/// Whether the path as a whole holds between a term and itself without a step.
bool mayBeEmpty(const sparql::ast::Path& path);

/// Whether the term is no variable, or one of `bound`.
bool isBound(const sparql::ast::PatternTerm& term, const Variables& bound);

/// What each solution of the group binds. A path that may have no step binds its ends when something else binds one of
/// them. BIND counts when it takes a constant or a variable that is bound before it (other expressions may fail),
/// VALUES when the column has no UNDEF.
Variables boundIn(const sparql::ast::GroupPattern& group);

/// The same of one element without what stands beside it; nothing for BIND.
Variables boundIn(const sparql::ast::PatternElement& element);

/// Whether a body can be evaluated for some values of a key apart: the solutions for one value do not follow from facts
/// about others.
bool isLocalTo(sparql::ast::VariableIndex key, const sparql::ast::GroupPattern& body);

}  // namespace cluxel::mapping
