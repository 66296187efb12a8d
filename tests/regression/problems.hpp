// Dictionaries and made records that the tests of discovery share.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "data/table/table.hpp"
#include "expression/term.hpp"
#include "regression/discovery.hpp"

namespace sysid::regression {

inline sysid::Term leaf(Dictionary& dictionary, Symbol::Kind kind, int index, int order) {
  NodeId const id = dictionary.graph.leaf(LeafKind::unknown, static_cast<int>(dictionary.symbols.size()));
  dictionary.symbols.push_back({id, kind, index, order});
  return {dictionary.graph, id};
}

/// The eleven terms of a Duffing oscillator's dictionary, against the force; y alone is measured.
inline Dictionary duffing_dictionary() {
  Dictionary d;
  d.states = {"y"};
  d.channels = {{.name = "displacement", .state = 0}};
  auto const y = leaf(d, Symbol::Kind::state, 0, 0), v = leaf(d, Symbol::Kind::state, 0, 1), a = leaf(d, Symbol::Kind::state, 0, 2),
             x = leaf(d, Symbol::Kind::input, 0, 0);
  auto const constant = [&](double value) { return sysid::Term(d.graph, value); };
  d.equations.push_back({.name = "y",
                         .known = x.id,
                         .terms = {{"y''", a.id},
                                   {"y'", v.id},
                                   {"y", y.id},
                                   {"y^2", pow(y, constant(2)).id},
                                   {"y^3", pow(y, constant(3)).id},
                                   {"abs(y)*y'", (abs(y) * v).id},
                                   {"sign(y')", sign(v).id},
                                   {"y'^2", pow(v, constant(2)).id},
                                   {"abs(y')*y'", (abs(v) * v).id},
                                   {"y'^3", pow(v, constant(3)).id},
                                   {"1", constant(1).id}}});
  return d;
}

/// m 1, c 20, k 1e4, k3 5e9 under a held Gaussian force of sd 10, dt 0.001, ten Runge-Kutta steps a sample, from rest; noise as a
/// share of the clean sd.
inline Experiment duffing_record(std::uint64_t seed, int rows, double noise) {
  constexpr double m = 1, c = 20, k = 1e4, k3 = 5e9, step = 1e-4;
  Stream force({seed, Purpose::input, 0, 0}), error({seed, Purpose::noise, 0, 0});
  std::vector<double> time, x, clean;
  double y = 0, v = 0;
  for (int i = 0; i < rows; ++i) {
    time.push_back(1e-3 * i);
    x.push_back(10 * force.normal());
    clean.push_back(y);
    auto const rate = [&](double at, double speed) { return (x.back() - c * speed - k * at - k3 * at * at * at) / m; };
    for (int s = 0; s < 10; ++s) {
      double const y1 = v, v1 = rate(y, v);
      double const y2 = v + step / 2 * v1, v2 = rate(y + step / 2 * y1, y2);
      double const y3 = v + step / 2 * v2, v3 = rate(y + step / 2 * y2, y3);
      double const y4 = v + step * v3, v4 = rate(y + step * y3, y4);
      y += step / 6 * (y1 + 2 * y2 + 2 * y3 + y4);
      v += step / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
  }
  double mean = 0, squares = 0;
  for (double const value : clean) mean += value / rows;
  for (double const value : clean) squares += (value - mean) * (value - mean) / rows;
  std::vector<double> measured;
  for (double const value : clean) measured.push_back(value + noise * std::sqrt(squares) * error.normal());
  Experiment experiment;
  experiment.name = "made";
  experiment.time = time;
  experiment.inputs = {InputSignal(InputRule::zero_order, time, x)};
  experiment.measured = {measured};
  experiment.scored.assign(static_cast<std::size_t>(rows), 1);
  return experiment;
}

/// Columns of a CSV file, the first of them the time, as channels without inputs.
inline Experiment recorded(std::string const& path) {
  Table const table = Table::read(path);
  Experiment experiment;
  experiment.name = path;
  experiment.time = table.numbers(table.columns().front());
  for (std::size_t c = 1; c < table.columns().size(); ++c) experiment.measured.push_back(table.numbers(table.columns()[c]));
  experiment.scored.assign(experiment.time.size(), 1);
  return experiment;
}

/// d/dt of every state against all monomials of the states up to a degree, constants included; every state is a channel.
inline Dictionary polynomial_dictionary(std::vector<std::string> const& states, int degree) {
  Dictionary d;
  d.states = states;
  std::vector<sysid::Term> value, rate;
  for (int s = 0; s < static_cast<int>(states.size()); ++s) {
    d.channels.push_back({.name = states[static_cast<std::size_t>(s)], .state = s});
    value.push_back(leaf(d, Symbol::Kind::state, s, 0));
    rate.push_back(leaf(d, Symbol::Kind::state, s, 1));
  }
  std::vector<Term> terms = {{"1", d.graph.constant(1)}};
  std::vector<std::pair<int, std::size_t>> last = {{0, 0}};  // of the degree before: first state allowed, index of the term
  for (int k = 1; k <= degree; ++k) {
    std::vector<std::pair<int, std::size_t>> now;
    for (auto const& [from, index] : last)
      for (int s = from; s < static_cast<int>(states.size()); ++s) {
        auto const i = static_cast<std::size_t>(s);
        std::string const name = index == 0 ? states[i] : terms[index].name + "*" + states[i];
        terms.push_back({name, d.graph.multiply(terms[index].expression, value[i].id)});
        now.emplace_back(s, terms.size() - 1);
      }
    last = now;
  }
  for (std::size_t s = 0; s < states.size(); ++s) d.equations.push_back({.name = states[s], .known = rate[s].id, .terms = terms});
  return d;
}

/// Weak form and spike and slab unless named otherwise, all settings at their defaults.
inline Method method(std::string_view selector = "spike_slab", std::string_view form = "weak") {
  Method result;
  result.form = find_form(form);
  result.form_settings = Settings(result.form->settings);
  result.selector = find_selector(selector);
  result.selector_settings = Settings(result.selector->settings);
  return result;
}

/// Names of the kept terms, as they stand in the dictionary.
inline std::vector<std::string> kept(FoundEquation const& equation) {
  std::vector<std::string> names;
  for (FoundTerm const& term : equation.terms)
    if (term.kept) names.push_back(term.name);
  return names;
}

}  // namespace sysid::regression
