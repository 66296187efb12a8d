// Disturbances: their units, their places among the states, their laws, and where they must not stand.
#include <fmt/format.h>

#include <algorithm>

#include "check/expression/distributions.hpp"
#include "check/expression/value_range.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "check/model/model_checker.hpp"
#include "expression/affine.hpp"
#include "model/disturbance_law.hpp"

namespace sysid {
namespace {

Unit unit_of_time() { return unit_atom("s").value(); }

/// u^2 s of an intensity, u of a standard deviation, s of a time; `u` absent: only what has none of it.
std::optional<Unit> unit_of_argument(DisturbanceArgumentRow const& row, std::optional<Unit> const& unit) {
  if (row.unit_power == 0) return row.second_power == 0 ? Unit{} : unit_of_time();
  if (!unit) return std::nullopt;
  Unit const base = row.unit_power == 1 ? *unit : power(*unit, {row.unit_power, 1});
  if (row.second_power == 0) return base;
  Unit result = multiply(base, power(unit_of_time(), {row.second_power, 1}));
  // "N^2 s" of "N"; of what is no plain name the dimension says it.
  bool const plain = !unit->text.empty() && unit->text.find_first_of(" */^()") == std::string::npos;
  if (plain && unit->text != "-") result.text = fmt::format("{}^{} s", unit->text, row.unit_power);
  return result;
}

ast::Expression const* argument_named(ast::Call const& call, std::string_view name) {
  for (ast::Argument const& argument : call.arguments)
    if (argument.name && argument.name->text == name) return &argument.value;
  return nullptr;
}

/// The unit of the variate from that of an argument which is a power of it.
Unit root_of(Unit const& unit, int unit_power, int second_power) {
  Unit const without = second_power == 0 ? unit : divide(unit, power(unit_of_time(), {second_power, 1}));
  return unit_power == 1 ? without : named_or_coherent(power(without, {1, unit_power}));
}

}  // namespace

void ModelChecker::infer_disturbance_units() {
  Diagnostics ignored;
  std::optional<Scope> quiet;
  for (std::size_t i = 0; i < disturbance_trees_.size(); ++i) {
    Disturbance& disturbance = model_.disturbances[i];
    if (disturbance.unit) continue;
    ast::Call const& law = disturbance_trees_[i]->law;
    struct Power {
      std::string_view name;
      int unit, second;
    };
    static constexpr Power powers[] = {{"intensity", 2, 1}, {"sd", 1, 0}, {"variance", 2, 0}, {"precision", -2, 0}};
    for (Power const& power : powers) {
      ast::Expression const* argument = argument_named(law, power.name);
      if (argument == nullptr) continue;
      if (!quiet) quiet.emplace(scope_.with(ignored));
      auto const value = quiet->expression(*argument);
      if (value && value->kind == Typed::Kind::known)
        disturbance.unit = root_of(with_own_unit(*value).unit, power.unit, power.second);
    }
    if (disturbance.unit) scope_.find(disturbance.name)->unit = disturbance.unit;
  }
}

void ModelChecker::lay_out_disturbances() {
  bool const discrete = scope_.samples().discrete;
  for (std::size_t i = 0; i < disturbance_trees_.size(); ++i) {
    DisturbanceLawRow const* law = find_disturbance_law(disturbance_trees_[i]->law.function.text);
    if (!discrete && (law == nullptr || !law->has_memory)) continue;
    Disturbance& disturbance = model_.disturbances[i];
    disturbance.state = static_cast<int>(model_.states.size());
    State state;
    static_cast<Quantity&>(state) = disturbance;
    state.initial = state.derivative = model_.graph.constant(0);
    state.initial_given = true;
    model_.states.push_back(std::move(state));
    std::get<DisturbanceSymbol>(scope_.find(disturbance.name)->what).state = disturbance.state;
  }
}

std::optional<std::vector<NodeId>> ModelChecker::law_arguments(ast::DisturbanceDeclaration const& tree,
                                                               Disturbance const& disturbance, DisturbanceLawRow const& row) {
  std::vector<std::string> known;
  for (DisturbanceArgumentRow const& argument : row.arguments) known.emplace_back(argument.name);
  std::vector<ast::Argument const*> given(row.arguments.size(), nullptr);
  std::size_t unnamed = 0;
  bool good = true;
  auto const fail = [&](Diagnostic diagnostic) {
    diagnostics_.add(std::move(diagnostic));
    good = false;
  };
  for (ast::Argument const& argument : tree.law.arguments) {
    if (!argument.name) {
      // Those that no name claims, in their order: this one is probably the next.
      std::vector<std::string> open = known;
      for (ast::Argument const& other : tree.law.arguments)
        if (other.name) std::erase(open, other.name->text);
      if (unnamed < open.size()) std::rotate(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(unnamed), open.end());
      ++unnamed;
      fail(errors::must_be_named(tree.law, argument, open.empty() ? known : open));
      continue;
    }
    auto const place = std::find(known.begin(), known.end(), argument.name->text);
    if (place == known.end()) {
      std::string const& word = argument.name->text;
      bool const width = word == "sd" || word == "std" || word == "sigma" || word == "variance";
      fail(width && !row.has_memory ? errors::sd_of_white_noise(argument.span, disturbance.name)
                                    : errors::unknown_argument(*argument.name, std::string(row.name), known));
      continue;
    }
    ast::Argument const*& slot = given[static_cast<std::size_t>(place - known.begin())];
    if (slot != nullptr)
      fail(errors::argument_twice(argument.span, slot->span, *place, *place));
    else
      slot = &argument;
  }
  std::vector<NodeId> values;
  for (std::size_t a = 0; a < given.size(); ++a) {
    if (given[a] == nullptr) {
      if (good) fail(errors::argument_missing(tree.law, {known[a]}));
      continue;
    }
    if (auto const value = law_argument(tree, disturbance, row.arguments[a], given[a]->value))
      values.push_back(*value);
    else
      good = false;
  }
  return good ? std::optional(values) : std::nullopt;
}

std::optional<NodeId> ModelChecker::law_argument(ast::DisturbanceDeclaration const& tree, Disturbance const& disturbance,
                                                 DisturbanceArgumentRow const& row, ast::Expression const& value_tree) {
  std::string const name(row.name);
  std::optional<Unit> const unit = unit_of_argument(row, disturbance.unit);
  Diagnostics ignored;
  auto const seen = scope_.with(ignored).expression(value_tree);
  if (seen)
    if (std::string const what = moving_part(model_.graph, seen->node); !what.empty()) {
      diagnostics_.add(errors::law_reads(tree.law.span, disturbance.name, what));
      return std::nullopt;
    }
  // The unit of the disturbance itself in place of that of its intensity: a message of its own.
  if (row.unit_power == 2 && unit && seen && seen->kind == Typed::Kind::known) {
    Unit const given = with_own_unit(*seen).unit;
    bool const variance = given.dimension == power(*disturbance.unit, {2, 1}).dimension;
    if (given.dimension != unit->dimension && (variance || given.dimension == disturbance.unit->dimension)) {
      diagnostics_.add(
          errors::unit_of_intensity(value_tree.span, disturbance.name, scope_.units().words(given), scope_.units().words(*unit)));
      return std::nullopt;
    }
  }
  std::string const declared = disturbance.unit ? "[" + scope_.units().words(*disturbance.unit) + "]" : "";
  auto const value = scope_.expression_in(unit, disturbance.span, value_tree,
                                          {Occasion::Kind::distribution, name, disturbance.name, declared, true});
  if (!value) return std::nullopt;
  return adapt(model_.graph, *value, unit);
}

std::optional<NodeId> ModelChecker::sd_of_samples(ast::DisturbanceDeclaration const& tree, Disturbance const& disturbance) {
  if (tree.law.function.text != "normal") {
    diagnostics_.add(errors::unknown_law(tree.law, tree.name.name, true, {"normal"}));
    return std::nullopt;
  }
  auto const use = check_distribution(scope_, tree.law, disturbance);
  if (!use) return std::nullopt;
  if (!model_.graph.is_constant(use->arguments[0], 0)) {
    diagnostics_.add(errors::mean_of_disturbance(tree.law.span, disturbance.name));
    return std::nullopt;
  }
  if (use->lower || use->upper) {
    diagnostics_.add(errors::bounds_of_disturbance(tree.law.span, disturbance.name));
    return std::nullopt;
  }
  if (std::string const what = moving_part(model_.graph, use->arguments[1]); !what.empty()) {
    diagnostics_.add(errors::law_reads(tree.law.span, disturbance.name, what));
    return std::nullopt;
  }
  return use->arguments[1];
}

void ModelChecker::disturbances() {
  Graph& graph = model_.graph;
  for (std::size_t i = 0; i < disturbance_trees_.size(); ++i) {
    ast::DisturbanceDeclaration const& tree = *disturbance_trees_[i];
    Disturbance& disturbance = model_.disturbances[i];
    NodeId const leaf = graph.leaf(LeafKind::disturbance, static_cast<int>(i));
    if (scope_.samples().discrete) {
      auto const sd = sd_of_samples(tree, disturbance);
      if (!sd) continue;
      State& state = model_.states[static_cast<std::size_t>(disturbance.state)];
      disturbance.intensity = graph.multiply(*sd, *sd);
      state.initial_variance = disturbance.intensity;
      state.derivative = leaf;
      positive_.push_back({*sd, "standard deviation", i});
      continue;
    }
    DisturbanceLawRow const* row = find_disturbance_law(tree.law.function.text);
    if (row == nullptr) {
      std::vector<std::string> known;
      for (DisturbanceLawRow const& each : disturbance_laws()) known.emplace_back(each.name);
      diagnostics_.add(errors::unknown_law(tree.law, tree.name.name, false, known));
      continue;
    }
    auto const values = law_arguments(tree, disturbance, *row);
    if (!values) continue;
    for (std::size_t a = 0; a < values->size(); ++a) positive_.push_back({(*values)[a], std::string(row->arguments[a].name), i});
    disturbance.intensity = values->front();
    if (!row->has_memory) continue;
    NodeId const variance = graph.multiply((*values)[0], (*values)[0]), time = (*values)[1];
    State& state = model_.states[static_cast<std::size_t>(disturbance.state)];
    disturbance.intensity = graph.divide(graph.multiply(graph.constant(2), variance), time);
    state.initial_variance = variance;
    state.derivative = graph.subtract(leaf, graph.divide(graph.leaf(LeafKind::state, disturbance.state), time));
  }
}

void ModelChecker::positive_laws(ValueRanges& ranges) {
  for (PositiveArgument const& each : positive_) {
    ValueRange const range = ranges.of(each.node);
    Disturbance const& disturbance = model_.disturbances[each.disturbance];
    if (!range.empty && range.high > 0) {
      report_negative_width(each.node, each.argument, disturbance.name);
      continue;
    }
    diagnostics_.add(errors::law_never_positive(disturbance.span, disturbance.name, each.argument, parameters_of(each.node)));
  }
}

bool ModelChecker::reads_white_noise(NodeId root, int& which) const {
  for (NodeId const id : model_.graph.reachable({&root, 1}))
    if (is_leaf(model_.graph[id], LeafKind::disturbance)) {
      which = model_.graph[id].index;
      return true;
    }
  return false;
}

void ModelChecker::place_disturbances() {
  if (!model_.filtered()) return;
  auto const first =
      std::find_if(model_.states.begin(), model_.states.end(), [](State const& each) { return bool(each.initial_variance); });
  bool const declared = !model_.disturbances.empty();
  Quantity const& random = declared ? static_cast<Quantity const&>(model_.disturbances.front()) : *first;
  errors::Subject const subject = errors::named(declared ? "disturbance" : "the random initial value of", random.name);
  if (!model_.processes.empty())
    diagnostics_.add(errors::disturbance_beside(random.span, subject, {"a Gaussian process"},
                                                "give the process a range, `gp(..., within = (-1, 1))`: it is then approximated by "
                                                "a finite sum"));
  if (!model_.unknowns.empty() || !model_.invariants.empty())
    diagnostics_.add(errors::disturbance_beside(
        random.span, subject, {"algebraic unknowns and constraints"},
        "eliminate the unknowns, so that each state has its differential equation, solved for its highest derivative"));
  if (!model_.memories.empty())
    diagnostics_.add(errors::disturbance_beside(random.span, subject, errors::named("since_last"),
                                                "observe the quantity itself, with a column of its values in the record"));
  int which = 0;
  for (Channel const& channel : model_.channels)
    for (NodeId const argument : channel.noise.arguments)
      if (reads_white_noise(argument, which)) {
        Disturbance const& white = model_.disturbances[static_cast<std::size_t>(which)];
        diagnostics_.add(
            errors::white_noise_observed(channel.span, errors::named("channel", channel.name), white.span, white.name));
        break;
      }
  for (Derived const& derived : model_.derived)
    if (reads_white_noise(derived.value, which)) {
      Disturbance const& white = model_.disturbances[static_cast<std::size_t>(which)];
      diagnostics_.add(errors::white_noise_observed(derived.span, errors::named(derived.name), white.span, white.name));
    }
  std::vector<NodeId> derivatives;
  for (State const& state : model_.states) derivatives.push_back(state.derivative);
  auto const is_white = [](Node const& node) { return is_leaf(node, LeafKind::disturbance); };
  if (auto const node = find_not_affine(model_.graph, derivatives, is_white); node && reads_white_noise(*node, which)) {
    Disturbance const& white = model_.disturbances[static_cast<std::size_t>(which)];
    diagnostics_.add(errors::not_linear_in_disturbance(white.span, white.name, place_of(model_.graph, *node)));
  }
}

}  // namespace sysid
