// The experiments of a task: each data reference, bound to the model.
#include "check/task/task_checker.hpp"

#include <algorithm>

#include "check/data/binding.hpp"
#include "check/message/errors.hpp"
#include "syntax/words.hpp"

namespace sysid {
namespace {

std::string part_name(DataBlock const& block, int part) {
  return part < 0 ? block.name : block.name + "." + block.parts[static_cast<std::size_t>(part)].name;
}

bool share_rows(DataBlock const& block, int one, int other) {
  if (one < 0 || other < 0) return true;
  DataPart const& a = block.parts[static_cast<std::size_t>(one)];
  DataPart const& b = block.parts[static_cast<std::size_t>(other)];
  return (a.last == 0 || b.first <= a.last) && (b.last == 0 || a.first <= b.last);
}

}  // namespace

std::optional<ExperimentUse> TaskChecker::experiment(ast::DataReference const& reference, Model const* model) {
  auto const found = item(reference.data, names_.data, "data block");
  if (!found) return std::nullopt;
  ExperimentUse use;
  use.data = *found;
  DataBlock const& block = file_.data[static_cast<std::size_t>(use.data)];
  if (reference.part) {
    auto const place = std::find_if(block.parts.begin(), block.parts.end(),
                                    [&](DataPart const& each) { return each.name == reference.part->text; });
    if (place == block.parts.end()) {
      std::vector<std::string> known;
      for (DataPart const& each : block.parts) known.push_back(each.name);
      diagnostics_.add(errors::unknown_member(*reference.part, errors::named("data", block.name), "range", known));
      return std::nullopt;
    }
    use.part = static_cast<int>(place - block.parts.begin());
  }
  if (model == nullptr) return std::nullopt;
  check_binding(block, *model, words::task_kind(tree_.verb.text) == TaskKind::discover ? "dictionary" : "model", names_.declared,
                reference.span, diagnostics_);
  use.constants = check_constants(block, *model, names_.declared, reference.span, diagnostics_);
  return use;
}

std::vector<ExperimentUse> TaskChecker::experiments(Model const* model, std::string const& preposition) {
  std::vector<ExperimentUse> uses;
  if (tree_.data.empty()) diagnostics_.add(errors::data_missing(tree_, preposition));
  std::vector<Span> places;
  for (ast::DataReference const& reference : tree_.data)
    if (auto use = experiment(reference, model)) {
      uses.push_back(std::move(*use));
      places.push_back(reference.span);
    }
  for (std::size_t i = 0; i < uses.size(); ++i) {
    DataBlock const& block = file_.data[static_cast<std::size_t>(uses[i].data)];
    auto const same = [&](ExperimentUse const& other) { return other.data == uses[i].data; };
    bool const alone = std::count_if(uses.begin(), uses.end(), same) == 1;
    uses[i].name = alone ? block.name : part_name(block, uses[i].part);
    // What is predicted may overlap; two results of one name would replace each other.
    bool const predicted = preposition == "on";
    for (std::size_t before = 0; before < i; ++before)
      if (bool const equal = uses[before].part == uses[i].part;
          same(uses[before]) && (equal || (!predicted && share_rows(block, uses[before].part, uses[i].part)))) {
        diagnostics_.add(equal ? errors::experiment_twice(places[i], places[before], part_name(block, uses[i].part), predicted)
                               : errors::experiments_overlap(places[i], places[before], part_name(block, uses[i].part),
                                                             part_name(block, uses[before].part)));
        break;
      }
  }
  return uses;
}

}  // namespace sysid
