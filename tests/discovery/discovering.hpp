// Discoveries of made records through the whole program, and what they say.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/running.hpp"
#include "app/session/preconditions.hpp"
#include "core/numeric/random.hpp"

namespace sysid::test {

constexpr double step = 0.01;  // [s] of the made records

/// Statements of a dictionary for it.
inline std::string const oscillator = "target = u - 1 [kg]*y''\nterms = y', y, y^2, y^3, 1";

/// y'' of an oscillator under a force.
using Acceleration = std::function<double(double force, double position, double speed)>;

inline double hardening(double force, double position, double speed) {
  return force - 0.8 * speed - 25 * position - 60 * position * position * position;
}

struct MadeSettings {
  double offset = 0;     // of the position as it is measured
  double noise = 0.005;  // of 0.35 m and of 1.75 m/s
  double force = 8;      // its sd
  double growth = 0;     // of that, over the record
  std::uint64_t seed = 4;
  Acceleration acceleration = &hardening;
};

/// An oscillator, y'' = u - 0.8 y' - 25 y - 60 y^3 if no other is given, under a random force held for five samples, with noise;
/// Runge and Kutta's steps of 1 ms.
struct Made {
  std::vector<double> t, u, y, v;

  explicit Made(int rows, MadeSettings const& settings = {}) {
    Stream force({settings.seed, Purpose::input, 0, 0}), error({settings.seed, Purpose::noise, 0, 0}),
        error_of_speed({settings.seed, Purpose::noise, 1, 0});
    double position = 0, speed = 0, held = 0;
    for (int i = 0; i < rows; ++i) {
      if (i % 5 == 0) held = settings.force * (1 + settings.growth * i / rows) * force.normal();
      t.push_back(step * i);
      u.push_back(held);
      y.push_back(settings.offset + position + settings.noise * 0.35 * error.normal());
      v.push_back(speed + settings.noise * 1.75 * error_of_speed.normal());
      auto const rate = [&](double at, double moving) { return settings.acceleration(held, at, moving); };
      double const h = step / 10;
      for (int k = 0; k < 10; ++k) {
        double const p1 = speed, v1 = rate(position, speed);
        double const p2 = speed + h / 2 * v1, v2 = rate(position + h / 2 * p1, p2);
        double const p3 = speed + h / 2 * v2, v3 = rate(position + h / 2 * p2, p3);
        double const p4 = speed + h * v3, v4 = rate(position + h * p3, p4);
        position += h / 6 * (p1 + 2 * p2 + 2 * p3 + p4);
        speed += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
      }
    }
  }
  /// A sample of y that is NaN is missing.
  std::string csv() const {
    std::string text = "t,u,y,v\n";
    auto const shown = [](double value) { return std::isnan(value) ? std::string("NA") : fmt::format("{:.12g}", value); };
    for (std::size_t i = 0; i < t.size(); ++i) text += fmt::format("{:.12g},{:.12g},{},{}\n", t[i], u[i], shown(y[i]), shown(v[i]));
    return text;
  }
};

inline std::string file(std::string const& statements, std::string const& options = "seed = 1",
                        std::string const& input = "input u = u [N] hold zero_order; ") {
  return "dictionary terms {\ninput u [N]\nstate y [m] = displacement\n" + statements +
         "\n}\ndata bench { file \"bench.csv\"; time t [s]; " + input +
         "measure displacement = y [m] }\nfound = discover terms from bench with " + options + "\n";
}

struct DiscoveryAnswer {
  int exit = 0;
  std::string said;  // standard output, or the message that ended it
  nlohmann::json summary;
  std::string source;  // of what was found; empty: there is none

  nlohmann::json finding(std::string const& code) const {
    if (summary.contains("findings"))
      for (nlohmann::json const& each : summary.at("findings"))
        if (each.at("code") == code) return each;
    return {};
  }
  std::vector<std::string> kept() const {
    std::vector<std::string> all;
    for (nlohmann::json const& term : summary.at("discovery").at("equations").at(0).at("terms"))
      if (term.at("kept").get<bool>()) all.push_back(term.at("term"));
    return all;
  }
  std::vector<std::string> codes() const {
    std::vector<std::string> all;
    for (nlohmann::json const& each : summary.at("findings")) all.push_back(each.at("code"));
    return all;
  }
};
using Texts = std::vector<std::string>;

/// As the command line would: messages of the text and of the data end it with 65.
inline DiscoveryAnswer run_with(std::string const& text, std::map<std::string, std::string> const& files) {
  TemporaryFolder folder;
  for (auto const& [name, content] : files) write_file(folder.path() / name, content);
  RunOptions options;
  options.output = folder.path() / "results";
  options.figures = false;
  Source source((folder.path() / "case.sysid").string(), text);
  Diagnostics diagnostics;
  auto const checked = load(source, diagnostics);
  DiscoveryAnswer answer;
  answer.said = render(diagnostics, source);
  answer.exit = 65;
  if (!checked) return answer;
  SilentProgress silent;
  std::ostringstream out, notices;
  try {
    answer.exit = static_cast<int>(run_tasks(source, *checked, {}, options, silent, out, notices));
  } catch (UnusableData const& error) {
    answer.said += render(error.diagnostics(), source);
    return answer;
  }
  answer.said += out.str();
  if (std::filesystem::exists(options.output / "found/found.sysid"))
    answer.source = read_file(options.output / "found/found.sysid");
  answer.summary = nlohmann::json::parse(read_file(options.output / "found/summary.json"));
  return answer;
}

inline bool contains(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace sysid::test
