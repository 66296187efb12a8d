// A whole file: models and data blocks, then sets of candidates, then tasks in order. What fails its own check is not reported
// again where it is used.
#include "check/check.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "check/cascade_filter.hpp"
#include "check/data/data.hpp"
#include "check/dictionary/dictionary.hpp"
#include "check/message/errors.hpp"
#include "check/model/model.hpp"
#include "check/model/unit_blame.hpp"
#include "check/model/unused.hpp"
#include "check/task/candidates.hpp"
#include "check/task/tasks.hpp"

namespace sysid {
namespace {

class Unique {
 public:
  Unique(std::string kind, Diagnostics& diagnostics) : kind_(std::move(kind)), diagnostics_(diagnostics) {}
  bool operator()(ast::Name const& name, std::string const& text) {
    auto const [place, fresh] = seen_.emplace(text, name.span);
    if (!fresh) diagnostics_.add(errors::duplicate_item({{name.span}, text}, kind_, place->second));
    return fresh;
  }

 private:
  std::string kind_;
  Diagnostics& diagnostics_;
  std::map<std::string, Span> seen_;
};

}  // namespace

namespace {

ast::Model const* find_model(ast::File const& tree, std::string const& name) {
  for (ast::Item const& item : tree.items)
    if (auto const* model = std::get_if<ast::Model>(&item); model != nullptr && model->name.text == name) return model;
  return nullptr;
}

bool mentioned(std::vector<ast::Task const*> const& tasks, std::string const& block) {
  return std::any_of(tasks.begin(), tasks.end(), [&](ast::Task const* task) {
    return std::any_of(task->data.begin(), task->data.end(), [&](auto const& each) { return each.data.text == block; });
  });
}

}  // namespace

std::optional<CheckedFile> check(Elaborated const& elaborated, Backends const& backends, Diagnostics& diagnostics) {
  ast::File const& tree = elaborated.tree;
  Lineage const& lineage = elaborated.lineage;
  CheckedFile file;
  file.tree = tree;
  TaskNames names;
  names.declared = declared_names(tree);
  names.declared.all = lineage.failed.empty();
  for (std::string const& failed : lineage.failed) names.models[failed] = std::nullopt;
  std::set<std::string> unsound = lineage.failed;  // what is made of them is not looked at: it has the same mistakes
  std::vector<ast::FunctionDefinition const*> functions;
  std::vector<ast::Task const*> tasks;
  Unique unique_model("model", diagnostics), unique_data("data block", diagnostics), unique_task("task", diagnostics),
      unique_function("function", diagnostics), unique_candidates("candidate set", diagnostics),
      unique_dictionary("dictionary", diagnostics);
  for (ast::Item const& item : tree.items) {
    if (auto const* function = std::get_if<ast::FunctionDefinition>(&item))
      if (unique_function(function->name, function->name.text)) functions.push_back(function);
    if (auto const* task = std::get_if<ast::Task>(&item))
      if (unique_task(task->name ? *task->name : task->verb, task_name(*task))) tasks.push_back(task);
  }
  for (ast::Item const& item : tree.items) {
    if (auto const* model = std::get_if<ast::Model>(&item)) {
      if (!unique_model(model->name, model->name.text)) continue;
      auto const made_of = lineage.made_of.find(model->name.text);
      bool const sound =
          made_of == lineage.made_of.end() || std::none_of(made_of->second.begin(), made_of->second.end(),
                                                           [&](std::string const& each) { return unsound.contains(each); });
      std::size_t const before = diagnostics.all().size();
      auto checked = sound ? check_model(*model, functions, diagnostics) : std::nullopt;
      if (sound && !checked) blame_declaration(*model, functions, before, diagnostics);
      if (!checked) unsound.insert(model->name.text);
      if (checked && lineage.only_checked.contains(model->name.text)) continue;
      names.models[model->name.text] = checked ? std::optional(static_cast<int>(file.models.size())) : std::nullopt;
      if (checked) file.models.push_back(std::move(*checked));
    } else if (auto const* data = std::get_if<ast::Data>(&item)) {
      if (!unique_data(data->name, data->name.text)) continue;
      auto checked = check_data(*data, diagnostics);
      names.data[data->name.text] = checked ? std::optional(static_cast<int>(file.data.size())) : std::nullopt;
      if (checked) file.data.push_back(std::move(*checked));
    } else if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) {
      if (!unique_dictionary(dictionary->name, dictionary->name.text)) continue;
      auto checked = check_dictionary(*dictionary, functions, diagnostics);
      names.dictionaries[dictionary->name.text] =
          checked ? std::optional(static_cast<int>(file.dictionaries.size())) : std::nullopt;
      if (checked) file.dictionaries.push_back(std::move(*checked));
    }
  }
  for (ast::Item const& item : tree.items) {
    auto const* set = std::get_if<ast::Candidates>(&item);
    if (set == nullptr || !unique_candidates(set->name, set->name.text)) continue;
    if (ast::Model const* model = find_model(tree, set->name.text); model != nullptr)
      diagnostics.add(errors::model_and_candidates(set->name, model->name.span));
    auto checked = check_candidates(*set, names.models, file, diagnostics);
    names.candidates[set->name.text] = checked ? std::optional(static_cast<int>(file.candidates.size())) : std::nullopt;
    if (checked) file.candidates.push_back(std::move(*checked));
  }
  for (ast::Task const* task : tasks) {
    auto checked = check_task(*task, names, file, backends, tasks, diagnostics);
    if (checked) file.tasks.push_back(std::move(*checked));
  }
  // A block that no task brings together with a model is held to what continuous time needs, unless the file has other models.
  bool const other_dynamics = std::any_of(file.models.begin(), file.models.end(),
                                          [](Model const& model) { return model.dynamics != Dynamics::continuous; });
  for (DataBlock const& block : file.data)
    if (!other_dynamics && !mentioned(tasks, block.name)) check_between_samples(block, nullptr, diagnostics);
  remove_consequences(tree, diagnostics);
  if (diagnostics.has_errors()) return std::nullopt;
  for (Model const& model : file.models) warn_of_unused(model, diagnostics);
  return file;
}

}  // namespace sysid
