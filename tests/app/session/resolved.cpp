// resolved.sysid runs in the folder of the results, whatever folder that is, and gives the bytes of the run that wrote it.
#include "app/session/resolved.hpp"

#include <doctest/doctest.h>

#include "app/running.hpp"

using namespace sysid;

namespace {

std::string const spring = "function hardening(y, k, k3) = k*y + k3*y^3\n";
// A module that uses a module.
std::string const law = "use spring\nfunction law(y, k, k3) = hardening(y, k, k3)\n";

std::string const model_and_data = R"(use law
model cubic {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter k3 [N/m^3] ~ log_uniform(1e7, 1e11)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  1 [kg]*y'' + c*y' + law(y, k, k3) = x
  observe displacement ~ normal(y, sd = sigma)
}
data bench { file "records/a record.csv"; time t [s]; input x = x [N] hold zero_order; measure displacement = displacement [m] }
)";

// The draws of a task without the line that names the file of the data.
std::string draws(std::filesystem::path const& folder) {
  std::istringstream in(read_file(folder / "draws_1.csv"));
  std::string out;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with("# data = ")) out += line + "\n";
  return out;
}

struct Written {
  TemporaryFolder folder;
  std::filesystem::path results;

  explicit Written(std::string const& tasks) : results(folder.path() / "elsewhere/results") {
    write_file(make(folder.path() / "models") / "law.sysid", law);
    write_file(folder.path() / "models/spring.sysid", spring);
    make(folder.path() / "models/records");
    write_file(folder.path() / "models/records/a record.csv", "");
    RunOptions options;
    options.output = folder.path() / "made";
    run_text(folder.path() / "models/case.sysid",
             model_and_data +
                 "made = simulate cubic with values(c = 20, k = 1e4, k3 = 5e9, sigma = 1e-6), "
                 "input x = gaussian(sd = 10), samples = 300, rate = 500 [Hz], seed = 1\n",
             options);
    write_file(folder.path() / "models/records/a record.csv", read_file(folder.path() / "made/made/made.csv"));
    options.output = results;
    run_text(folder.path() / "models/case.sysid", model_and_data + tasks, options);
  }
  static std::filesystem::path make(std::filesystem::path const& path) {
    std::filesystem::create_directories(path);
    return path;
  }
  /// The results of resolved.sysid of a task, written beside it.
  std::filesystem::path again(std::string const& task) const {
    std::filesystem::path const file = results / task / "resolved.sysid";
    RunOptions options;
    options.output = results / task / "again";
    run_text(file, read_file(file), options);
    return options.output / task;
  }
};

}  // namespace

TEST_CASE("a resolved fit runs where it lies and repeats its draws to the byte") {
  Written const written(
      "chains = fit cubic to bench with mh(samples = 400, burn_in = 200, chains = 2), seed = 3\n"
      "summit = fit cubic to bench with map, seed = 4\n");
  for (std::string const task : {"chains", "summit"}) {
    CAPTURE(task);
    std::filesystem::path const again = written.again(task);
    CHECK(draws(again) == draws(written.results / task));
    CHECK(std::filesystem::exists(again / "resolved_law.sysid"));
  }
  CHECK(read_file(written.results / "chains/resolved_law.sysid").find("use resolved_spring") != std::string::npos);
}

TEST_CASE("a resolved file names data by an absolute path where its user did") {
  TemporaryFolder const folder;
  Written const written("summit = fit cubic to bench with map, seed = 4\n");
  std::string const absolute = (written.folder.path() / "models/records/a record.csv").string();
  RunOptions options;
  options.output = written.folder.path() / "third";
  run_text(written.folder.path() / "models/case.sysid",
           with(model_and_data, "records/a record.csv", absolute) + "summit = fit cubic to bench with map, seed = 4\n", options);
  CHECK(read_file(options.output / "summit/resolved.sysid").find("\"" + absolute + "\"") != std::string::npos);
}
