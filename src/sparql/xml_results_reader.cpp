// SPDX-License-Identifier: Apache-2.0
// Reads SPARQL Query Results XML: a flat walk over tags, no tree.
#include <charconv>
#include <map>
#include <optional>

#include "cluxel/base/diagnostic.hpp"
#include "sparql/result_table_builder.hpp"
#include "sparql/results_format_readers.hpp"
#include "sparql/source_text.hpp"

namespace cluxel {

namespace {

struct Tag {
  std::string name;  ///< without namespace prefix
  std::map<std::string, std::string> attributes;
  bool opens = true, closes = false;  ///< both for <name/>
};

/// Tags and the text before each.
class XmlWalk {
 public:
  XmlWalk(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  /// The next tag; `before` gets the character data in front of it.
  std::optional<Tag> next(std::string& before) {
    before.clear();
    while (at_ < text_.size()) {
      if (text_[at_] != '<') {
        const std::size_t end = std::min(text_.find('<', at_), text_.size());
        before += decoded(text_.substr(at_, end - at_));
        at_ = end;
      } else if (starts("<![CDATA[")) {
        before.append(upTo("]]>", 9));
      } else if (starts("<!--")) {
        upTo("-->", 4);
      } else if (starts("<?")) {
        upTo("?>", 2);
      } else if (starts("<!")) {
        upTo(">", 2);
      } else {
        return tag();
      }
    }
    return std::nullopt;
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(locate(file_, text_, at_), message); }

 private:
  bool starts(std::string_view mark) const { return text_.substr(at_).starts_with(mark); }
  std::string_view upTo(std::string_view mark, std::size_t skip) {
    const std::size_t begin = at_ + skip;
    const std::size_t end = begin > text_.size() ? std::string_view::npos : text_.find(mark, begin);
    if (end == std::string_view::npos) fail("'" + std::string(mark) + "' is missing");
    at_ = end + mark.size();
    return text_.substr(begin, end - begin);
  }
  Tag tag();
  void attributes(std::string_view rest, Tag& tag) const;
  std::string decoded(std::string_view raw) const;
  std::string entity(std::string_view name) const;

  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
};

std::string localName(std::string_view name) {
  const std::size_t colon = name.find(':');
  return std::string(colon == std::string_view::npos ? name : name.substr(colon + 1));
}

Tag XmlWalk::tag() {
  std::string_view inside = upTo(">", 1);
  Tag tag;
  if (inside.starts_with('/')) {
    tag.opens = false;
    tag.closes = true;
    inside.remove_prefix(1);
  } else if (inside.ends_with('/')) {
    tag.closes = true;
    inside.remove_suffix(1);
  }
  const std::size_t end = std::min(inside.find_first_of(" \t\r\n"), inside.size());
  tag.name = localName(inside.substr(0, end));
  attributes(inside.substr(end), tag);
  return tag;
}

void XmlWalk::attributes(std::string_view rest, Tag& tag) const {
  constexpr std::string_view space = " \t\r\n";
  for (;;) {
    rest.remove_prefix(std::min(rest.find_first_not_of(space), rest.size()));
    if (rest.empty()) return;
    const std::size_t equals = rest.find('=');
    const std::size_t quote = equals == std::string_view::npos ? equals : rest.find_first_not_of(space, equals + 1);
    if (quote == std::string_view::npos || (rest[quote] != '"' && rest[quote] != '\'')) fail("a faulty attribute");
    const std::size_t end = rest.find(rest[quote], quote + 1);
    if (end == std::string_view::npos) fail("an attribute's value is not closed");
    const std::string_view name = rest.substr(0, rest.find_first_of(" \t\r\n="));
    tag.attributes[std::string(name)] = decoded(rest.substr(quote + 1, end - quote - 1));
    rest.remove_prefix(end + 1);
  }
}

std::string XmlWalk::decoded(std::string_view raw) const {
  std::string text;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (raw[i] != '&') {
      text += raw[i];
      continue;
    }
    const std::size_t end = raw.find(';', i);
    if (end == std::string_view::npos) fail("'&' without ';'");
    text += entity(raw.substr(i + 1, end - i - 1));
    i = end;
  }
  return text;
}

std::string XmlWalk::entity(std::string_view name) const {
  static const std::map<std::string_view, std::string> known{
      {"lt", "<"}, {"gt", ">"}, {"amp", "&"}, {"quot", "\""}, {"apos", "'"}};
  if (const auto found = known.find(name); found != known.end()) return found->second;
  const bool hex = name.starts_with("#x");
  std::uint32_t value = 0;
  const char* begin = name.data() + std::min<std::size_t>(hex ? 2 : 1, name.size());
  const char* end = name.data() + name.size();
  const bool number = name.starts_with('#') && std::from_chars(begin, end, value, hex ? 16 : 10).ptr == end;
  if (!number || value == 0 || value > 0x10FFFF) fail("the unknown entity &" + std::string(name) + ";");
  std::string text;
  appendCodePoint(text, value);
  return text;
}

class XmlResults {
 public:
  XmlResults(std::string_view text, const std::string& file) : walk_(text, file) {}

  QueryResult read() {
    bool known = false;
    std::string text;
    while (const std::optional<Tag> tag = walk_.next(text)) {
      known = known || tag->name == "sparql";
      if (tag->opens) open(*tag);
      if (tag->closes) close(tag->name, tag->opens ? std::string() : text);
    }
    if (!known) walk_.fail("there is no <sparql> element");
    return std::move(result_);
  }

 private:
  void open(const Tag& tag) {
    open_ = tag;
    if (tag.name == "variable") {
      if (result_.table.row_count > 0) walk_.fail("a variable announced behind a result");
      result_.table.variables.push_back(attribute(tag, "name"));
    }
    if (tag.name == "result") builder_.beginRow();
    if (tag.name == "binding") binding(attribute(tag, "name"));
  }
  void binding(const std::string& variable) {
    column_ = builder_.columnOf(variable);
    if (column_ == std::string::npos) walk_.fail("the head does not name '" + variable + "'");
  }
  void close(const std::string& name, const std::string& text) {
    if (name == "uri") set(Term::iri(text));
    if (name == "bnode") set(Term::blank(text));
    if (name == "literal") set(literal(text));
    if (name != "boolean") return;
    result_.kind = QueryResult::Kind::Boolean;
    result_.boolean = text.find("true") != std::string::npos;
  }
  Term literal(const std::string& text) const {
    if (open_.attributes.contains("xml:lang")) return Term::langLiteral(text, open_.attributes.at("xml:lang"));
    if (open_.attributes.contains("datatype")) return Term::literal(text, open_.attributes.at("datatype"));
    return Term::literal(text);
  }
  void set(const Term& term) {
    if (result_.table.row_count == 0 || column_ >= result_.table.variables.size())
      walk_.fail("a term outside a binding");
    builder_.set(column_, term);
  }
  std::string attribute(const Tag& tag, const std::string& name) const {
    const auto found = tag.attributes.find(name);
    if (found == tag.attributes.end()) walk_.fail("<" + tag.name + "> lacks the attribute '" + name + "'");
    return found->second;
  }

  XmlWalk walk_;
  QueryResult result_;
  ResultTableBuilder builder_{result_.table};
  Tag open_;
  std::size_t column_ = std::string::npos;
};

}  // namespace

QueryResult readXmlResults(std::string_view text, const std::string& file) {
  return XmlResults(text, file).read();
}

}  // namespace cluxel
