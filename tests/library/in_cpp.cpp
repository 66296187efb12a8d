// A program in C++17 that uses an installed libsysid.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <sysid.hpp>

namespace {

void require(bool holds, char const* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::exit(1);
}

template <class Call>
void refused(Call&& call, char const* message) {
  try {
    call();
  } catch (sysid::Error const& error) {
    return require(std::string(error.what()).find(message) != std::string::npos, error.what());
  }
  require(false, message);
}

}  // namespace

int main(int, char** argv) {
  sysid::Model model(argv[1], "posterior", 1);
  require(model.names() == std::vector<std::string>{"m", "c", "k", "k3", "beta"}, "the names");
  require(model.units()[1] == "N s/m", "the units");
  std::vector<double> const values = {1.0, 20.0, 1.0e4, 5.0e9, 8.0e10, 1.1, 20.0, 1.0e4, 5.0e9, 8.0e10};
  std::vector<double> const theta = model.unconstrain(values), density = model.log_density(theta);
  require(density.size() == 2 && density[0] > density[1], "the density");
  auto const [value, gradient] = model.log_density_gradient(theta);
  require(value.size() == 2 && gradient.size() == 10 && std::isfinite(gradient[9]), "the gradient");
  require(model.constrain(model.sample_prior(3)).size() == 15, "the prior");
  require(model.simulate("y", values).size() == 2 * model.time().size(), "the simulation");
  sysid::Model moved = std::move(model);
  refused([&] { moved.log_density({1.0, 2.0}); }, "expected vectors of 5 numbers");
  refused([&] { sysid::Model nowhere("nowhere.sysid"); }, "cannot read");
  refused([&] { moved.simulate("y", values, 7); }, "there is no experiment 7");
  refused([&] { moved.time(7); }, "there is no experiment 7");
  // Long enough for machine code to pay: its compiler is found from where the library lies.
  for (unsigned seed = 0; seed < 5; ++seed) moved.log_density(moved.sample_prior(20000, seed));
  std::ifstream maps("/proc/self/maps");
  std::string const loaded((std::istreambuf_iterator<char>(maps)), std::istreambuf_iterator<char>());
  require(loaded.find("sysid_native.so") != std::string::npos, "machine code");
  std::printf("%.17g %.17g %s\n", density[0], density[1], sysid_version());
}
