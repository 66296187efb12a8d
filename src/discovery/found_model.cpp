// Text by statement, expressions from the trees of the dictionary.
#include "discovery/found_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "check/elaborate/tree.hpp"
#include "check/expression/scope.hpp"
#include "discovery/coefficient_names.hpp"
#include "discovery/found_source.hpp"
#include "experiment/motion.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

/// Sds of the regression that a prior is wide: the record speaks again in the fit, with a hundredth of its weight in the prior.
constexpr double prior_width = 10;
/// And never narrower than this part of the coefficient: what the form of derivatives may be wrong by.
constexpr double least_width = 0.1;
/// Of coefficients of a moving average, which is of use only where it is invertible.
constexpr double widest_average = 0.1;
/// Either way from the noise that the regression took; upwards as many times what the equation leaves at least, where that is more.
constexpr double noise_factor = 10, residual_factor = 3;
constexpr double without_noise = 1e-5;  // of the signal
constexpr double exact = 1e-13;         // of the signal: what a difference equation without noise is off by, with all digits

// "4.979e9".
std::string plain(std::string text) {
  if (auto const at = text.find("e+"); at != std::string::npos) text.erase(at + 1, text.find_first_not_of('0', at + 2) - at - 1);
  return text;
}
std::string number(double value) { return plain(fmt::format("{:.6g}", value)); }
std::string rounded(double value) { return plain(fmt::format("{:.2g}", value)); }

/// coefficient*term, as first factor of a product.
ast::Expression times(ast::Expression coefficient, ast::Expression const& term) {
  if (tree::is_number(term, 1)) return coefficient;
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&term.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/"))
    return tree::binary("*", std::move(coefficient), term, {});
  return tree::binary((*binary)->symbol, times(std::move(coefficient), *(*binary)->left), *(*binary)->right, {});
}

std::string in_brackets(std::string const& unit) { return unit.empty() ? "" : fmt::format(" [{}]", unit); }
double from_si(std::optional<Unit> const& unit, double value) { return unit ? value / unit->scale : value; }

std::string identifier(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ',' || c == '.' || c == ' '; }, '_');
  while (text.ends_with('_')) text.pop_back();
  return text;
}

std::string fresh(std::string name, std::set<std::string>& taken) {
  while (!taken.insert(name).second) name += "_";
  return name;
}

/// One model of the file.
class ModelText {
 public:
  ModelText(FoundSource const& source, FoundStructure const& structure) : source_(source), structure_(structure) {
    taken_ = declared_names(source.dictionary);
    for (std::size_t e = 0; e < structure.equations.size(); ++e) {
      names_.push_back(coefficient_names(source.dictionary, static_cast<int>(e)));
      taken_.insert(names_.back().begin(), names_.back().end());
    }
    look();
  }

  std::string text(std::string const& name, std::string const& title) {
    std::string out = fmt::format("model {} \"{}\" {{\n", name, title);
    if (discrete()) return out + declarations() + "\n" + definitions() + coefficients() + "\n" + predictions() + "}\n";
    out += declarations() + initial_values() + "\n" + definitions() + coefficients() + "\n" + equations() + "\n" + observations();
    return out + "}\n";
  }

  /// Leaves of the dictionary that the model reads.
  std::set<std::size_t> const& inputs() const { return inputs_; }

 private:
  CheckedDictionary const& dictionary() const { return source_.dictionary; }
  bool discrete() const { return dictionary().numbers.discrete; }

  std::vector<NodeId> roots() const {
    std::vector<NodeId> all;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      regression::Equation const& equation = dictionary().numbers.equations[e];
      all.push_back(equation.known);
      for (int const term : structure_.equations[e]->terms)
        all.push_back(equation.terms[static_cast<std::size_t>(term)].expression);
    }
    return all;
  }

  void look() {
    Graph const& graph = dictionary().numbers.graph;
    std::vector<NodeId> const reached = graph.reachable(roots());
    std::set<NodeId> const read(reached.begin(), reached.end());
    orders_.assign(dictionary().states.size(), 0);
    for (regression::Symbol const& symbol : dictionary().numbers.symbols) {
      if (!read.contains(symbol.leaf)) continue;
      auto const index = static_cast<std::size_t>(symbol.index);
      if (symbol.kind == regression::Symbol::Kind::state) orders_[index] = std::max(orders_[index], symbol.order);
      if (symbol.kind == regression::Symbol::Kind::input) inputs_.insert(index);
      if (symbol.kind == regression::Symbol::Kind::time) reads_time_ = true;
    }
    std::vector<ast::Expression const*> trees;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      DictionaryEquation const& equation = dictionary().equations[e];
      trees.push_back(&equation.tree);
      for (int const term : structure_.equations[e]->terms) trees.push_back(&equation.terms[static_cast<std::size_t>(term)].tree);
    }
    for (ast::Expression const* tree : trees) use(*tree);
  }

  // Names and functions that an expression reads, through definitions.
  void use(ast::Expression const& tree) {
    each_expression(tree, [&](ast::Expression const& part) {
      if (auto const* reference = std::get_if<ast::Reference>(&part.node)) use_name(reference->name.text);
      if (auto const* call = std::get_if<ast::Box<ast::Call>>(&part.node)) use_function((*call)->function.text);
    });
  }
  void use_name(std::string const& name) {
    if (!used_.insert(name).second) return;
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements) {
      if (auto const* definition = std::get_if<ast::Definition>(&statement);
          definition != nullptr && definition->name.name.text == name)
        use(definition->value);
      auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement);
      if (parameter == nullptr || parameter->name.name.text != name) continue;
      if (parameter->value) use(*parameter->value);
      if (parameter->prior)
        for (ast::Argument const& argument : parameter->prior->arguments) use(argument.value);
    }
  }
  void use_function(std::string const& name) {
    if (!functions_.insert(name).second) return;
    for (ast::FunctionDefinition const* function : all_functions())
      if (function->name.text == name) use(function->value);
  }
  std::vector<ast::FunctionDefinition const*> all_functions() const {
    std::vector<ast::FunctionDefinition const*> all;
    for (ast::FunctionDefinition const& function : dictionary().functions) all.push_back(&function);
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements)
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) all.push_back(function);
    return all;
  }

  std::string declarations() const {
    std::string out;
    if (discrete())
      out +=
          fmt::format("time discrete{}\n", dictionary().measured.step ? fmt::format(" {} [s]", *dictionary().measured.step) : "");
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements)
      if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement); time != nullptr && reads_time_)
        out += fmt::format("time {}{}\n", time->time.name.text,
                           time->time.unit ? fmt::format(" [{}]", unparse(*time->time.unit)) : "");
    for (std::size_t const i : inputs_) {
      Quantity const& input = dictionary().measured.inputs[i];
      out += fmt::format("input {}{}\n", input.name, in_brackets(input.unit_text()));
    }
    if (discrete()) return out;
    for (Quantity const& state : dictionary().states)
      out += fmt::format("state {}{}\n", state.name, in_brackets(state.unit_text()));
    return out;
  }

  // From the first rows; wide enough that the record decides.
  std::string initial_values() {
    std::string parameters, initial;
    for (std::size_t s = 0; s < orders_.size(); ++s) {
      Quantity const& state = dictionary().states[s];
      for (int k = 0; k < orders_[s]; ++k) {
        std::string const name = fresh(fmt::format("{}{}_0", std::string(static_cast<std::size_t>(k), 'd'), state.name), taken_);
        auto const [mean, sd] = start_of(s, k);
        auto const unit = rate_unit(state.unit, k);
        parameters +=
            fmt::format("parameter {}{}{} ~ normal({}, sd = {})\n", name, source_.data.size() > 1 ? " per experiment" : "",
                        in_brackets(unit ? unit->text : ""), number(from_si(state.unit, mean)), rounded(from_si(state.unit, sd)));
        initial += fmt::format("{}{} = {}", initial.empty() ? "initial " : ", ", primed_name(state.name, k), name);
      }
    }
    return parameters + initial + "\n";
  }

  std::pair<double, double> start_of(std::size_t state, int order) const {
    std::vector<regression::Channel> const& channels = dictionary().numbers.channels;
    // The channel of the nearest order at or below; else the size is that of the highest above, over the record.
    for (int own = order; own >= 0; --own)
      for (std::size_t c = 0; c < channels.size(); ++c)
        if (channels[c].state == static_cast<int>(state) && channels[c].order == own) {
          Motion const motion = motion_of(source_.data, c, order - own);
          return {own == order ? motion.first : 0, motion.size[static_cast<std::size_t>(order - own)]};
        }
    double length = 0;
    for (ExperimentData const& each : source_.data)
      length = std::max(length, each.experiment.time.back() - each.experiment.time.front());
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (channels[c].state == static_cast<int>(state))
        return {0, motion_of(source_.data, c, 0).size[0] * std::pow(length, channels[c].order - order)};
    return {0, 1};
  }

  std::string definitions() const {
    std::string out;
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements) {
      auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement);
      if (parameter != nullptr && parameter->value && used_.contains(parameter->name.name.text))
        out += fmt::format("parameter {}{} = {}\n", parameter->name.name.text,
                           parameter->name.unit ? fmt::format(" [{}]", unparse(*parameter->name.unit)) : "",
                           unparse(*parameter->value));
      if (parameter != nullptr && parameter->prior && used_.contains(parameter->name.name.text))
        out += fmt::format("parameter {}{} ~ {}  # inside terms\n", parameter->name.name.text,
                           parameter->name.unit ? fmt::format(" [{}]", unparse(*parameter->name.unit)) : "",
                           unparse(ast::Expression{{}, *parameter->prior}));
      if (auto const* definition = std::get_if<ast::Definition>(&statement);
          definition != nullptr && used_.contains(definition->name.name.text))
        out += fmt::format("{} {}{} = {}\n", definition->kind == ast::DefinitionKind::constant ? "constant" : "let",
                           definition->name.name.text,
                           definition->name.unit ? fmt::format(" [{}]", unparse(*definition->name.unit)) : "",
                           unparse(discrete() ? of_measured(definition->value) : definition->value));
    }
    for (ast::FunctionDefinition const* function : all_functions())
      if (functions_.contains(function->name.text)) out += unparse(ast::File{{*function}});
    return out;
  }

  std::string coefficients() const {
    std::string out;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      regression::Support const& support = *structure_.equations[e];
      for (std::size_t k = 0; k < support.terms.size(); ++k) {
        auto const j = static_cast<std::size_t>(support.terms[k]);
        auto const i = static_cast<Eigen::Index>(k);
        DictionaryTerm const& term = dictionary().equations[e].terms[j];
        double const value = support.coefficient(i), sd = std::sqrt(support.covariance(i, i));
        double const width = std::max(prior_width * sd, least_width * std::fabs(value));
        out += fmt::format("parameter {}{} ~ normal({}, sd = {})  # {}\n", names_[e][j],
                           in_brackets(term.unit ? term.unit->text : ""), number(from_si(term.unit, value)),
                           rounded(from_si(term.unit, width)), term.in_target ? "in the target" : term.text);
      }
    }
    return out;
  }

  /// The terms of an equation times their coefficients; nothing where it has none.
  std::optional<ast::Expression> right_side(std::size_t e) const {
    DictionaryEquation const& equation = dictionary().equations[e];
    std::optional<ast::Expression> sum;
    for (int const index : structure_.equations[e]->terms) {
      auto const j = static_cast<std::size_t>(index);
      if (equation.terms[j].in_target) continue;
      ast::Expression term = times(tree::reference(names_[e][j], 0, {}), equation.terms[j].tree);
      sum = sum ? tree::binary("+", std::move(*sum), std::move(term), {}) : std::move(term);
    }
    return sum;
  }

  std::string equations() const {
    std::string out;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      DictionaryEquation const& equation = dictionary().equations[e];
      auto const sum = right_side(e);
      std::string const left = unparse(equation.tree), right = unparse(sum ? *sum : tree::number(0, {}));
      bool const turned = left.starts_with('-');  // no statement begins so
      out += fmt::format("{} = {}\n", turned ? right : left, turned ? left : right);
    }
    return out;
  }

  /// In discrete time the samples that were measured, where the dictionary has a state.
  ast::Expression of_measured(ast::Expression tree) const {
    std::vector<ast::Expression*> states;
    each_expression(tree, [&](ast::Expression& part) {
      if (auto const* reference = std::get_if<ast::Reference>(&part.node); reference != nullptr && channel_of(reference->name.text))
        states.push_back(&part);
    });
    for (ast::Expression* state : states) {
      std::size_t const channel = *channel_of(std::get<ast::Reference>(state->node).name.text);
      *state = tree::call({{}, "measured"}, {tree::reference(dictionary().measured.channels[channel].name, 0, {})}, {});
    }
    return tree;
  }
  /// The channel that measures a state; nothing for other names.
  std::optional<std::size_t> channel_of(std::string const& state) const {
    std::vector<regression::Channel> const& channels = dictionary().numbers.channels;
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (dictionary().states[static_cast<std::size_t>(channels[c].state)].name == state) return c;
    return std::nullopt;
  }

  /// Each sample from those before it, with the errors of the samples before where the noise is a moving average of them.
  std::string predictions() {
    std::string parameters, observed;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      std::size_t const c = *channel_of(dictionary().equations[e].text);
      std::string const& channel = dictionary().measured.channels[c].name;
      Quantity const& state = dictionary().states[static_cast<std::size_t>(dictionary().numbers.channels[c].state)];
      auto const sum = right_side(e);
      std::string mean = unparse(of_measured(sum ? *sum : tree::number(0, {})));
      std::vector<double> const& average = source_.discovery.equations[e].moving_average;
      for (std::size_t k = 0; k < average.size(); ++k) {
        std::string const name = fresh(fmt::format("c{}_{}", k + 1, identifier(channel)), taken_);
        double const width = std::min(widest_average, prior_width * source_.discovery.equations[e].moving_average_sd[k]);
        parameters +=
            fmt::format("parameter {} ~ normal({}, sd = {})  # of the noise\n", name, rounded(average[k]), rounded(width));
        mean += fmt::format(" + {}*lag(residual({}), {})", name, channel, k + 1);
      }
      std::string const name = fresh("noise_" + identifier(channel), taken_);
      double const sd = structure_.equations[e]->noise_sd, size = motion_of(source_.data, c, 0).size[0];
      double const low = sd > exact * size ? sd / noise_factor : exact * size, high = sd > exact * size ? noise_factor * sd : size;
      parameters += fmt::format("parameter {}{} ~ log_uniform({}, {})\n", name, in_brackets(state.unit_text()),
                                rounded(from_si(state.unit, low)), rounded(from_si(state.unit, high)));
      observed += fmt::format("observe {}{} ~ normal({}, sd = {})\n", channel, in_brackets(state.unit_text()), mean, name);
    }
    return parameters + observed;
  }

  double residual_over_noise() const {
    double most = 0;
    for (regression::FoundEquation const& each : source_.discovery.equations) most = std::max(most, each.noise_ratio);
    return most;
  }

  std::string observations() {
    std::string parameters, observed;
    for (std::size_t c = 0; c < dictionary().measured.channels.size(); ++c) {
      Channel const& channel = dictionary().measured.channels[c];
      regression::Channel const& measured = dictionary().numbers.channels[c];
      auto const s = static_cast<std::size_t>(measured.state);
      if (measured.order > orders_[s]) continue;  // of nothing in the model
      std::string const name = fresh("noise_" + identifier(channel.name), taken_);
      double sd = source_.discovery.noise_sd.size() > c ? source_.discovery.noise_sd[c] : 0;
      if (source_.noise_sd.size() > c && source_.noise_sd[c] > 0) sd = source_.noise_sd[c];
      double const size = motion_of(source_.data, c, 0).size[0];
      // Without noise the regression's is that of the digits and of the derivatives, and may be far too large.
      double low = sd / (sd < without_noise * size ? 100 * noise_factor : noise_factor),
             high = sd * std::max(noise_factor, residual_factor * residual_over_noise());
      // Not down to `exact`: steps that follow a motion to its last digit take minutes.
      if (!(sd > 1e-9 * size)) high = size;
      low = std::max(low, 1e-9 * size);
      std::string const state = primed_name(dictionary().states[s].name, measured.order);
      if (double const growth = source_.growth.empty() ? 0 : source_.growth[c]; growth > 0) {
        double const mean_square = mean_square_of(c) + growth * growth;
        parameters += fmt::format(
            "parameter {} ~ log_uniform({}, {})  # relative to the larger of the signal and the constant beside it in `observe`\n",
            name, rounded(low / std::sqrt(mean_square)), rounded(high / std::sqrt(mean_square)));
        observed += fmt::format("observe {0} ~ normal({1}, sd = {2}*sqrt({1}^2 + ({3}{4})^2))\n", channel.name, state, name,
                                rounded(from_si(channel.unit, growth)), in_brackets(channel.unit_text()));
        continue;
      }
      parameters += fmt::format("parameter {}{} ~ log_uniform({}, {})\n", name, in_brackets(channel.unit_text()),
                                rounded(from_si(channel.unit, low)), rounded(from_si(channel.unit, high)));
      observed += fmt::format("observe {} ~ normal({}, sd = {})\n", channel.name, state, name);
    }
    return parameters + observed;
  }

  double mean_square_of(std::size_t channel) const {
    double squares = 0, count = 0;
    for (ExperimentData const& each : source_.data)
      for (double const sample : each.experiment.measured[channel])
        if (std::isfinite(sample)) squares += sample * sample, ++count;
    return count > 0 ? squares / count : 0;
  }

  FoundSource const& source_;
  FoundStructure const& structure_;
  std::set<std::string> taken_;
  std::vector<std::vector<std::string>> names_;  // [equation][term]
  std::vector<int> orders_;                      // per state: its highest derivative
  std::set<std::size_t> inputs_;
  bool reads_time_ = false;
  std::set<std::string> used_, functions_;
};

}  // namespace

FoundModel found_model(FoundSource const& source, FoundStructure const& structure, std::string const& name,
                       std::string const& title) {
  ModelText model(source, structure);
  std::string text = model.text(name, title);
  return {std::move(text), model.inputs()};
}

}  // namespace sysid
