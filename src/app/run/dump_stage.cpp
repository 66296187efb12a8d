// What a stage made of a file, as text.
#include <fmt/format.h>

#include "app/preflight/check_file.hpp"
#include "app/run/pipeline.hpp"
#include "likelihood/compiled_model.hpp"
#include "model/dump.hpp"
#include "report/page/check_page.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

std::string dump(CandidateSet const& set) {
  std::string text = fmt::format("candidates {}{}\n", set.name, set.title.empty() ? "" : " \"" + set.title + "\"");
  for (CandidateModel const& each : set.models) text += fmt::format("  {} probability {}\n", each.name, each.probability);
  if (!set.shared.empty()) text += fmt::format("  shared {}\n", fmt::join(set.shared, ", "));
  return text;
}

}  // namespace

std::string dump_stage(Source& source, std::string const& stage, Diagnostics& diagnostics) {
  if (stage == "ast") {
    auto const tree = parse(source, diagnostics);
    return tree ? unparse(*tree) : std::string();
  }
  auto const file = load(source, diagnostics);
  if (!file) return {};
  if (stage == "flat") return unparse(file->tree);
  std::string text;
  for (Model model : file->models) {
    if (stage == "program") remove_processes(model);
    text +=
        stage == "model"
            ? dump(model)
            : dump_program(*compile(model, false, model.implicit ? std::string(implicit_solver().name) : SolverSettings{}.method));
  }
  if (stage == "model") {
    for (CandidateSet const& set : file->candidates) text += dump(set);
    for (CheckedDictionary const& dictionary : file->dictionaries) text += dictionary_text(describe_dictionary(dictionary));
  }
  return text;
}

}  // namespace sysid
