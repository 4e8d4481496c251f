// SPDX-License-Identifier: Apache-2.0
// Formatting of diagnostics, in the form that editors and people know from compilers.
#include "cluxel/error.hpp"

#include <algorithm>

#include "base/utf8.hpp"

namespace cluxel {

namespace {

std::string caretUnder(std::string_view line, std::size_t column) {
  std::string caret;
  for (std::size_t i = 0; i + 1 < column && i < line.size(); ++i) {
    if (!isUtf8Continuation(line[i])) caret += line[i] == '\t' ? '\t' : ' ';
  }
  return caret + '^';
}

std::string withoutNul(const std::string& text) {
  std::string shown;
  for (const char c : text)
    if (c == '\0')
      shown += "\\0";
    else
      shown += c;
  return shown;
}

std::vector<Diagnostic> oneDiagnostic(SourceLocation location, std::string message, std::string hint) {
  Diagnostic diagnostic;
  diagnostic.location = std::move(location);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  return {std::move(diagnostic)};
}

}  // namespace

std::string toString(const SourceLocation& location) {
  std::string text = location.file;
  if (location.byte_offset) return text + ": byte " + std::to_string(*location.byte_offset);
  if (location.line > 0) text += ':' + std::to_string(location.line);
  if (location.line > 0 && location.column > 0) text += ':' + std::to_string(location.column);
  return text;
}

std::string format(const Diagnostic& diagnostic) {
  std::string text = toString(diagnostic.location);
  if (!text.empty()) text += ": ";
  text += diagnostic.severity == Severity::Error ? "error: " : "warning: ";
  text += diagnostic.message;
  if (!diagnostic.source_line.empty()) {
    text += "\n  " + diagnostic.source_line;
    if (diagnostic.location.column > 0) text += "\n  " + caretUnder(diagnostic.source_line, diagnostic.location.column);
  }
  if (!diagnostic.hint.empty()) text += "\n  hint: " + diagnostic.hint;
  return text;
}

std::string format(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) text += (text.empty() ? "" : "\n") + format(diagnostic);
  if (diagnostics.size() < 2) return text;
  const auto errors = std::count_if(diagnostics.begin(), diagnostics.end(),
                                    [](const Diagnostic& d) { return d.severity == Severity::Error; });
  const auto warnings = static_cast<std::ptrdiff_t>(diagnostics.size()) - errors;
  return text + '\n' + std::to_string(errors) + " errors, " + std::to_string(warnings) + " warnings";
}

bool hasErrors(const std::vector<Diagnostic>& diagnostics) {
  return std::any_of(diagnostics.begin(), diagnostics.end(),
                     [](const Diagnostic& d) { return d.severity == Severity::Error; });
}

std::string_view lineOf(std::string_view text, std::size_t line) {
  for (std::size_t current = 1; line > 0; ++current) {
    const std::size_t end = text.find('\n');
    std::string_view candidate = text.substr(0, end);
    if (current == line) {
      if (!candidate.empty() && candidate.back() == '\r') candidate.remove_suffix(1);
      return candidate;
    }
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
  return {};
}

SourceLocation locate(std::string file, std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t last_line_end = before.rfind('\n');
  SourceLocation location;
  location.file = std::move(file);
  location.line = 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
  location.column = before.size() - (last_line_end == std::string_view::npos ? 0 : last_line_end + 1) + 1;
  return location;
}

Error::Error(ErrorKind kind, const std::string& what, Remedy remedy)
    : std::runtime_error(withoutNul(what)), kind_(kind), remedy_(remedy) {}

InputError::InputError(std::vector<Diagnostic> diagnostics) : InputError(std::move(diagnostics), Remedy::None) {}

InputError::InputError(std::vector<Diagnostic> diagnostics, Remedy remedy)
    : Error(ErrorKind::FaultyInput, format(diagnostics), remedy), diagnostics_(std::move(diagnostics)) {}

InputError::InputError(SourceLocation location, std::string message, std::string hint)
    : InputError(std::move(location), std::move(message), std::move(hint), Remedy::None) {}

InputError::InputError(SourceLocation location, std::string message, std::string hint, Remedy remedy)
    : InputError(oneDiagnostic(std::move(location), std::move(message), std::move(hint)), remedy) {}

}  // namespace cluxel
