// Models, data, tasks; laid out by the formatter.
#include "discovery/found_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/text/diagnostic.hpp"
#include "discovery/found_model.hpp"
#include "discovery/preparation/held_out_rows.hpp"
#include "syntax/format.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

/// Rows from which the state of a record that was not fitted is estimated.
constexpr int rows_of_start = 50;

/// A data block with what the models read, its file as seen from `folder`; home: the folder of the .sysid file.
std::string data_text(ast::Data data, DataBlock const& block, std::filesystem::path const& home,
                      std::filesystem::path const& folder, std::set<std::string> const& inputs,
                      std::set<std::string> const& channels) {
  std::erase_if(data.statements, [&](ast::DataStatement const& statement) {
    if (auto const* input = std::get_if<ast::DataInput>(&statement)) return !inputs.contains(input->input.text);
    if (auto const* measured = std::get_if<ast::DataMeasure>(&statement)) return !channels.contains(measured->channel.text);
    return std::holds_alternative<ast::DataConstant>(statement);
  });
  auto const place = [](std::filesystem::path const& path) { return std::filesystem::absolute(path).lexically_normal(); };
  std::filesystem::path const file = place(home / block.path);
  std::filesystem::path const seen = file.lexically_relative(place(folder));
  for (ast::DataStatement& statement : data.statements)
    if (auto* path = std::get_if<ast::DataFile>(&statement)) path->path.value = (seen.empty() ? file : seen).string();
  return unparse(ast::File{{std::move(data)}});
}

}  // namespace

std::string FoundSource::text(std::vector<FoundStructure> const& structures) const {
  std::string const title = dictionary.title.empty() ? "of the dictionary " + dictionary.name : dictionary.title;
  std::string out = fmt::format("# found by `discover {} from {}` with {}, seed {}\n", dictionary.name,
                                data_names(file, what.experiments), what.selector, seed);
  out +=
      "# sd of the prior of each coefficient: ten times that of the regression, at least a tenth of the coefficient; wide, because "
      "the fit uses the "
      "same record again\n\n";
  std::vector<std::string> models;
  std::set<std::string> inputs, channels;
  for (Channel const& channel : dictionary.measured.channels) channels.insert(channel.name);
  for (std::size_t k = 0; k < structures.size(); ++k) {
    models.push_back(k == 0 ? task.name : fmt::format("{}_{}", task.name, k + 1));
    FoundModel const model =
        found_model(*this, structures[k], models.back(), k == 0 ? title : fmt::format("{}, structure {}", title, k + 1));
    out += model.text + "\n";
    for (std::size_t const i : model.inputs) inputs.insert(dictionary.measured.inputs[i].name);
  }
  std::string uses;
  bool later = false;  // some rows lie before those that are scored
  std::set<int> blocks;
  std::string unseen;
  for (ExperimentUse const& use : what.experiments) {
    DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
    uses += (uses.empty() ? "" : ", ") + data_name(block, use.part);
    later = later || (use.part >= 0 && block.parts[static_cast<std::size_t>(use.part)].first > 1);
    if (!blocks.insert(use.data).second) continue;
    for (ast::Item const& item : file.tree.items)
      if (auto const* data = std::get_if<ast::Data>(&item); data != nullptr && data->name.text == block.name)
        out += data_text(*data, block, folder, results, inputs, channels) + "\n";
  }
  for (ExperimentUse const& use : unused_parts(file, what, 4 * rows_of_start + 1))
    unseen += (unseen.empty() ? "" : ", ") + data_name(file.data[static_cast<std::size_t>(use.data)], use.part);
  std::string const start = later && !dictionary.numbers.discrete ? ", start = rest" : "";
  if (structures.size() > 1) {
    out += fmt::format("candidates structures {{\n{}\n}}\n\n", fmt::join(models, "\n"));
    out += fmt::format("selection = select structures to {} with abc_smc(particles = 1000){}, seed = {}\n", uses, start, seed);
  }
  out += fmt::format("posterior = fit {} to {} with mh{}, seed = {}\n", task.name, uses, start, seed);
  out += fmt::format("fitted = predict posterior on {} with draws(200){}, seed = {}\n", uses, start, seed);
  if (!unseen.empty() && dictionary.numbers.discrete)  // where it begins is told by the samples before
    out += fmt::format("forecast = predict posterior on {} with draws(200), seed = {}\n", unseen, seed);
  else if (!unseen.empty())
    out += fmt::format("forecast = predict posterior on {} with draws(200), start = estimated(rows = {}), seed = {}\n", unseen,
                       rows_of_start, seed);
  Diagnostics diagnostics;
  auto laid_out = formatted(Source("found.sysid", out), diagnostics);
  if (!laid_out) throw InternalError("the source of a discovery does not parse: " + diagnostics.all().front().message);
  return *laid_out;
}

std::string with_verdict(std::string const& source, std::string const& verdict, Findings const& findings) {
  std::vector<std::string> lines = {"verdict of the discovery: " + verdict};
  for (Finding const& each : findings)
    if (each.severity != Severity::note)
      lines.push_back(
          fmt::format("{}[{}]: {}", each.severity == Severity::error ? "error" : "warning", word(each.code), each.message));
  std::string comments = "#\n";
  for (std::string& each : lines) {
    std::replace(each.begin(), each.end(), '\n', ' ');
    comments += "# " + each + "\n";
  }
  std::size_t const head = source.find("\n\n");
  return head == std::string::npos ? comments + source : source.substr(0, head + 1) + comments + source.substr(head + 1);
}

}  // namespace sysid
