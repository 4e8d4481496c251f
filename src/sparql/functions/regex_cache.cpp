// SPDX-License-Identifier: Apache-2.0
// XPath regular expressions with PCRE2.
#define PCRE2_CODE_UNIT_WIDTH 8
#include "sparql/functions/regex_cache.hpp"

#include <pcre2.h>

#include <algorithm>
#include <array>

#include "sparql/functions/functions.hpp"
#include "sparql/functions/regex_pattern.hpp"

namespace cluxel::sparql {
namespace {

constexpr std::uint32_t kMaxSteps = 10'000'000, kMaxHeapKib = 256 * 1024;
constexpr std::size_t kMaxCompiled = 1000;

struct Deleter {
  void operator()(pcre2_code* code) const { pcre2_code_free(code); }
  void operator()(pcre2_match_data* data) const { pcre2_match_data_free(data); }
  void operator()(pcre2_match_context* context) const { pcre2_match_context_free(context); }
};

std::optional<std::uint32_t> optionsOf(const std::string& flags) {
  // In XPath, `$` matches only at the very end, and white space is significant without the flag x.
  std::uint32_t options = PCRE2_UTF | PCRE2_UCP | PCRE2_DOLLAR_ENDONLY | PCRE2_NEVER_BACKSLASH_C;
  for (const char flag : flags) {
    switch (flag) {
      case 'i':
        options |= PCRE2_CASELESS;
        break;
      case 's':
        options |= PCRE2_DOTALL;
        break;
      case 'm':
        options |= PCRE2_MULTILINE;
        break;
      case 'x':
        break;  // see pcrePattern()
      case 'q':
        options |= PCRE2_LITERAL;
        break;
      default:
        return std::nullopt;
    }
  }
  if ((options & PCRE2_LITERAL) != 0) {
    options &= PCRE2_LITERAL | PCRE2_UTF | PCRE2_CASELESS;
  }
  return options;
}

}  // namespace

struct CompiledRegex {
  std::unique_ptr<pcre2_code, Deleter> code;
  std::unique_ptr<pcre2_match_data, Deleter> data;
  std::unique_ptr<pcre2_match_context, Deleter> context;
  bool literal = false;

  /// The number of captured groups; 0 for no match.
  int match(std::string_view text, std::size_t from, std::uint32_t options = 0) const {
    // UTF-8 is validated by the match at 0 only; validating for each replacement would be quadratic.
    if (from > 0) options |= PCRE2_NO_UTF_CHECK;
    int found = run(text, from, options);
    // Long texts may exceed the JIT stack; the interpreter uses the heap instead.
    if (found == PCRE2_ERROR_JIT_STACKLIMIT) found = run(text, from, options | PCRE2_NO_JIT);
    if (found == PCRE2_ERROR_MATCHLIMIT || found == PCRE2_ERROR_DEPTHLIMIT || found == PCRE2_ERROR_HEAPLIMIT ||
        found == PCRE2_ERROR_NOMEMORY) {
      throw Error(ErrorKind::BudgetExceeded, "query: a regular expression takes too many steps; make it simpler");
    }
    return std::max(found, 0);
  }

 private:
  int run(std::string_view text, std::size_t from, std::uint32_t options) const {
    return pcre2_match(code.get(), reinterpret_cast<PCRE2_SPTR>(text.data()), text.size(), from, options, data.get(),
                       context.get());
  }
};

RegexCache::RegexCache() = default;
RegexCache::~RegexCache() = default;

namespace {

std::string pcreMessage(int code, std::size_t at) {
  std::array<PCRE2_UCHAR, 256> text{};
  pcre2_get_error_message(code, text.data(), text.size());
  return std::string(reinterpret_cast<const char*>(text.data())) + " at byte " + std::to_string(at);
}

/// Null, with the reason in `fault`, for a malformed pattern or unknown flags.
std::unique_ptr<CompiledRegex> compileRegex(const std::string& pattern, const std::string& flags, std::string& fault) {
  const auto options = optionsOf(flags);
  if (!options) {
    fault = "the flags are i, s, m, x and q";
    return nullptr;
  }
  const bool is_literal = (*options & PCRE2_LITERAL) != 0;
  const auto translated =
      is_literal ? std::optional(pattern) : pcrePattern(pattern, flags.find('x') != std::string::npos);
  if (!translated) {
    fault = "a class that does not end, a bracket within a class, or \\i or \\c";
    return nullptr;
  }
  int error = 0;
  std::size_t at = 0;
  std::unique_ptr<pcre2_code, Deleter> code(pcre2_compile(reinterpret_cast<PCRE2_SPTR>(translated->data()),
                                                          translated->size(), *options, &error, &at, nullptr));
  if (!code) {
    fault = pcreMessage(error, at);
    return nullptr;
  }
  pcre2_jit_compile(code.get(), PCRE2_JIT_COMPLETE);
  auto regex = std::make_unique<CompiledRegex>();
  regex->code = std::move(code);
  regex->data.reset(pcre2_match_data_create_from_pattern(regex->code.get(), nullptr));
  regex->context.reset(pcre2_match_context_create(nullptr));
  pcre2_set_match_limit(regex->context.get(), kMaxSteps);
  pcre2_set_heap_limit(regex->context.get(), kMaxHeapKib);
  regex->literal = is_literal;
  return regex;
}

}  // namespace

const CompiledRegex* RegexCache::find(const std::string& pattern, const std::string& flags) {
  const auto key = std::make_pair(pattern, flags);
  const auto known = compiled_.find(key);
  if (known != compiled_.end()) return known->second.get();
  if (compiled_.size() >= kMaxCompiled) compiled_.clear();
  std::string fault;
  return (compiled_[key] = compileRegex(pattern, flags, fault)).get();
}

std::string regexFault(const std::string& pattern, const std::string& flags) {
  std::string fault;
  compileRegex(pattern, flags, fault);
  return fault;
}

bool regexMatches(const CompiledRegex& regex, std::string_view text) {
  return regex.match(text, 0) > 0;
}

namespace {

/// Appends the replacement with $0…$99, \$ and \\ expanded; false for a malformed replacement.
bool appendReplacement(std::string& out, std::string_view replacement, std::string_view text, const std::size_t* groups,
                       std::size_t group_count) {
  for (std::size_t i = 0; i < replacement.size(); ++i) {
    const char c = replacement[i];
    if (c == '\\') {
      if (++i == replacement.size() || (replacement[i] != '\\' && replacement[i] != '$')) return false;
      out += replacement[i];
    } else if (c == '$') {
      std::size_t number = 0, digits = 0;
      while (i + 1 < replacement.size() && replacement[i + 1] >= '0' && replacement[i + 1] <= '9') {
        const std::size_t longer = number * 10 + static_cast<std::size_t>(replacement[i + 1] - '0');
        if (digits > 0 && longer >= group_count) break;
        number = longer;
        ++digits;
        ++i;
      }
      if (digits == 0) return false;
      if (number < group_count && groups[2 * number] != PCRE2_UNSET) {
        out += text.substr(groups[2 * number], groups[2 * number + 1] - groups[2 * number]);
      }
    } else {
      out += c;
    }
  }
  return true;
}

}  // namespace

std::optional<std::string> regexReplace(const CompiledRegex& regex, std::string_view text,
                                        std::string_view replacement) {
  if (regex.match("", 0) > 0) return std::nullopt;
  std::string out;
  std::size_t from = 0;
  const std::size_t group_count = pcre2_get_ovector_count(regex.data.get());
  while (from <= text.size() && regex.match(text, from) > 0) {
    const std::size_t* groups = pcre2_get_ovector_pointer(regex.data.get());
    requireTextSize(out.size());
    const std::size_t begin = groups[0], end = groups[1];
    if (end == begin) break;
    out += text.substr(from, begin - from);
    if (regex.literal) {
      out += replacement;
    } else if (!appendReplacement(out, replacement, text, groups, group_count)) {
      return std::nullopt;
    }
    from = end;
  }
  out += text.substr(std::min(from, text.size()));
  return out;
}

}  // namespace cluxel::sparql
