// A whole file: models and data blocks, then sets of candidates, then tasks in order. What fails its own check is not reported
// again where it is used.
#include "check/check.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "check/cascade_filter.hpp"
#include "check/data/binding.hpp"
#include "check/data/data.hpp"
#include "check/dictionary/dictionary.hpp"
#include "check/message/errors.hpp"
#include "check/model/letter_units.hpp"
#include "check/model/model.hpp"
#include "check/model/unit_blame.hpp"
#include "check/model/unused.hpp"
#include "check/task/candidates.hpp"
#include "check/task/tasks.hpp"
#include "syntax/find_model.hpp"

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

bool mentioned(std::vector<ast::Task const*> const& tasks, std::string const& block) {
  return std::any_of(tasks.begin(), tasks.end(), [&](ast::Task const* task) {
    return std::any_of(task->data.begin(), task->data.end(), [&](auto const& each) { return each.data.text == block; });
  });
}

/// The passes over a file, in their order.
class FileChecker {
 public:
  FileChecker(Elaborated const& elaborated, Backends const& backends, Diagnostics& diagnostics)
      : tree_(elaborated.tree),
        lineage_(elaborated.lineage),
        backends_(backends),
        diagnostics_(diagnostics),
        unsound_(elaborated.lineage.failed) {
    file_.tree = tree_;
    names_.declared = declared_names(tree_);
    names_.declared.all = lineage_.failed.empty();
    for (std::string const& failed : lineage_.failed) names_.models[failed] = std::nullopt;
  }

  std::optional<CheckedFile> run() {
    collect();
    for (ast::Item const& item : tree_.items) check_item(item);
    for (ast::Item const& item : tree_.items)
      if (auto const* set = std::get_if<ast::Candidates>(&item)) check_set(*set);
    for (ast::Task const* task : tasks_)
      if (auto checked = check_task(*task, names_, file_, backends_, tasks_, diagnostics_))
        file_.tasks.push_back(std::move(*checked));
    check_unused_data();
    remove_cascades(tree_, diagnostics_);
    refuse_unused_disturbances(file_.models, diagnostics_);
    if (diagnostics_.has_errors()) return std::nullopt;
    warn_of_unused(file_.models, diagnostics_);
    return std::move(file_);
  }

 private:
  // Functions and tasks, which others refer to.
  void collect() {
    for (ast::Item const& item : tree_.items) {
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&item))
        if (unique_function_(function->name, function->name.text)) functions_.push_back(function);
      if (auto const* task = std::get_if<ast::Task>(&item))
        if (unique_task_(task->name ? *task->name : task->verb, task_name(*task))) tasks_.push_back(task);
    }
  }

  void check_item(ast::Item const& item) {
    if (auto const* model = std::get_if<ast::Model>(&item)) {
      if (unique_model_(model->name, model->name.text)) check_one(*model);
    } else if (auto const* data = std::get_if<ast::Data>(&item)) {
      if (unique_data_(data->name, data->name.text))
        names_.data[data->name.text] = keep(check_data(*data, diagnostics_), file_.data);
    } else if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) {
      if (unique_dictionary_(dictionary->name, dictionary->name.text))
        names_.dictionaries[dictionary->name.text] =
            keep(check_dictionary(*dictionary, functions_, diagnostics_), file_.dictionaries);
    }
  }

  void check_one(ast::Model const& model) {
    std::string const& name = model.name.text;
    auto const made_of = lineage_.made_of.find(name);
    bool const sound =
        made_of == lineage_.made_of.end() || std::none_of(made_of->second.begin(), made_of->second.end(),
                                                          [&](std::string const& each) { return unsound_.contains(each); });
    std::size_t const before = diagnostics_.all().size();
    auto checked = sound ? check_model(model, functions_, diagnostics_) : std::nullopt;
    if (sound && !checked) {
      blame_letters(model, functions_, before, diagnostics_);
      blame_declaration(model, functions_, before, diagnostics_);
    }
    if (!checked) unsound_.insert(name);
    if (checked && lineage_.only_checked.contains(name)) return;
    names_.models[name] = keep(std::move(checked), file_.models);
  }

  void check_set(ast::Candidates const& set) {
    if (!unique_candidates_(set.name, set.name.text)) return;
    if (ast::Model const* model = find_model(tree_, set.name.text); model != nullptr)
      diagnostics_.add(errors::model_and_candidates(set.name, model->name.span));
    names_.candidates[set.name.text] = keep(check_candidates(set, names_.models, file_, diagnostics_), file_.candidates);
  }

  // A block that no task brings together with a model is held to what continuous time needs, unless the file has other models.
  void check_unused_data() {
    bool const other_dynamics = std::any_of(file_.models.begin(), file_.models.end(),
                                            [](Model const& model) { return model.dynamics != Dynamics::continuous; });
    for (DataBlock const& block : file_.data)
      if (!other_dynamics && !mentioned(tasks_, block.name)) check_between_samples(block, nullptr, diagnostics_);
  }

  // Its index among the items; nothing where it failed its check.
  template <typename Item>
  static std::optional<int> keep(std::optional<Item> checked, std::vector<Item>& items) {
    if (!checked) return std::nullopt;
    items.push_back(std::move(*checked));
    return static_cast<int>(items.size()) - 1;
  }

  ast::File const& tree_;
  Lineage const& lineage_;
  Backends const& backends_;
  Diagnostics& diagnostics_;
  CheckedFile file_;
  TaskNames names_;
  std::set<std::string> unsound_;  // what is made of them is not looked at: it has the same mistakes
  std::vector<ast::FunctionDefinition const*> functions_;
  std::vector<ast::Task const*> tasks_;
  Unique unique_model_{"model", diagnostics_}, unique_data_{"data block", diagnostics_}, unique_task_{"task", diagnostics_},
      unique_function_{"function", diagnostics_}, unique_candidates_{"candidate set", diagnostics_},
      unique_dictionary_{"dictionary", diagnostics_};
};

}  // namespace

std::optional<CheckedFile> check(Elaborated const& elaborated, Backends const& backends, Diagnostics& diagnostics) {
  return FileChecker(elaborated, backends, diagnostics).run();
}

}  // namespace sysid
