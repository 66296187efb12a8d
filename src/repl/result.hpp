// The results of a task as its folder holds them: draws and series along records, by the user's names.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "syntax/words.hpp"

namespace sysid::repl {

/// A parameter or derived quantity over all draws, chain after chain; declared unit.
struct DrawColumn {
  std::string name, unit;
  std::vector<double> values;
  std::optional<double> sd;  // Laplace's, where the result is an optimum
};

/// A quantity along a record: what was measured where it is (else empty), and the mean over draws; declared unit.
struct SeriesColumn {
  std::string name, unit;
  std::vector<double> mean, measured;
};

struct RecordSeries {
  std::string experiment;              // "bench.train"
  std::string axis = "t", unit = "s";  // of `time`: "row" and none where rows are independent
  std::vector<double> time;
  std::vector<char> scored;
  std::vector<SeriesColumn> quantities;
};

struct Result {
  std::string task;
  TaskKind kind = TaskKind::fit;
  std::filesystem::path folder;
  std::string summary;              // as it was printed
  std::vector<std::size_t> chains;  // draws of each
  std::vector<DrawColumn> draws;
  std::vector<RecordSeries> records;
  std::optional<double> nmse, rmse;  // of a fit or prediction; of several channels the largest nmse, and no rmse: units differ

  bool optimum() const { return chains.size() == 1 && chains[0] == 1; }
  DrawColumn const* find_draws(std::string_view name) const;
};

/// What stands in a folder of results; what is not there stays empty. Selections have draws per candidate, which are not read.
Result read_result(std::filesystem::path const& folder, std::string const& task, TaskKind kind);

}  // namespace sysid::repl
