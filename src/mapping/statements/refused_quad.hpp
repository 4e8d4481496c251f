// SPDX-License-Identifier: Apache-2.0
// The error for what an update or a file states of an object and may not.
#pragma once

#include <string>
#include <utility>

#include "cluxel/error.hpp"
#include "cluxel/term.hpp"

namespace cluxel::mapping {

/// Whether an error of checking a statement is a fault of what was stated. Others, such as a damaged map, are not.
inline bool isFaultOfStatement(const Error& fault) {
  return fault.kind() == ErrorKind::InvalidArgument || fault.kind() == ErrorKind::NotFound;
}

/// FaultyInput. what() names the subject. It knows no file: who has read one can look for the quad there.
class RefusedQuad : public Error {
 public:
  RefusedQuad(Quad quad, const std::string& what) : Error(ErrorKind::FaultyInput, what), quad_(std::move(quad)) {}

  /// Whether a quad of a source is the refused one, whatever its graph and the labels of its blank nodes.
  bool is(const Quad& other) const {
    const bool is_subject = other.subject == quad_.subject;
    const bool is_blank = other.object.kind == TermKind::BlankNode && quad_.object.kind == TermKind::BlankNode;
    const bool is_object = is_blank || other.object == quad_.object;
    return is_subject && (quad_.predicate.text.empty() || (other.predicate == quad_.predicate && is_object));
  }

 private:
  Quad quad_;  ///< without a predicate: all quads of the subject
};

}  // namespace cluxel::mapping
