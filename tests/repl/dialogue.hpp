// A workbench with what it has said, in a folder of its own.
#pragma once
#include <sstream>
#include <string>

#include "core/system/files.hpp"
#include "repl/workbench.hpp"
#include "temporary_folder.hpp"

namespace sysid {

/// The oscillator of the tests: quick to fit, its record made by itself.
inline std::string const oscillator = R"(model oscillator {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter c [N s/m] ~ log_uniform(2, 200)
  parameter k [N/m] ~ log_uniform(1e3, 1e5)
  parameter sigma [m] ~ log_uniform(1e-7, 1e-2)
  1 [kg]*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, sd = sigma)
  derive fn [Hz] = sqrt(k/1 [kg])/(2*pi)
}
)";

class Dialogue {
 public:
  /// columns: of the terminal that shows it; 0: none.
  explicit Dialogue(int columns = 0)
      : workbench_(options(), progress_, {answers_, messages_, false, [columns] { return columns; }}) {}

  bool enter(std::string const& entry) {
    answers_.str("");
    messages_.str("");
    return workbench_.enter(entry);
  }
  std::string answers() const { return answers_.str(); }
  std::string messages() const { return messages_.str(); }
  repl::Workbench& workbench() { return workbench_; }
  std::filesystem::path const& folder() const { return folder_.path(); }
  std::string path(std::string const& name) const { return (folder() / name).string(); }

  /// The oscillator and a record of it with a cubic spring, as `bench`; 300 rows.
  void begin() {
    enter(oscillator);
    enter(
        "model maker {\n input x [N]\n state y [m]\n initial y = 0, y' = 0\n"
        "1 [kg]*y'' + 20 [N s/m]*y' + 1e4 [N/m]*y + 5e9 [N/m^3]*y^3 = x\n observe displacement ~ normal(y, sd = 1 [um]) }");
    enter("made = simulate maker with input x = gaussian(sd = 10), samples = 300, rate = 500 [Hz], seed = 1");
    enter("data bench { file \"" + path("results/made/made.csv") +
          "\"; time t [s]; input x = x [N] hold zero_order; measure displacement = displacement [m]; split train = rows 1..200 }");
    enter("change oscillator");
  }

 private:
  RunOptions options() const {
    RunOptions options;
    options.output = folder() / "results";
    options.seed = 1;
    return options;
  }

  TemporaryFolder folder_;
  SilentProgress progress_;
  std::ostringstream answers_, messages_;
  repl::Workbench workbench_;
};

}  // namespace sysid
