// sysid in programs of C++: sysid.h with vectors and exceptions. All of it is in this header, so any compiler and standard library
// of C++17 serves.
#pragma once
#include <sysid.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

/// With the message that the command line prints.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file of the language with its data: the density of one of its fits. Vectors hold one parameter vector behind the other, each
/// of `dimension()` numbers.
class Model {
 public:
  using Numbers = std::vector<double>;

  /// task: the name of a fit; empty: the first. threads: 0: one for each processor.
  explicit Model(std::string const& path, std::string const& task = {}, int threads = 0)
      : model_(required(sysid_load(path.c_str(), task.empty() ? nullptr : task.c_str(), threads)), &sysid_free) {}

  std::size_t dimension() const { return sysid_dimension(model_.get()); }
  std::vector<std::string> names() const { return texts(&sysid_name); }
  std::vector<std::string> units() const { return texts(&sysid_unit); }

  /// Finds the modes and the solver, as a fit does before its first sample.
  void prepare(std::uint64_t seed = 0) { require(sysid_prepare(model_.get(), seed)); }

  Numbers constrain(Numbers const& theta) const { return mapped(&sysid_constrain, theta); }
  Numbers unconstrain(Numbers const& values) const { return mapped(&sysid_unconstrain, values); }
  Numbers sample_prior(std::size_t count, std::uint64_t seed = 0) const {
    Numbers theta(count * dimension());
    require(sysid_sample_prior(model_.get(), count, seed, theta.data()));
    return theta;
  }

  Numbers log_density(Numbers const& theta) const {
    Numbers density(count_of(theta));
    require(sysid_log_density(model_.get(), density.size(), theta.data(), density.data()));
    return density;
  }
  /// The density and its derivatives, one row of `dimension()` for each vector.
  std::pair<Numbers, Numbers> log_density_gradient(Numbers const& theta) const {
    Numbers density(count_of(theta)), gradient(theta.size());
    require(sysid_log_density_gradient(model_.get(), density.size(), theta.data(), density.data(), gradient.data()));
    return {std::move(density), std::move(gradient)};
  }

  std::size_t experiments() const { return sysid_experiments(model_.get()); }
  Numbers time(std::size_t experiment = 0) const {
    Numbers time(sysid_rows(model_.get(), experiment));
    require(sysid_time(model_.get(), experiment, time.data()));
    return time;
  }
  /// A channel, state or derived quantity, one row of `time(experiment).size()` numbers for each vector.
  Numbers simulate(std::string const& quantity, Numbers const& values, std::size_t experiment = 0) const {
    Numbers out(count_of(values) * sysid_rows(model_.get(), experiment));
    require(sysid_simulate(model_.get(), experiment, quantity.c_str(), count_of(values), values.data(), out.data()));
    return out;
  }

 private:
  static void require(int failed) {
    if (failed != 0) throw Error(sysid_error());
  }
  static sysid_model* required(sysid_model* model) {
    require(model == nullptr);
    return model;
  }
  std::size_t count_of(Numbers const& vectors) const {
    std::size_t const size = dimension();
    if (size == 0 || vectors.size() % size != 0) throw Error("expected vectors of " + std::to_string(size) + " numbers");
    return vectors.size() / size;
  }
  std::vector<std::string> texts(char const* (*text)(sysid_model const*, std::size_t)) const {
    std::vector<std::string> all;
    for (std::size_t p = 0; p < dimension(); ++p) all.emplace_back(text(model_.get(), p));
    return all;
  }
  Numbers mapped(int (*map)(sysid_model const*, std::size_t, double const*, double*), Numbers const& from) const {
    Numbers to(from.size());
    require(map(model_.get(), count_of(from), from.data(), to.data()));
    return to;
  }

  std::unique_ptr<sysid_model, void (*)(sysid_model*)> model_;
};

}  // namespace sysid
