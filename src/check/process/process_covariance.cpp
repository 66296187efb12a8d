// From `gp(...)` to kernels: names, settings, inputs and hyper-parameters of each.
#include "check/process/process_covariance.hpp"

#include <algorithm>
#include <utility>

#include "check/expression/leaves.hpp"
#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"

namespace sysid {
namespace {

using gaussian_process::HyperParameterRow;
using gaussian_process::KernelRow;

class CovarianceReader {
 public:
  CovarianceReader(Scope& scope, ast::ProcessDefinition const& definition, Process& process,
                   std::vector<std::vector<int>> const& columns, HyperParametersGiven& given)
      : scope_(scope), definition_(definition), process_(process), columns_(columns), given_(given) {}

  bool covariance(ast::Expression const& tree) {
    if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
        binary != nullptr && ((*binary)->symbol == "+" || (*binary)->symbol == "*")) {
      if (!covariance(*(*binary)->left)) return false;
      int const left = static_cast<int>(process_.covariance.size()) - 1;
      if (!covariance(*(*binary)->right)) return false;
      int const right = static_cast<int>(process_.covariance.size()) - 1;
      auto const kind = (*binary)->symbol == "+" ? Process::Covariance::Kind::sum : Process::Covariance::Kind::product;
      process_.covariance.push_back({kind, left, right});
      return true;
    }
    auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node);
    return call != nullptr ? kernel(**call) : refuse(errors::not_a_covariance(tree.span));
  }

 private:
  bool refuse(Diagnostic diagnostic) {
    scope_.diagnostics().add(std::move(diagnostic));
    return false;
  }

  bool kernel(ast::Call const& call) {
    KernelUse use;
    use.row = gaussian_process::find_kernel(call.function.text);
    if (use.row == nullptr) {
      std::vector<std::string> known;
      for (KernelRow const& each : gaussian_process::kernels()) known.emplace_back(each.name);
      return refuse(errors::unknown_kernel(call.function, known));
    }
    std::map<std::string, ast::Argument const*> named;
    std::vector<int> inputs;  // as declared
    for (ast::Argument const& argument : call.arguments) {
      if (!argument.name) {
        int const input = input_of(argument.value);
        if (input < 0) return false;
        if (std::find(inputs.begin(), inputs.end(), input) != inputs.end())
          return refuse(errors::kernel_input_twice(argument.span, definition_.inputs[static_cast<std::size_t>(input)].text));
        inputs.push_back(input);
      } else if (auto const [place, fresh] = named.emplace(argument.name->text, &argument); !fresh) {
        return refuse(errors::argument_twice(argument.span, place->second->span, argument.name->text, argument.name->text));
      }
    }
    if (inputs.empty())
      for (int i = 0; i < static_cast<int>(definition_.inputs.size()); ++i) inputs.push_back(i);
    for (int const input : inputs)
      use.inputs.insert(use.inputs.end(), columns_[static_cast<std::size_t>(input)].begin(),
                        columns_[static_cast<std::size_t>(input)].end());
    if (use.row->one_input && use.inputs.size() != 1)
      return refuse(errors::kernel_of_one_input(call.span, call.function.text, use.inputs.size()));
    given_.emplace_back();
    if (!hyper_parameters(call, inputs, named, use)) return false;
    process_.covariance.push_back({Process::Covariance::Kind::kernel, static_cast<int>(process_.kernels.size()), 0});
    process_.kernels.push_back(std::move(use));
    return true;
  }

  int input_of(ast::Expression const& tree) {
    auto const* reference = std::get_if<ast::Reference>(&tree.node);
    std::vector<std::string> known;
    for (std::size_t i = 0; i < definition_.inputs.size(); ++i) {
      if (reference != nullptr && reference->primes == 0 && reference->index.empty() &&
          reference->name.text == definition_.inputs[i].text)
        return static_cast<int>(i);
      known.push_back(definition_.inputs[i].text);
    }
    refuse(errors::not_an_input_of_process(tree.span, reference == nullptr ? std::string() : reference->name.text,
                                           definition_.name.text, known));
    return -1;
  }

  bool hyper_parameters(ast::Call const& call, std::vector<int> const& inputs, std::map<std::string, ast::Argument const*>& named,
                        KernelUse const& use) {
    std::vector<std::string> known;
    for (HyperParameterRow const& row : use.row->hyper_parameters) known.emplace_back(row.name);
    for (auto const& [name, argument] : named)
      if (std::find(known.begin(), known.end(), name) == known.end())
        return refuse(errors::unknown_argument(*argument->name, call.function.text, known));
    for (HyperParameterRow const& row : use.row->hyper_parameters) {
      auto const found = named.find(std::string(row.name));
      if (found == named.end()) return refuse(errors::argument_missing(call, {std::string(row.name)}));
      ast::Expression const& tree = found->second->value;
      if (!row.per_input) {
        if (!add(row, use.inputs.size() == 1 ? use.inputs.front() : -1, tree)) return false;
        continue;
      }
      // One for each declared input; of an input that stands for several lags one for all of them, or a list.
      auto const* list = std::get_if<ast::Box<ast::List>>(&tree.node);
      if (list == nullptr) {
        for (int const column : use.inputs)
          if (!add(row, column, tree)) return false;
        continue;
      }
      bool const of_columns = inputs.size() == 1;  // `length = lu` of a vector lu
      std::size_t const wanted = of_columns ? use.inputs.size() : inputs.size();
      if ((*list)->items.size() != wanted)
        return refuse(errors::hyper_parameter_count(tree.span, std::string(row.name), (*list)->items.size(), wanted));
      for (std::size_t i = 0; i < wanted; ++i) {
        ast::Expression const& item = (*list)->items[i];
        if (of_columns) {
          if (!add(row, use.inputs[i], item)) return false;
          continue;
        }
        std::vector<int> const& columns = columns_[static_cast<std::size_t>(inputs[i])];
        auto const* inner = std::get_if<ast::Box<ast::List>>(&item.node);
        if (inner != nullptr && (*inner)->items.size() != columns.size())
          return refuse(errors::hyper_parameter_count(item.span, std::string(row.name), (*inner)->items.size(), columns.size()));
        for (std::size_t k = 0; k < columns.size(); ++k)
          if (!add(row, columns[k], inner == nullptr ? item : (*inner)->items[k])) return false;
      }
    }
    return true;
  }

  bool add(HyperParameterRow const& row, int column, ast::Expression const& tree) {
    auto const value = scope_.expression(tree);
    if (!value) return false;
    Graph const& graph = scope_.graph();
    std::string const name(row.name);
    if (std::string const what = moving_part(graph, value->node); !what.empty())
      return refuse(errors::hyper_parameter_moves(tree.span, name, what));
    if (auto const number = graph.constant_value(value->node); number && !(*number > 0))
      return refuse(errors::hyper_parameter_not_positive(tree.span, name));
    given_.back().push_back({&row, column, with_own_unit(*value)});
    given_.back().back().value.span = tree.span;
    given_.back().back().value.unit.offset = 0;  // a length along a scale of temperatures is a difference of two
    return true;
  }

  Scope& scope_;
  ast::ProcessDefinition const& definition_;
  Process& process_;
  std::vector<std::vector<int>> const& columns_;
  HyperParametersGiven& given_;
};

}  // namespace

std::optional<ProcessArguments> process_arguments(ast::ProcessDefinition const& definition, std::vector<std::string> const& known,
                                                  Diagnostics& diagnostics) {
  ast::Call const& call = definition.process;
  auto const refuse = [&](Diagnostic diagnostic) {
    diagnostics.add(std::move(diagnostic));
    return std::nullopt;
  };
  if (call.function.text != "gp") return refuse(errors::not_a_process(call.function));
  ProcessArguments result;
  for (ast::Argument const& argument : call.arguments) {
    if (!argument.name) {
      if (result.covariance != nullptr) return refuse(errors::one_covariance(call.span));
      result.covariance = &argument.value;
      continue;
    }
    std::string const& name = argument.name->text;
    if (std::find(known.begin(), known.end(), name) == known.end())
      return refuse(known.empty() ? errors::one_covariance(call.span) : errors::unknown_argument(*argument.name, "gp", known));
    if (auto const [place, fresh] = result.named.emplace(name, &argument); !fresh)
      return refuse(errors::argument_twice(argument.span, place->second->span, name, name));
  }
  if (result.covariance == nullptr) return refuse(errors::one_covariance(call.span));
  return result;
}

bool read_covariance(Scope& scope, ast::ProcessDefinition const& definition, ast::Expression const& covariance,
                     std::vector<std::vector<int>> const& columns, Process& process, HyperParametersGiven& given) {
  return CovarianceReader(scope, definition, process, columns, given).covariance(covariance);
}

}  // namespace sysid
