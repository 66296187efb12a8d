// The fit's own trajectories, with the inertia of each equation as a derived quantity.
#include "app/disturbed/disturbance_size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/session/fit_target.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/stored_draws.hpp"
#include "core/text/without_index.hpp"
#include "likelihood/trajectory.hpp"
#include "load/load.hpp"

namespace sysid {
namespace {

/// "k_probe" among "k_probe", "spring.k_probe", "k_probe[2]".
bool is_probe(std::string const& quantity, std::string const& probe) {
  std::string const plain = without_index(quantity);
  return plain == probe || plain.ends_with("." + probe);
}

/// As a quantity of the model with this dimension is written, an input above all.
Unit written_unit(Model const& model, Unit const& unit) {
  auto const first = [&](auto const& quantities) -> std::optional<Unit> {
    for (Quantity const& each : quantities)
      if (each.unit && each.unit->dimension == unit.dimension && each.unit->offset == 0 && !each.unit->text.empty() &&
          each.unit->hertz == unit.hertz && each.unit->radian == unit.radian)
        return each.unit;
    return std::nullopt;
  };
  for (auto const& found : {first(model.inputs), first(model.states), first(model.parameters), first(model.channels)})
    if (found) return *found;
  // "V/s" of a state in volts, before base units.
  Unit const second = unit_atom("s").value();
  for (State const& state : model.states)
    for (int const order : {1, 2}) {
      if (!state.unit || state.unit->text.empty() || state.unit->text.find_first_of(" /^(*") != std::string::npos) continue;
      Unit rate = divide(*state.unit, power(second, {order, 1}));
      if (rate.dimension != unit.dimension || state.unit->offset != 0) continue;
      rate.text = state.unit->text + (order == 1 ? "/s" : "/s^2");
      return rate;
    }
  Unit plain = unit;
  plain.scale = 1;
  plain.text = format_dimension(unit.dimension);
  return plain;
}

class ProbedFit {
 public:
  ProbedFit(Session& like, Task const& fit, std::vector<DisturbedEquation> const& equations)
      : source_(like.source.name(), text_with_probes(like.source, equations)),
        file_(load_probed(fit)),
        silent_(nullptr),
        session_(source_, file_, like.options, like.progress, silent_, silent_),
        task_(*std::find_if(file_.tasks.begin(), file_.tasks.end(), [&](Task const& each) { return each.name == fit.name; })),
        fit_(std::get<FitTask>(task_.what)) {}

  Model const& model() const { return file_.models[static_cast<std::size_t>(fit_.model)]; }

  /// rms of derived quantities along the records, SI, by their place in the model: the median over draws.
  std::vector<double> rms(std::filesystem::path const& results) {
    constexpr int most_draws = 9;
    auto const space = parameter_space(model(), fit_.experiments);
    std::vector<std::string> names;
    for (ParameterInfo const& each : space->infos()) names.push_back(each.name);
    FittedModel const fitted = read_fitted(results, names);
    LaneArray const values = space->values_of_declared(spread(fitted.draws, most_draws));
    auto const compiled = session_.compiled(fit_, fitted.solver.method);
    data_ = load_experiments(session_, fit_.experiments, model(), fit_.start, fit_.prediction, fitted.solver);
    std::vector<std::vector<double>> squares(model().derived.size(), std::vector<double>(static_cast<std::size_t>(values.width())));
    double samples = 0;
    for (std::size_t e = 0; e < data_.size(); ++e) {
      Trajectory const trajectory(compiled, data_[e].experiment, fitted.solver, start_rows(fit_.start), session_.abandonable());
      LaneArray parameters(static_cast<int>(model().parameters.size()), values.width());
      space->select(values, static_cast<int>(e), parameters);
      Trajectory::Result const result = trajectory.run(parameters, {1, Purpose::prediction});
      samples += trajectory.samples();
      for (std::size_t q = 0; q < trajectory.quantities().size(); ++q)
        for (std::size_t d = 0; d < model().derived.size(); ++d)
          if (model().derived[d].name == trajectory.quantities()[q].name)
            for (std::size_t w = 0; w < result.values[q].size(); ++w)
              for (double const value : result.values[q][w]) squares[d][w] += std::pow(model().derived[d].to_si(value), 2);
    }
    std::vector<double> rms;
    for (std::vector<double>& of_draws : squares) {
      std::erase_if(of_draws, [](double value) { return !std::isfinite(value); });
      std::sort(of_draws.begin(), of_draws.end());
      rms.push_back(of_draws.empty() ? std::nan("") : std::sqrt(of_draws[of_draws.size() / 2] / samples));
    }
    return rms;
  }

  /// [s] of the first record; after `rms`.
  double step() const {
    std::vector<double> const& time = data_.front().experiment.time;
    return time.size() > 1 ? mean_step(time) : 1;
  }

 private:
  CheckedFile load_probed(Task const& fit) {
    Diagnostics diagnostics;
    auto file = load(source_, diagnostics);
    if (file) return std::move(*file);
    std::string why;
    for (Diagnostic const& each : diagnostics.all())
      if (each.severity == Severity::error && why.empty()) why = each.message;
    throw UserError({Severity::error,
                     "",
                     fmt::format("no disturbance can be added to the model of `{}`: {}", fit.name, why),
                     Label{fit.span, {}},
                     {},
                     "declare it: `disturbance w ~ white(intensity = q)`, and add `w` to the equation of motion"});
  }

  Source source_;
  CheckedFile file_;
  std::ostream silent_;
  Session session_;
  Task const& task_;
  FitTask const& fit_;
  std::vector<ExperimentData> data_;
};

}  // namespace

std::vector<DisturbanceSize> disturbance_sizes(Session& like, Task const& fit, std::filesystem::path const& results,
                                               std::vector<DisturbedEquation> const& equations) {
  ProbedFit probed(like, fit, equations);
  std::vector<double> const rms = probed.rms(results);
  std::vector<DisturbanceSize> sizes;
  for (DisturbedEquation const& equation : equations) {
    DisturbanceSize size;
    size.step = probed.step();
    for (std::size_t d = 0; d < rms.size(); ++d) {
      Derived const& derived = probed.model().derived[d];
      if (!is_probe(derived.name, equation.probe())) continue;
      Unit const unit = derived.unit ? written_unit(probed.model(), *derived.unit) : Unit{};
      if (derived.unit) size.unit = unit.text;
      size.size = std::max(size.size, rms[d] / unit.scale);
    }
    if (!(size.size > 0) || !std::isfinite(size.size))
      throw UserError({Severity::error,
                       "",
                       fmt::format("the size of a disturbance cannot be estimated: in the fit `{}` the term of this equation with "
                                   "the highest derivative is zero or not finite",
                                   fit.name),
                       Label{equation.place, {}},
                       {},
                       "declare it yourself, with a prior of its intensity: `disturbance w ~ white(intensity = q)`"});
    sizes.push_back(std::move(size));
  }
  return sizes;
}

}  // namespace sysid
