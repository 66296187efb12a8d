// A model as declared: names and units from the checked model, priors and expressions as the user wrote them.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/preflight/check_file.hpp"
#include "app/session/derived_draws.hpp"
#include "core/text/without_index.hpp"
#include "core/text/words.hpp"
#include "syntax/find_model.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

struct Texts {
  std::vector<std::string> equations;
  std::map<std::string, std::string> parameters, disturbances, channels, derived;
  std::map<std::string, std::string> starts;  // random ones, "~ normal(0, sd = 1)"
};

// What is said of a name first stays.
void add_texts(ast::File const& tree, std::string const& model, bool equations, Texts& texts) {
  auto const call = [](ast::Call const& use) { return unparse(ast::Expression{{}, ast::Box<ast::Call>(use)}); };
  ast::Model const* const found = find_model(tree, model);
  if (found == nullptr) return;
  for (ast::ModelStatement const& statement : found->statements) {
    if (auto const* equation = std::get_if<ast::Equation>(&statement); equation != nullptr && equations)
      texts.equations.push_back(unparse(equation->left) + " = " + unparse(equation->right));
    if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement))
      texts.parameters.try_emplace(parameter->name.name.text, parameter->prior   ? "~ " + call(*parameter->prior)
                                                              : parameter->value ? "= " + unparse(*parameter->value)
                                                                                 : std::string());
    if (auto const* disturbance = std::get_if<ast::DisturbanceDeclaration>(&statement))
      texts.disturbances.try_emplace(disturbance->name.name.text, "~ " + call(disturbance->law));
    if (auto const* initials = std::get_if<ast::InitialDeclaration>(&statement))
      for (ast::InitialValue const& initial : initials->values)
        if (initial.law) texts.starts.try_emplace(unparse(ast::Expression{{}, initial.state}), "~ " + call(*initial.law));
    if (auto const* observation = std::get_if<ast::Observation>(&statement))
      texts.channels.try_emplace(observation->channel.name.text, "~ " + call(observation->noise));
    if (auto const* definition = std::get_if<ast::Definition>(&statement))
      texts.derived.try_emplace(definition->name.name.text, "= " + unparse(definition->value));
  }
}

// The user's own text first; what that leaves open from the model with its parts written out: all of one that stands in a module,
// what parts bring to one of the file.
Texts texts_of(ast::File const& written, ast::File const& flat, std::string const& model) {
  Texts texts;
  add_texts(written, model, true, texts);
  add_texts(flat, model, texts.equations.empty() && texts.channels.empty(), texts);
  return texts;
}

/// What is said of a name; of an element, `m[1]`, what is said of all.
std::string text_of(std::map<std::string, std::string> const& texts, std::string const& name) {
  auto place = texts.find(name);
  if (place == texts.end()) place = texts.find(without_index(name));
  return place == texts.end() ? std::string() : place->second;
}

bool is_disturbance(Model const& model, std::string const& name) {
  return std::any_of(model.disturbances.begin(), model.disturbances.end(),
                     [&](Disturbance const& each) { return each.name == name; });
}

// "y", "y'", "y''" are one state of order 3; its unknown is y'''. Beside those there may be algebraic ones.
void add_orders(Model const& model, Texts const& texts, ModelPage& page) {
  std::vector<std::pair<State const*, int>> orders;
  std::map<std::string, std::string> random;  // by the first component
  for (State const& state : model.states) {
    if (is_disturbance(model, state.name)) continue;
    if (orders.empty() || !state.name.ends_with('\''))
      orders.emplace_back(&state, 1);
    else
      ++orders.back().second;
    if (std::string const start = text_of(texts.starts, state.name); !start.empty())
      random[orders.back().first->name] += fmt::format(", initial {} {}", state.name, start);
  }
  for (auto const& [state, order] : orders) {
    page.states.push_back({state->name, state->unit_text(), fmt::format("order {}{}", order, random[state->name])});
    if (model.unknowns.empty()) page.unknowns.push_back(state->name + std::string(static_cast<std::size_t>(order), '\''));
  }
  for (Unknown const& unknown : model.unknowns) page.unknowns.push_back(unknown.name);
}

// Each state has an equation for its present sample, however many past ones are remembered.
void add_pasts(Model const& model, ModelPage& page) {
  for (LaggedQuantity const& lagged : model.lagged_quantities) {
    if (lagged.channel >= 0 || is_disturbance(model, lagged.name)) continue;
    std::size_t const lags = lagged.registers.size();
    page.states.push_back({lagged.name, lagged.unit_text(), lags == 0 ? std::string() : counted(lags, "past sample")});
    page.unknowns.push_back(lagged.name);
  }
}

}  // namespace

ModelPage describe_structure(ast::File const& written, ast::File const& flat, Model const& model) {
  ModelPage page;
  page.name = model.name;
  page.title = model.title;
  Texts texts = texts_of(written, flat, model.name);
  page.equations = std::move(texts.equations);
  if (model.dynamics == Dynamics::discrete)
    add_pasts(model, page);
  else
    add_orders(model, texts, page);
  for (Unchecked const& each : model.unchecked) page.unchecked.push_back(fmt::format("`{}`: {}", each.what, each.why));
  for (Quantity const& input : model.inputs) page.inputs.push_back({input.name, input.unit_text(), {}});
  for (Disturbance const& disturbance : model.disturbances)
    page.disturbances.push_back({disturbance.name, disturbance.unit_text(), text_of(texts.disturbances, disturbance.name)});
  for (Channel const& channel : model.channels)
    page.channels.push_back({channel.name, channel.unit_of_numbers(), text_of(texts.channels, channel.name)});
  for (Parameter const& parameter : model.parameters)
    if (!parameter.coefficient)
      page.parameters.push_back({parameter.name, parameter.unit_text(), text_of(texts.parameters, parameter.name)});
  for (Expansion const& expansion : model.expansions) {
    std::vector<std::string> inputs;
    for (Expansion::Input const& input : expansion.inputs) inputs.push_back(input.name);
    page.parameters.push_back(
        {expansion.name, expansion.unit_text(),
         fmt::format("an unknown function of {}: {} coefficients", fmt::join(inputs, ", "), expansion.coefficients.size())});
  }
  auto const is_state = [&](Derived const& derived) {  // its present sample, in discrete time
    return std::any_of(model.lagged_quantities.begin(), model.lagged_quantities.end(),
                       [&](LaggedQuantity const& lagged) { return lagged.name == derived.name; });
  };
  for (Derived const& derived : model.derived)
    if (!is_state(derived)) page.derived.push_back({derived.name, unit_of_derived(derived), text_of(texts.derived, derived.name)});
  return page;
}

}  // namespace sysid
