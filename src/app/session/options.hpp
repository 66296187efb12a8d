// What the command line decides about a run; everything that shapes results is written into the resolved settings.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/system/progress.hpp"
#include "core/text/diagnostic.hpp"
#include "report/figure/figure_format.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

struct RunOptions {
  std::filesystem::path output = "results";
  bool temporary_output = false;            // a folder that is removed with the results: nothing stored names it
  Surface surface = Surface::command_line;  // where the run's messages are read
  bool force = false;                       // overwrite results of the same name
  bool resume = false;                      // go on from checkpoints, keep what is complete
  bool figures = true;
  std::vector<FigureFormat> figure_formats = {FigureFormat::svg};  // of the pictures beside the scripts

  /// None without figures.
  std::vector<FigureFormat> pictures() const { return figures ? figure_formats : std::vector<FigureFormat>{}; }
  std::optional<std::uint64_t> seed;  // in place of the file's
  ExecutionOptions execution;         // lanes, threads, executor: change nothing in the results
  double checkpoint_interval = 30;    // [s]
  std::uint64_t interrupt_after = 0;  // tests: ask for an interruption at the n-th poll; 0: never
};

/// Process exit codes.
enum class ExitCode : int {
  success = 0,   // done, diagnostics pass
  doubtful = 1,  // done, diagnostics fail, results written
  usage = 2,
  user_error = 65,  // model or data
  internal = 70,
  io = 74,
  interrupted = 75,  // resumable
};

}  // namespace sysid
