// SPDX-License-Identifier: Apache-2.0
// Parses RDF with raptor: statements become quads, messages become diagnostics.
#include <pthread.h>
#include <raptor2.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/quad_place.hpp"
#include "rdf/io/rdf_faults.hpp"
#include "rdf/io/rdf_guards.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/io/rdf_text.hpp"
#include "rdf/iri.hpp"

namespace cluxel::rdf {

namespace {

// No RDF syntax allows this in a label, so generated labels cannot collide with written ones.
constexpr char kGeneratedPrefix[] = "~";

/// Worlds that nobody uses. None is freed: that would clean up libxml2 while other threads use it. Nor are two opened
/// at a time, which initialises it. A process that is forked meanwhile waits for that.
class IdleWorlds {
 public:
  static IdleWorlds& ofProcess() {
    static auto* worlds = new IdleWorlds;  // threads may still read when the program ends
    static const int registered = ::pthread_atfork([] { worlds->mutex_.lock(); }, [] { worlds->mutex_.unlock(); },
                                                   [] { worlds->mutex_.unlock(); });
    static_cast<void>(registered);
    return *worlds;
  }

  raptor_world* take() {
    const std::lock_guard lock(mutex_);
    if (!worlds_.empty()) {
      raptor_world* world = worlds_.back();
      worlds_.pop_back();
      return world;
    }
    raptor_world* world = raptor_new_world();
    if (world == nullptr) throw std::bad_alloc();
    // libxml2 has one handler of errors for each thread: a world must not stay in that of the thread that opened it.
    raptor_world_set_flag(world, RAPTOR_WORLD_FLAG_LIBXML_GENERIC_ERROR_SAVE, 0);
    raptor_world_set_flag(world, RAPTOR_WORLD_FLAG_LIBXML_STRUCTURED_ERROR_SAVE, 0);
    if (raptor_world_open(world) != 0) throw std::bad_alloc();
    return world;
  }

  void giveBack(raptor_world* world) {
    raptor_world_set_log_handler(world, nullptr, nullptr);
    const std::lock_guard lock(mutex_);
    worlds_.push_back(world);
  }

 private:
  std::mutex mutex_;
  std::vector<raptor_world*> worlds_;
};

struct RaptorDeleter {
  void operator()(raptor_world* world) const { IdleWorlds::ofProcess().giveBack(world); }
  void operator()(raptor_parser* parser) const { raptor_free_parser(parser); }
  void operator()(raptor_uri* uri) const { raptor_free_uri(uri); }
};
template <typename T>
using Raptor = std::unique_ptr<T, RaptorDeleter>;

const unsigned char* raptorBytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

std::string_view viewOf(const unsigned char* text, std::size_t size) {
  return {reinterpret_cast<const char*>(text), size};
}

std::string_view viewOf(raptor_uri* uri) {
  std::size_t size = 0;
  const unsigned char* text = raptor_uri_as_counted_string(uri, &size);
  return viewOf(text, size);
}

const char* parserName(RdfFormat format) {
  switch (format) {
    case RdfFormat::Turtle:
      return "turtle";
    case RdfFormat::NTriples:
      return "ntriples";
    case RdfFormat::NQuads:
      return "nquads";
    case RdfFormat::TriG:
      return "trig";
    case RdfFormat::RdfXml:
      break;
  }
  return "rdfxml";
}

/// Labels "b<hash of source>_<n>", where n counts blank nodes in document order.
class BlankLabels {
 public:
  explicit BlankLabels(const RdfSource& source) : source_(source) {}

  const std::string& labelOf(std::string_view written) {
    const auto [entry, is_new] = labels_.try_emplace(std::string(written));
    if (is_new && prefix_.empty()) prefix_ = "b" + RdfText(source_).hash() + "_";
    if (is_new) entry->second = prefix_ + std::to_string(labels_.size());
    return entry->second;
  }

 private:
  const RdfSource& source_;
  std::string prefix_;  ///< made for the first label: it takes a pass over the text
  std::unordered_map<std::string, std::string> labels_;
};

/// One run of raptor's parser. Exceptions are stored and rethrown after raptor's C frames have returned.
class Reading {
 public:
  Reading(const RdfSource& source, const std::function<void(const Quad&)>& take)
      : source_(source), take_(take), labels_(source), faults_(source) {
    quad_.graph = source.graph;
  }

  void run();
  /// So that line() is known: raptor does not tell the lines of XML, but takes a text in pieces.
  void countLines() { counts_lines_ = true; }
  /// The line, from 1, with which the quad that is taken was whole. Needs countLines().
  std::size_t line() const;

  std::vector<std::pair<std::string, std::string>> prefixes;  ///< that were declared so far

 private:
  static void onNamespace(void* reading, raptor_namespace* space) {
    static_cast<Reading*>(reading)->takePrefix(*space);
  }
  static void onStatement(void* reading, raptor_statement* statement) {
    static_cast<Reading*>(reading)->take(*statement);
  }
  static void onMessage(void* reading, raptor_log_message* message) { static_cast<Reading*>(reading)->note(*message); }

  void take(const raptor_statement& statement) {
    if (failure_) return;
    try {
      fill(quad_.subject, *statement.subject);
      fill(quad_.predicate, *statement.predicate);
      fill(quad_.object, *statement.object);
      if (statement.graph != nullptr)
        fill(quad_.graph, *statement.graph);
      else
        quad_.graph = source_.graph;
      take_(quad_);
    } catch (...) {
      failure_ = std::current_exception();
      raptor_parser_parse_abort(parser_.get());
    }
  }

  void takePrefix(const raptor_namespace& space) {
    if (failure_) return;
    try {
      raptor_uri* uri = raptor_namespace_get_uri(&space);
      std::size_t size = 0;
      const unsigned char* prefix = raptor_namespace_get_counted_prefix(&space, &size);
      if (uri != nullptr) prefixes.emplace_back(prefix == nullptr ? "" : viewOf(prefix, size), viewOf(uri));
    } catch (...) {
      failure_ = std::current_exception();
      raptor_parser_parse_abort(parser_.get());
    }
  }

  void note(const raptor_log_message& message) {
    if (message.level < RAPTOR_LOG_LEVEL_ERROR || failure_) return;
    const raptor_locator* at = message.locator;
    faults_.add(at == nullptr || at->line < 0 ? 0 : static_cast<std::size_t>(at->line) + lines_before_,
                at == nullptr || at->column < 0 ? 0 : static_cast<std::size_t>(at->column), message.text);
  }

  void fill(Term& term, const raptor_term& from);
  Term iriOf(raptor_uri* uri) const;
  void start();
  bool feed(const RdfPiece& piece);
  int give(std::string_view text, bool is_end);
  int giveLines(const RdfPiece& piece);

  const RdfSource& source_;
  const std::function<void(const Quad&)>& take_;
  BlankLabels labels_;
  RdfFaults faults_;
  Quad quad_;
  std::exception_ptr failure_;
  std::size_t lines_before_ = 0;  ///< that an earlier parser has read
  std::size_t line_ = 0;          ///< that giveLines() has given last
  bool counts_lines_ = false;
  bool is_finished_ = false;  ///< the parser has got an end, or met a fault that ends it
  Raptor<raptor_world> world_;
  Raptor<raptor_uri> base_;
  Raptor<raptor_parser> parser_;
};

/// Raptor removes the dot segments of absolute IRIs in all formats but N-Triples and N-Quads, and queries do so too: an
/// IRI must be the same in all of them.
Term Reading::iriOf(raptor_uri* uri) const {
  const std::string_view written = viewOf(uri);
  if (!mayHoldDotSegments(written)) return Term::iri(written);
  const Raptor<raptor_uri> resolved(
      raptor_new_uri_relative_to_base(raptor_uri_get_world(uri), uri, raptor_uri_as_string(uri)));
  return Term::iri(resolved ? viewOf(resolved.get()) : written);
}

void Reading::fill(Term& term, const raptor_term& from) {
  switch (from.type) {
    case RAPTOR_TERM_TYPE_URI:
      term = iriOf(from.value.uri);
      return;
    case RAPTOR_TERM_TYPE_BLANK:
      term = Term::blank(labels_.labelOf(viewOf(from.value.blank.string, from.value.blank.string_len)));
      return;
    default:
      break;
  }
  const auto& literal = from.value.literal;
  const std::string_view lexical = viewOf(literal.string, literal.string_len);
  if (literal.language != nullptr && literal.language_len > 0)
    term = Term::langLiteral(lexical, viewOf(literal.language, literal.language_len));
  else if (literal.datatype != nullptr)
    term = Term::literal(lexical, viewOf(literal.datatype));
  else
    term = Term::literal(lexical);
}

void Reading::start() {
  parser_.reset(raptor_new_parser(world_.get(), parserName(source_.format)));
  if (!parser_) throw std::bad_alloc();
  raptor_parser_set_statement_handler(parser_.get(), this, &Reading::onStatement);
  raptor_parser_set_namespace_handler(parser_.get(), this, &Reading::onNamespace);
  raptor_parser_set_option(parser_.get(), RAPTOR_OPTION_NO_NET, nullptr, 1);
  raptor_parser_set_option(parser_.get(), RAPTOR_OPTION_NO_FILE, nullptr, 1);
  raptor_parser_parse_start(parser_.get(), base_.get());
}

int Reading::give(std::string_view text, bool is_end) {
  return raptor_parser_parse_chunk(parser_.get(), raptorBytes(text), text.size(), is_end ? 1 : 0);
}

int Reading::giveLines(const RdfPiece& piece) {
  line_ = static_cast<std::size_t>(piece.first_line) - 1;
  int code = 0;
  for (std::string_view rest = piece.text; !rest.empty() && code == 0 && !failure_;) {
    const std::size_t size = std::min(rest.find('\n'), rest.size() - 1) + 1;
    ++line_;
    code = give(rest.substr(0, size), false);
    rest.remove_prefix(size);
  }
  return code;
}

/// False when no more pieces are wanted.
bool Reading::feed(const RdfPiece& piece) {
  if (source_.format != RdfFormat::RdfXml) refuseHostileText(source_, piece);
  faults_.enter(piece);
  // Raptor's parser of lines takes time for every line it ever read when it gets another piece: a new one does not.
  const bool is_of_lines = source_.format == RdfFormat::NTriples || source_.format == RdfFormat::NQuads;
  if (is_of_lines && piece.first_line > 1) {
    lines_before_ = static_cast<std::size_t>(piece.first_line - 1);
    start();
  }
  const int code = counts_lines_ && !is_of_lines ? giveLines(piece) : give(piece.text, is_of_lines);
  is_finished_ = is_of_lines || code != 0;
  return !failure_ && (is_of_lines || code == 0);
}

std::size_t Reading::line() const {
  if (line_ > 0) return line_;
  raptor_locator* at = raptor_parser_get_locator(parser_.get());
  return at == nullptr || at->line < 1 ? 0 : static_cast<std::size_t>(at->line) + lines_before_;
}

void Reading::run() {
  world_.reset(IdleWorlds::ofProcess().take());
  raptor_world_set_log_handler(world_.get(), this, &Reading::onMessage);
  raptor_world_set_generate_bnodeid_parameters(world_.get(), const_cast<char*>(kGeneratedPrefix), 1);
  const std::string base = source_.base_iri.empty() ? std::string("invalid:/") : source_.base_iri;
  base_.reset(raptor_new_uri(world_.get(), raptorBytes(base)));
  if (!base_) throw InputError({.file = source_.name}, "the base IRI '" + base + "' is malformed");
  start();
  RdfText(source_).forEachPiece([this](const RdfPiece& piece) { return feed(piece); });
  faults_.enter({});  // the text of the last piece is gone
  if (!failure_ && !is_finished_) raptor_parser_parse_chunk(parser_.get(), nullptr, 0, 1);
  parser_.reset();
  if (failure_) std::rethrow_exception(failure_);
  faults_.throwIfAny();
}

}  // namespace

void parseRdf(const RdfSource& source, const std::function<void(const Quad&)>& take) {
  if (source.format == RdfFormat::RdfXml) refuseHostileText(source, {source.text});
  Reading(source, take).run();
}

SourceLocation placeOf(const RdfSource& source, const std::function<bool(const Quad&)>& is_meant) {
  if (source.format == RdfFormat::Turtle || source.format == RdfFormat::TriG) return placeInSentences(source, is_meant);
  struct Found {};  // ends the reading
  SourceLocation place;
  const Reading* reader = nullptr;
  const std::function<void(const Quad&)> take = [&](const Quad& quad) {
    if (!is_meant(quad)) return;
    place.file = source.name;
    place.line = reader->line();
    throw Found();
  };
  Reading reading(source, take);
  reading.countLines();
  reader = &reading;
  if (source.format == RdfFormat::RdfXml) refuseHostileText(source, {source.text});
  try {
    reading.run();
  } catch (const Found&) {
  }
  return place;
}

std::vector<std::pair<std::string, std::string>> prefixesIn(const RdfSource& source) {
  const std::function<void(const Quad&)> take = [](const Quad&) {};
  Reading reading(source, take);
  reading.run();
  return std::move(reading.prefixes);
}

std::uint64_t loadRdf(const RdfSource& source, QuadWriter& writer) {
  std::uint64_t count = 0;
  parseRdf(source, [&](const Quad& quad) {
    writer.add(quad);
    ++count;
  });
  return count;
}

}  // namespace cluxel::rdf
