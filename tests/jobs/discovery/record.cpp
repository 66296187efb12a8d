// Records of the systems in the table `systems` beside this file, made without any code of sysid: Boost.odeint's
// Runge-Kutta-Fehlberg 7(8) with relative and absolute tolerances of 1e-12, restarted at each sample so that inputs are smooth
// within a step.
//
//   record TABLE NAME KIND LEVEL SEED DIGITS [SAMPLES [2]]
//
// to the standard output as CSV. KIND: `times`, each sample times 1 + LEVEL*normal; `plus`, each sample plus LEVEL times the
// standard deviation of its channel times normal. DIGITS: significant digits of all numbers, of time as well. Inputs are recorded
// without noise.
#include <boost/numeric/odeint.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "expression.hpp"

namespace {

using State = std::vector<double>;

struct System {
  int samples = 0;
  double span = 0;
  std::vector<std::string> states, inputs;
  std::vector<bool> held;  // inputs: until the next sample; else interpolated
  State start, again;
  std::vector<std::string> input_texts, equations;
};

std::string trimmed(std::string text) {
  auto const first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// STATE = VALUE, STATE = VALUE
State read_start(std::istringstream& words) {
  State start;
  std::string one;
  while (std::getline(words, one, ',')) start.push_back(std::atof(one.substr(one.find('=') + 1).c_str()));
  return start;
}

System read_system(char const* table, std::string const& wanted) {
  std::ifstream file(table);
  std::string line;
  bool inside = false;
  System out;
  while (std::getline(file, line)) {
    line = trimmed(line);
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string first;
    words >> first;
    if (first == "system") {
      std::string name;
      words >> name;
      inside = name == wanted;
    } else if (!inside) {
      continue;
    } else if (first == "input") {
      std::string name, rule, rest;
      words >> name >> rule;
      std::getline(words, rest);
      out.inputs.push_back(name);
      out.held.push_back(rule == "zero_order");
      out.input_texts.push_back(rest);
    } else if (first.back() == '\'') {
      out.states.push_back(first.substr(0, first.size() - 1));
      out.equations.push_back(line.substr(line.find('=') + 1));
    } else if (first == "again") {
      words >> first;
      out.again = read_start(words);
    } else {
      out.samples = std::atoi(first.c_str());
      words >> first >> first >> out.span >> first;
      out.start = read_start(words);
    }
  }
  if (out.states.empty() || out.start.size() != out.states.size()) throw std::runtime_error("no such system: " + wanted);
  return out;
}

class Record {
 public:
  explicit Record(System const& system) : system_(system) {
    for (std::size_t i = 0; i < system.states.size(); ++i) places_[system.states[i]] = i;
    for (std::size_t i = 0; i < system.inputs.size(); ++i) places_[system.inputs[i]] = system.states.size() + i;
    for (std::string const& text : system.equations) rates_.push_back(parse_expression(text, places_));
    for (std::string const& text : system.input_texts) signals_.push_back(parse_expression(text, {{"t", 0}}));
  }

  double time(int sample) const { return system_.span * sample / (system_.samples - 1); }
  double input(std::size_t which, int sample) const { return signals_[which]({time(sample)}); }

  std::vector<State> states() const {
    namespace odeint = boost::numeric::odeint;
    std::vector<State> all{system_.start};
    State state = system_.start;
    for (int n = 1; n < system_.samples; ++n) {
      double const begin = time(n - 1), end = time(n);
      auto const rate = [&](State const& x, State& slope, double t) {
        State values = x;
        for (std::size_t i = 0; i < signals_.size(); ++i) {
          double const before = input(i, n - 1), after = input(i, n);
          values.push_back(system_.held[i] ? before : before + (after - before) * (t - begin) / (end - begin));
        }
        for (std::size_t i = 0; i < rates_.size(); ++i) slope[i] = rates_[i](values);
      };
      odeint::integrate_adaptive(odeint::make_controlled(1e-12, 1e-12, odeint::runge_kutta_fehlberg78<State>()), rate, state, begin,
                                 end, (end - begin) / 10);
      for (double const x : state)
        if (!std::isfinite(x)) throw std::runtime_error("the solution is not finite");
      all.push_back(state);
    }
    return all;
  }

 private:
  System const& system_;
  std::map<std::string, std::size_t> places_;
  std::vector<Expression> rates_, signals_;
};

void add_noise(std::vector<State>& states, std::string const& kind, double level, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, 1);
  for (std::size_t i = 0; i < states.front().size(); ++i) {
    double mean = 0, squares = 0;
    for (State const& each : states) mean += each[i] / states.size();
    for (State const& each : states) squares += (each[i] - mean) * (each[i] - mean) / states.size();
    for (State& each : states) each[i] += level * normal(generator) * (kind == "times" ? each[i] : std::sqrt(squares));
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 7) return std::fprintf(stderr, "record TABLE NAME times|plus LEVEL SEED DIGITS [SAMPLES]\n"), 2;
  System system = read_system(arguments[1], arguments[2]);
  if (count > 7 && std::atoi(arguments[7]) > 0) system.samples = std::atoi(arguments[7]);
  if (count > 8) {
    if (system.again.size() != system.states.size()) throw std::runtime_error("it has no second record");
    system.start = system.again;
  }
  Record const record(system);
  std::vector<State> states = record.states();
  add_noise(states, arguments[3], std::atof(arguments[4]), std::strtoull(arguments[5], nullptr, 10));
  int const digits = std::atoi(arguments[6]);
  std::printf("time");
  for (std::string const& name : system.inputs) std::printf(",%s", name.c_str());
  for (std::string const& name : system.states) std::printf(",%s", name.c_str());
  std::printf("\n");
  for (int n = 0; n < system.samples; ++n) {
    std::printf("%.*g", digits, record.time(n));
    for (std::size_t i = 0; i < system.inputs.size(); ++i) std::printf(",%.*g", digits, record.input(i, n));
    for (double const x : states[n]) std::printf(",%.*g", digits, x);
    std::printf("\n");
  }
} catch (std::exception const& error) {
  return std::fprintf(stderr, "record: %s\n", error.what()), 1;
}
