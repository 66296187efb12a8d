// A straight line as a record, and selections of models of it.
#pragma once
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/running.hpp"
#include "core/numeric/random.hpp"

namespace sysid::testing {

/// A straight line, exact or with noise of sd 0.1, in 40 rows.
inline constexpr double slope = 2;

struct Printed {
  int exit = 0;
  nlohmann::json summary;
  std::string out;
  bool has(std::string const& code) const {
    for (nlohmann::json const& finding : summary.at("findings"))
      if (finding.at("code") == code) return true;
    return false;
  }
  /// All messages of a code, a line each.
  std::string said(std::string const& code) const {
    std::string text;
    for (nlohmann::json const& finding : summary.at("findings"))
      if (finding.at("code") == code) text += finding.at("message").get<std::string>() + "\n";
    return text;
  }
  nlohmann::json const& model(std::string const& name) const { return summary.at("models").at(name); }
};

class Line {
 public:
  explicit Line(double noise, double offset = 0) {
    std::ofstream file(folder_.path() / "line.csv");
    file << "t,y,none\n";
    Stream stream({.seed = 11, .purpose = Purpose::test, .index = 0, .step = 0});
    for (int i = 0; i < 40; ++i) file << 0.1 * i << "," << offset + slope * 0.1 * i + noise * stream.normal() << ",NA\n";
  }

  /// Runs the task `answer` of models, candidates and task; the data block is `line` with channel d.
  Printed run(std::string const& text, std::string const& unit = "", std::vector<std::string> const& verbs = {"select"},
              Progress* progress = nullptr) const {
    RunOptions options;
    options.output = folder_.path() / "results";
    options.force = true;
    RunResult const result = run_text(folder_.path() / "m.sysid",
                                      text + "\ndata line { file \"line.csv\"; time t [s]; input u = t " +
                                          (unit.empty() ? "[-]" : "[s]") + " hold linear; measure d = y " + unit + " }\n",
                                      options, verbs, progress);
    return {result.exit, nlohmann::json::parse(read_file(options.output / "answer/summary.json")), result.out};
  }
  std::filesystem::path results() const { return folder_.path() / "results"; }

 private:
  TemporaryFolder folder_;
};

}  // namespace sysid::testing
