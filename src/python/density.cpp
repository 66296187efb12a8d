// The density of a fit on arrays. The interpreter lock is released while the engine computes.
#include "python/density.hpp"

#include <pybind11/stl.h>

#include <mutex>
#include <shared_mutex>

#include "core/numeric/random.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "embed/density_values.hpp"
#include "embed/open_file.hpp"
#include "python/arrays.hpp"
#include "python/interrupts.hpp"

namespace sysid::python {
namespace {

using embed::OpenDensity;
using embed::OpenFile;

/// Without the interpreter lock, with errors raised and Ctrl-C heard.
template <class Work>
auto computed(OpenDensity const& of, Work&& work) {
  py::gil_scoped_release const released;
  return interruptible(of.file()->source(), std::forward<Work>(work));
}

/// The same of work that fills a ledger, which counts where the work was not given up.
template <class Work>
auto counted(OpenDensity& of, Work&& work) {
  Ledger ledger;
  auto result = computed(of, [&] { return work(ledger); });
  of.add(ledger);
  return result;
}

embed::Part part_of(std::string const& name) {
  if (name == "prior") return embed::Part::prior;
  if (name == "likelihood") return embed::Part::likelihood;
  return embed::Part::both;
}

Array log_density_of(OpenDensity& of, Array const& values, bool declared, std::string const& part) {
  LaneArray const given = lanes_of(values, of.target().dimension());
  return array_of(counted(of, [&](Ledger& ledger) {
    return declared ? embed::declared_log_density(of.target(), given, part_of(part), ledger)
                    : embed::log_density(of.target(), given, part_of(part), ledger);
  }));
}

py::tuple value_and_gradient(OpenDensity& of, Array const& theta_array) {
  LaneArray const theta = lanes_of(theta_array, of.target().dimension());
  auto const found = counted(of, [&](Ledger& ledger) { return embed::log_density_with_gradient(of.target(), theta, ledger); });
  return py::make_tuple(array_of(found.value), array_of(found.gradient));
}

Array residuals(OpenDensity& of, Array const& theta_array) {
  LaneArray const theta = lanes_of(theta_array, of.target().dimension());
  return array_of(counted(of, [&](Ledger& ledger) {
    LaneArray out(of.target().residual_count(), theta.width());
    of.target().residuals(theta, out, ledger);
    return out;
  }));
}

py::tuple residuals_with_jacobian(OpenDensity& of, Array const& theta_array) {
  LaneArray const theta = lanes_of(theta_array, of.target().dimension());
  int const rows = of.target().residual_count();
  auto const found = counted(of, [&](Ledger& ledger) { return embed::residuals_with_jacobian(of.target(), theta, ledger); });
  return py::make_tuple(array_of(found.residuals), array_of(found.jacobian).reshape({theta.width(), rows, theta.rows()}));
}

Array constrain(OpenDensity& of, Array const& theta_array) {
  LaneArray lanes = lanes_of(theta_array, of.target().dimension());
  LaneArray declared(lanes.rows(), lanes.width());
  of.target().constrain(lanes, declared);
  return array_of(declared);
}

Array unconstrain(OpenDensity& of, Array const& declared_array) {
  LaneArray lanes = lanes_of(declared_array, of.target().dimension());
  LaneArray theta(lanes.rows(), lanes.width());
  of.target().unconstrain(lanes, theta);
  return array_of(theta);
}

Array sample_prior(OpenDensity& of, int count, std::uint64_t seed) {
  if (count < 1) throw py::value_error("expected a number of draws of at least 1");
  return array_of(computed(of, [&] {
    LaneArray theta(of.target().dimension(), count);
    of.target().sample_prior({seed, Purpose::prior, 0, 0}, theta);
    return theta;
  }));
}

py::dict simulate(OpenDensity& of, Array const& declared_array, int experiment, std::uint64_t seed) {
  LaneArray const declared = lanes_of(declared_array, of.target().dimension());
  FitDensity::Simulated const made = computed(of, [&] { return of.density().simulate(experiment, declared, seed); });
  std::size_t const samples = made.time.size();
  py::dict values, noisy, units;
  for (std::size_t q = 0; q < made.quantities.size(); ++q) {
    TrajectoryQuantity const& quantity = made.quantities[q];
    py::str const name(quantity.name);
    values[name] = array_of(made.result.drawn(q), samples);
    units[name] = quantity.unit;
    if (quantity.channel >= 0) noisy[name] = array_of(made.result.noisy[static_cast<std::size_t>(quantity.channel)], samples);
  }
  py::dict all;
  all["experiment"] = made.experiment;
  all["time"] = array_of(made.time);
  all["values"] = values;
  all["noisy"] = noisy;
  all["units"] = units;
  return all;
}

py::list parameters(OpenDensity const& of) {
  std::vector<PriorInfo> const priors = of.density().priors();
  py::list all;
  for (ParameterInfo const& each : of.target().parameters()) {
    std::string text;
    for (PriorInfo const& prior : priors)
      if (prior.name == each.name) text = prior.text;
    all.append(py::make_tuple(each.name, each.unit, text, each.lower, each.upper));
  }
  return all;
}

py::list modes(OpenDensity const& of) {
  py::list all;
  for (Mode const& mode : of.density().modes()) {
    py::dict one;
    one["theta"] = array_of(mode.theta);
    one["values"] = array_of(mode.declared);
    one["sd"] = array_of(mode.sd);
    auto const size = static_cast<py::ssize_t>(mode.theta.size());
    one["covariance"] = array_of(mode.covariance).reshape({size, size});
    one["log_density"] = mode.log_density;
    one["share"] = mode.share;
    all.append(one);
  }
  return all;
}

py::list failures(OpenDensity const& of) {
  Ledger const ledger = of.ledger();
  py::list all;
  for (Failure const& each : ledger.failures()) {
    py::dict one;
    one["kind"] = name(each.kind);
    one["where"] = each.where;
    one["count"] = each.count;
    one["time"] = each.time;
    one["example"] = each.example;
    all.append(one);
  }
  return all;
}

/// The same function for threads beside one that prepares: it waits without the interpreter lock.
template <class Of, class Result, class... Arguments>
auto shared(Result (*function)(Of&, Arguments...)) {
  return [function](Of& of, Arguments... arguments) -> Result {
    std::shared_lock<std::shared_mutex> lock(of.in_use(), std::defer_lock);
    {
      py::gil_scoped_release const released;
      lock.lock();
    }
    return function(of, std::forward<Arguments>(arguments)...);
  };
}

int dimension(OpenDensity const& of) { return of.target().dimension(); }
int residual_count(OpenDensity const& of) { return of.target().residual_count(); }
std::string solver(OpenDensity const& of) { return of.density().integrated() ? accuracy(of.density().solver()) : std::string(); }

bool prepare(OpenDensity& of, std::uint64_t seed) {
  std::unique_lock<std::shared_mutex> lock(of.in_use(), std::defer_lock);
  {
    py::gil_scoped_release const released;
    lock.lock();
  }
  return computed(of, [&] { return of.density().prepare(seed); });
}

}  // namespace

void bind_density(py::module_& module) {
  py::class_<OpenDensity>(module, "Density")
      .def(py::init([](std::shared_ptr<OpenFile> file, std::string const& task, int threads) {
             return interruptible(file->source(), [&] { return std::make_unique<OpenDensity>(file, task, threads); });
           }),
           py::arg("file"), py::arg("task"), py::arg("threads"), py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("dimension", shared(&dimension))
      .def_property_readonly("residual_count", shared(&residual_count))
      .def_property_readonly("experiments",
                             [](OpenDensity const& of) {
                               std::vector<std::string> names;
                               for (int e = 0; e < of.density().experiments(); ++e) names.push_back(of.density().name(e));
                               return names;
                             })
      .def_property_readonly("solver", shared(&solver))
      .def_property_readonly("parameters", shared(&parameters))
      .def_property_readonly("modes", shared(&modes))
      .def_property_readonly("failures", &failures)
      .def_property_readonly("solves", [](OpenDensity const& of) { return of.ledger().solves(); })
      .def("log_density", shared(&log_density_of), py::arg("values"), py::arg("declared"), py::arg("part"))
      .def("value_and_gradient", shared(&value_and_gradient), py::arg("theta"))
      .def("residuals", shared(&residuals), py::arg("theta"))
      .def("residuals_with_jacobian", shared(&residuals_with_jacobian), py::arg("theta"))
      .def("constrain", shared(&constrain), py::arg("theta"))
      .def("unconstrain", shared(&unconstrain), py::arg("values"))
      .def("sample_prior", shared(&sample_prior), py::arg("count"), py::arg("seed"))
      .def("simulate", shared(&simulate), py::arg("values"), py::arg("experiment"), py::arg("seed"))
      .def("prepare", &prepare, py::arg("seed"));
}

}  // namespace sysid::python
