// Records that `simulate` writes.
#include <doctest/doctest.h>

#include "app/running.hpp"

using namespace sysid;

TEST_CASE("an input and a channel of one name have columns of two names") {
  TemporaryFolder folder;
  RunOptions options;
  options.output = folder.path() / "results";
  run_text(folder.path() / "lag.sysid", R"(
model lag { input x; state s; initial s = 0; parameter tau [s] ~ log_uniform(0.1, 10); tau*s' = x - s; observe x ~ normal(s, sd = 0.1) }
truth = simulate lag with values(tau = 1), input x = gaussian(sd = 1), samples = 5, rate = 10 [Hz], seed = 1, file = "lag.csv"
)",
           options);
  std::string const text = read_file(options.output / "truth/lag.csv");
  CHECK(text.find("\nt,x_input,x,x_clean\n") != std::string::npos);
  CHECK(text.find("# column x_input") != std::string::npos);
  CHECK(text.find("# column x: measured; x_clean: without noise") != std::string::npos);
}
