// SPDX-License-Identifier: Apache-2.0
// The store on a generated map of a million triples: load, open, size, lookups, scans, estimates; librdf's
// own storages beside it.
#include <benchmark/benchmark.h>
#include <librdf.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>

#include "rdf/file/environment.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/store/quad_store.hpp"

namespace {

using namespace cluxel;
namespace fs = std::filesystem;

/// Objects with a class, a position, a height, a label and two neighbours: 8 triples each.
std::string generatedNTriples(std::size_t triples) {
  std::mt19937 random(1);
  std::string text;
  const std::string clx = "https://w3id.org/cluxel/ontology#";
  const std::string map = "https://w3id.org/cluxel/map/object/";
  const char* classes[] = {"Tree", "Bush", "StreetLamp", "StreetSign", "Vehicle", "Building"};
  const auto name = [&](std::size_t i) { return "<" + map + std::to_string(i * 2654435761U % 4294967291U) + ">"; };
  const std::size_t objects = triples / 8;
  const auto number = [&](unsigned range) {
    return "\"" + std::to_string(random() % range) + "." + std::to_string(random() % 1000) +
           "\"^^<http://www.w3.org/2001/XMLSchema#decimal>";
  };
  for (std::size_t i = 0; i < objects; ++i) {
    const std::string s = name(i);
    text += s + " <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <" + clx + classes[random() % 6] + "> .\n";
    for (const char* property : {"x", "y", "z", "height"})
      text += s + " <" + clx + property + "> " + number(property[0] == 'h' ? 30 : 2000) + " .\n";
    text += s + " <" + clx + "rule> \"rule " + std::to_string(random() % 9) + "\" .\n";
    for (int j = 0; j < 2; ++j) text += s + " <" + clx + "near> " + name(random() % objects) + " .\n";
  }
  return text;
}

constexpr std::size_t kTriples = 1'000'000;

const rdf::RdfSource& source() {
  static const rdf::RdfSource text{generatedNTriples(kTriples), "generated.nt", rdf::RdfFormat::NTriples, "",
                                   Term::iri("")};
  return text;
}

fs::path scratch() {
  static const fs::path folder = [] {
    std::string name = (fs::temp_directory_path() / "cluxel-bench-XXXXXX").string();
    return fs::path(::mkdtemp(name.data()));
  }();
  return folder;
}

void load(const fs::path& file) {
  fs::remove(file);
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::Create);
  rdf::WriteTransaction transaction = environment->write();
  rdf::QuadWriter writer(transaction);
  loadRdf(source(), writer);
  writer.flush();
  transaction.commit();
}

/// A compact map of the generated triples, made once.
const fs::path& compactMap() {
  static const fs::path file = [] {
    const fs::path loaded = scratch() / "loaded.clx";
    load(loaded);
    const fs::path compact = scratch() / "compact.clx";
    rdf::Environment::open(loaded, rdf::OpenMode::ReadOnly)->compactTo(compact);
    return compact;
  }();
  return file;
}

rdf::TermId idOf(const rdf::QuadReader& reader, const std::string& local) {
  return reader.idOf(Term::iri("https://w3id.org/cluxel/ontology#" + local)).value();
}

std::vector<rdf::TermId> subjects(const rdf::QuadReader& reader) {
  std::vector<rdf::TermId> ids;
  rdf::QuadCursor cursor = reader.scan({.s = {}, .p = idOf(reader, "height"), .o = {}, .g = {}});
  for (rdf::QuadIds quad; cursor.next(quad);) ids.push_back(quad.s);
  return ids;
}

void parseOnly(benchmark::State& state) {
  source();
  for (auto _ : state) {
    std::size_t count = 0;
    parseRdf(source(), [&](const Quad&) { ++count; });
    benchmark::DoNotOptimize(count);
  }
}
BENCHMARK(parseOnly)->Unit(benchmark::kMillisecond)->Iterations(1);

void loadAMillion(benchmark::State& state) {
  source();
  for (auto _ : state) load(scratch() / "load.clx");
  state.counters["bytes/triple"] = static_cast<double>(fs::file_size(scratch() / "load.clx")) / kTriples;
}
BENCHMARK(loadAMillion)->Unit(benchmark::kMillisecond)->Iterations(2);

void openAndAskOne(benchmark::State& state) {
  compactMap();
  for (auto _ : state) {
    const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
    const rdf::QuadReader reader(environment->read());
    benchmark::DoNotOptimize(reader.estimate({.s = {}, .p = idOf(reader, "near"), .o = {}, .g = {}}));
  }
  state.counters["bytes/triple"] = static_cast<double>(fs::file_size(compactMap())) / kTriples;
}
BENCHMARK(openAndAskOne)->Unit(benchmark::kMillisecond);

void newSnapshot(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  for (auto _ : state) {
    const rdf::QuadReader reader(environment->read());
    benchmark::DoNotOptimize(reader.size());
  }
}
BENCHMARK(newSnapshot);

/// 0: ascending subjects, 1: random ones.
void lookup(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  std::vector<rdf::TermId> ids = subjects(reader);
  std::sort(ids.begin(), ids.end());
  if (state.range(0) == 1) std::shuffle(ids.begin(), ids.end(), std::mt19937(5));
  const rdf::TermId near = idOf(reader, "near");
  rdf::PrefixLookup lookup = reader.lookup(rdf::QuadOrder::Spog);
  std::size_t i = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    found += lookup.find(std::array{ids[i], near}).size();
    if (++i == ids.size()) i = 0;
  }
  benchmark::DoNotOptimize(found);
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(lookup)->Arg(0)->Arg(1);

void contains(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  std::vector<rdf::TermId> ids = subjects(reader);
  std::shuffle(ids.begin(), ids.end(), std::mt19937(5));
  const rdf::TermId near = idOf(reader, "near");
  std::size_t i = 0;
  std::size_t found = 0;
  for (auto _ : state) {
    found += reader.contains({ids[i], near, ids[ids.size() - 1 - i], 0}) ? 1 : 0;
    if (++i == ids.size()) i = 0;
  }
  benchmark::DoNotOptimize(found);
}
BENCHMARK(contains);

void scanCursor(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const rdf::QuadPattern pattern{.s = {}, .p = idOf(reader, "near"), .o = {}, .g = {}};
  std::size_t count = 0;
  for (auto _ : state) {
    rdf::QuadCursor cursor = reader.scan(pattern);
    for (rdf::QuadIds quad; cursor.next(quad);) count += quad.o;
  }
  benchmark::DoNotOptimize(count);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(reader.count(pattern)));
}
BENCHMARK(scanCursor)->Unit(benchmark::kMillisecond);

void scanInBulk(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const rdf::QuadPattern pattern{.s = {}, .p = idOf(reader, "near"), .o = {}, .g = {}};
  std::vector<rdf::QuadIds> buffer(1024);
  std::size_t sum = 0;
  for (auto _ : state) {
    rdf::QuadCursor cursor = reader.scan(pattern);
    while (const std::size_t count = cursor.next(buffer))
      for (std::size_t i = 0; i < count; ++i) sum += buffer[i].o;
  }
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(reader.count(pattern)));
}
BENCHMARK(scanInBulk)->Unit(benchmark::kMillisecond);

void countExactly(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const rdf::QuadPattern pattern{.s = {}, .p = idOf(reader, "near"), .o = {}, .g = {}};
  for (auto _ : state) benchmark::DoNotOptimize(reader.count(pattern));
}
BENCHMARK(countExactly);

void estimate(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const rdf::QuadPattern pattern{.s = {}, .p = idOf(reader, "near"), .o = {}, .g = {}};
  for (auto _ : state) benchmark::DoNotOptimize(reader.estimate(pattern));
}
BENCHMARK(estimate);

void valuesWarm(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const auto terms = static_cast<rdf::TermId>(reader.termCount());
  for (rdf::TermId id = 1; id <= terms; ++id) benchmark::DoNotOptimize(reader.valueOf(id));
  std::mt19937 random(3);
  std::vector<rdf::TermId> ids(100'000);
  for (rdf::TermId& id : ids) id = 1 + static_cast<rdf::TermId>(random() % terms);
  double sum = 0;
  for (auto _ : state)
    for (const rdf::TermId id : ids) sum += reader.valueOf(id).number;
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ids.size()));
}
BENCHMARK(valuesWarm)->Unit(benchmark::kMicrosecond);

void termTexts(benchmark::State& state) {
  const auto environment = rdf::Environment::open(compactMap(), rdf::OpenMode::ReadOnly);
  const rdf::QuadReader reader(environment->read());
  const auto terms = static_cast<rdf::TermId>(reader.termCount());
  std::mt19937 random(3);
  std::vector<rdf::TermId> ids(100'000);
  for (rdf::TermId& id : ids) id = 1 + static_cast<rdf::TermId>(random() % terms);
  std::size_t sum = 0;
  for (auto _ : state)
    for (const rdf::TermId id : ids) sum += reader.viewOf(id).text.size();
  benchmark::DoNotOptimize(sum);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ids.size()));
}
BENCHMARK(termTexts)->Unit(benchmark::kMicrosecond);

/// One new triple a commit, each synced to the disk.
void commitOne(benchmark::State& state) {
  const fs::path file = scratch() / "commit.clx";
  load(file);
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
  rdf::TermId n = 1;
  for (auto _ : state) {
    rdf::WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    writer.add(rdf::QuadIds{n, 1, ++n, 0});
    writer.flush();
    transaction.commit();
  }
}
BENCHMARK(commitOne)->Unit(benchmark::kMillisecond)->Iterations(20);

/// Ten thousand quads among a million, in one commit.
void addTenThousand(benchmark::State& state) {
  const fs::path file = scratch() / "batch.clx";
  load(file);
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
  std::mt19937 random(9);
  for (auto _ : state) {
    rdf::WriteTransaction transaction = environment->write();
    rdf::QuadWriter writer(transaction);
    for (int i = 0; i < 10'000; ++i)
      writer.add(rdf::QuadIds{1 + static_cast<rdf::TermId>(random() % 200'000), 2,
                              1 + static_cast<rdf::TermId>(random() % 200'000), 0});
    writer.flush();
    transaction.commit();
  }
}
BENCHMARK(addTenThousand)->Unit(benchmark::kMillisecond)->Iterations(5);

/// A model of librdf over one of its own storages (0 hashes in memory, 1 trees) with triples in it.
class LibrdfModel {
 public:
  LibrdfModel(std::int64_t kind, const std::string& text) {
    librdf_world_open(world_);
    storage_ = kind == 0 ? librdf_new_storage(world_, "hashes", "b", "hash-type='memory',new='yes'")
                         : librdf_new_storage(world_, "trees", "b", nullptr);
    model_ = librdf_new_model(world_, storage_, nullptr);
    librdf_parser* parser = librdf_new_parser(world_, "ntriples", nullptr, nullptr);
    librdf_uri* base = librdf_new_uri(world_, bytes("http://x/"));
    librdf_parser_parse_string_into_model(parser, bytes(text), base, model_);
    librdf_free_uri(base);
    librdf_free_parser(parser);
  }
  ~LibrdfModel() {
    librdf_free_model(model_);
    librdf_free_storage(storage_);
    librdf_free_world(world_);
  }
  LibrdfModel(const LibrdfModel&) = delete;
  LibrdfModel& operator=(const LibrdfModel&) = delete;

  librdf_node* node(const std::string& iri) const { return librdf_new_node_from_uri_string(world_, bytes(iri)); }
  librdf_model* get() const { return model_; }

 private:
  static const unsigned char* bytes(const std::string& text) {
    return reinterpret_cast<const unsigned char*>(text.c_str());
  }
  librdf_world* world_ = librdf_new_world();
  librdf_storage* storage_ = nullptr;
  librdf_model* model_ = nullptr;
};

/// Loading into librdf's own storages: 0 hashes in memory, 1 trees. 100k triples.
void loadLibrdf(benchmark::State& state) {
  const std::string text = generatedNTriples(100'000);
  for (auto _ : state) LibrdfModel(state.range(0), text);
}
BENCHMARK(loadLibrdf)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->Iterations(1);

/// Targets of random subjects in librdf's own storages of 100k triples: 0 hashes in memory, 1 trees.
void lookupLibrdf(benchmark::State& state) {
  const std::size_t objects = 100'000 / 8;
  const LibrdfModel model(state.range(0), generatedNTriples(100'000));
  librdf_node* near = model.node("https://w3id.org/cluxel/ontology#near");
  std::mt19937 random(8);
  std::size_t found = 0;
  for (auto _ : state) {
    const std::size_t i = random() % objects;
    librdf_node* subject =
        model.node("https://w3id.org/cluxel/map/object/" + std::to_string(i * 2654435761U % 4294967291U));
    librdf_iterator* targets = librdf_model_get_targets(model.get(), subject, near);
    for (; librdf_iterator_end(targets) == 0; librdf_iterator_next(targets)) ++found;
    librdf_free_iterator(targets);
    librdf_free_node(subject);
  }
  benchmark::DoNotOptimize(found);
  librdf_free_node(near);
}
BENCHMARK(lookupLibrdf)->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond)->Iterations(20);

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  std::filesystem::remove_all(scratch());
}
