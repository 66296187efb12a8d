// What an editor waits for: from an edit to its diagnostics, completion, hover, renaming. One file for each shipped model.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/system/files.hpp"
#include "lsp/documents.hpp"
#include "lsp/server.hpp"

namespace {

using namespace sysid;
using lsp::Json;

std::vector<std::filesystem::path> const& models() {
  static std::vector<std::filesystem::path> const all = [] {
    std::vector<std::filesystem::path> files;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / "models"))
      if (entry.path().extension() == ".sysid") files.push_back(entry.path());
    std::sort(files.begin(), files.end(),
              [](auto const& a, auto const& b) { return std::filesystem::file_size(a) > std::filesystem::file_size(b); });
    return files;
  }();
  return all;
}

struct Open {
  std::string text, uri;
  lsp::Server server;
  explicit Open(std::filesystem::path const& path) : text(read_file(path)), uri(lsp::uri_of(path.string())) {
    server.handle({{"id", 1}, {"method", "initialize"}});
    server.handle({{"method", "textDocument/didOpen"}, {"params", {{"textDocument", {{"uri", uri}, {"text", text}}}}}});
    server.publish();
  }
  Json ask(char const* method, std::size_t offset, Json params = Json::object()) {
    params["textDocument"] = {{"uri", uri}};
    params["position"] = lsp::to_json(lsp::Lines(text).position(static_cast<std::uint32_t>(offset)));
    return server.handle({{"id", 2}, {"method", method}, {"params", params}});
  }
  void edit(Span span, std::string const& with) {
    server.handle({{"method", "textDocument/didChange"},
                   {"params",
                    {{"textDocument", {{"uri", uri}}},
                     {"contentChanges", {{{"range", lsp::range(lsp::Lines(text), span)}, {"text", with}}}}}}});
    text.replace(span.begin, span.end - span.begin, with);
  }
  std::uint32_t statement() const { return static_cast<std::uint32_t>(text.find("observe")); }
};

void edit_to_diagnostics(benchmark::State& state) {
  std::filesystem::path const& path = models()[static_cast<std::size_t>(state.range(0))];
  Open open(path);
  std::uint32_t const at = static_cast<std::uint32_t>(open.text.rfind("seed = 1"));
  if (at > open.text.size()) return state.SkipWithError("no place to edit");
  bool there = false;
  for (auto _ : state) {
    open.edit({at + 8, at + (there ? 9U : 8U)}, there ? "" : "2");
    there = !there;
    benchmark::DoNotOptimize(open.server.publish());
  }
  state.SetLabel(path.filename().string());
}

/// A statement in the making, in the model.
void completion(benchmark::State& state) {
  std::filesystem::path const& path = models()[static_cast<std::size_t>(state.range(0))];
  Open open(path);
  std::uint32_t const at = open.statement();
  if (at > open.text.size()) return state.SkipWithError("no model in this file");
  open.edit({at, at}, "let q = \n  ");
  for (auto _ : state) benchmark::DoNotOptimize(open.ask("textDocument/completion", at + 8));
  state.SetLabel(path.filename().string());
}

void hover(benchmark::State& state) {
  Open open(models().front());
  for (auto _ : state) benchmark::DoNotOptimize(open.ask("textDocument/hover", open.text.find("sigma")));
}

void rename(benchmark::State& state) {
  Open open(models().front());
  for (auto _ : state) benchmark::DoNotOptimize(open.ask("textDocument/rename", open.text.find("sigma"), {{"newName", "scatter"}}));
}

void each_model(benchmark::internal::Benchmark* one) {
  for (std::size_t i = 0; i < models().size(); ++i) one->Arg(static_cast<int>(i));
  one->Unit(benchmark::kMillisecond);
}

BENCHMARK(edit_to_diagnostics)->Apply(each_model);
BENCHMARK(completion)->Apply(each_model);
BENCHMARK(hover)->Unit(benchmark::kMillisecond);
BENCHMARK(rename)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
