// What is known of a file before any sampling, as plain data.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/system/ledger.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Something declared: its name, unit and, in the user's words, what is said about it.
struct DeclaredLine {
  std::string name, unit, text;
};

struct ModelPage {
  std::string name, title;
  std::vector<std::string> equations, unknowns;  // "m*y'' + k*y = x"; "y''"
  std::vector<DeclaredLine> states;              // text: "order 2"; in discrete time "2 past samples"
  std::vector<DeclaredLine> inputs, disturbances, channels, parameters, derived;
  std::vector<std::string> unchecked;  // places whose units could not be compared, in the user's words
};

/// What the equations of a discovery may be made of.
struct DictionaryPage {
  std::string name, title;
  std::vector<DeclaredLine> states, inputs;  // text: "measured as displacement"
  struct Equation {
    std::string target, unit;
    std::vector<DeclaredLine> terms;  // unit: of the coefficient; text: "coefficient k", "known"
  };
  std::vector<Equation> equations;
  std::vector<std::string> excluded;  // "y*y': excluded"
};

/// The rows of a record that a task uses.
struct CoveragePage {
  std::string name, file, made_by;  // made_by: the simulate task that makes the file, when it is not there yet
  int rows = 0, first = 0, last = 0, scored = 0, start_rows = 0;
  double rate = 0;              // Hz, of the usual step; 0: rows that no time orders
  int gaps = 0;                 // steps longer than 1.5 usual ones
  bool equal = true;            // steps
  bool timed = true;            // false: rows of any order
  std::string time_unit = "s";  // in which the record counts its time,
  double time_scale = 1;        // [s] one of these
  struct Input {
    std::string name, unit, rule;  // rule: between samples; empty where the model reads none there
    double low = 0, high = 0;      // Hz: between them lies 99 % of the power
    bool constant = false;
    double top = 0;     // share of its power above 0.4 of the sampling rate
    double chords = 0;  // rms of what straight lines between samples leave out of the spline through them, over the input's sd
    bool cut_by_lines = false;  // smooth, and `chords` is not little
  };
  std::vector<Input> inputs;
  struct Channel {
    std::string name, unit;
    int measured = 0, missing = 0;  // of the scored samples
    double range = 0;               // largest less smallest, declared unit
  };
  std::vector<Channel> channels;
};

/// What draws of the prior predict with the actual input.
struct PriorPage {
  int draws = 0, failed = 0;    // failed: with every solver that was tried; those that a stiff one could not try, at the same rate
  int failed_as_stated = 0;     // with the solver of the task,
  std::string stated;           // this one,
  bool spent = false;           // whose work budget, not its step, is what most of them lack
  int failed_explicit = 0;      // of these with adaptive explicit steps, too
  std::string explicit_solver;  // these; empty: not tried
  int stiff_left = 0;           // of these open where the solver for stiff equations last began,
  int stiff_tried = 0;          // of which it has tried so many
  int stiff_followed = 0;       // and followed so many
  std::string stiff_solver;     // this one
  std::vector<Failure> failures;  // where draws fail, one each, and
  int untraced = 0;               // so many that were not looked into
  struct Channel {
    std::string name, unit;                // "displacement", "displacement on bare.train" where there are several experiments
    double low = 0, middle = 0, high = 0;  // 5, 50 and 95 % of the draws' ranges, declared unit
    double measured = 0;
  };
  std::vector<Channel> channels;
};

/// What the data can tell about parameters, at draws of the prior whose response is of the size measured.
struct InformationPage {
  int draws = 0;                    // that were looked at
  int rank_low = 0, rank_high = 0;  // of the slopes, over draws
  int rows = 0;                     // only so many rows with a scored sample were looked at; 0: all
  std::string noise;                // "beta = 3.2e10 1/m^2": at which the noise was taken
  struct Line {
    std::string name, unit;
    bool relative = false;     // sds are shares of the value
    double prior_width = 0;    // declared unit, or a share
    double low = 0, high = 0;  // expected posterior sd over the draws
    std::string instead;       // in their place: "no influence", "noise of displacement"
  };
  std::vector<Line> lines;
  std::vector<std::string> null_directions;
  std::vector<std::string> ridges;                    // confounded pairs that are known all the same
  std::string refinement;                             // "half the step"
  std::vector<std::pair<std::string, double>> moves;  // solver, largest move of a parameter [sd] when it is refined
  std::string taken;                                  // the one that the task goes on with; empty: the fit chooses
  std::string exact;                                  // one that makes no error, in use or not; empty: there is none
  std::optional<double> found_move;  // of a mode that was found from the nearest draws, with the stated solver, when refined [sd]
  std::string advised;               // the first that no longer moves the result; empty: none that was tried
  bool prior_overflows = false;      // explicit steps do on a large part of the prior: `advised` is an implicit method
  std::optional<double> response_move;  // of a candidate: of the middle response, as a part of its sd, when refined
};

/// What the priors of a channel's Gaussian processes say of data like these.
struct ProcessPage {
  std::string channel, unit;
  int draws = 0, failed = 0;      // failed: without a likelihood
  int rows = 0, repeated = 0;     // repeated: with the inputs of an earlier one
  bool filtered = false;          // the work is proportional to the rows, else to their cube
  double bytes = 0, seconds = 0;  // of one likelihood that is not filtered, roughly
  double measured_sd = 0;         // declared unit
  struct Spread {
    double low = 0, middle = 0, high = 0;  // 5, 50 and 95 % of the draws
  };
  struct Inputs {
    double range = 0, spacing = 0;  // spacing: the middle gap between neighbours
    int places = 0;                 // that differ
  };
  struct Line {
    std::string name, what, unit;  // "d in temperature", "length"
    Spread prior;                  // declared unit
    std::optional<Inputs> inputs;  // of a length
  };
  std::vector<Line> lines;
};

/// What is to be expected of one model of a task: of the fitted one, or of a candidate.
struct PreflightPage {
  std::string candidate;  // its name; empty in a fit
  std::optional<PriorPage> prior;
  std::optional<InformationPage> information;
  std::vector<std::string> disturbances;  // which of each and of the noise of the measurement the record can tell apart
  std::vector<ProcessPage> processes;     // of each channel, where the model has Gaussian processes
  std::string not_examined;               // why something was not examined
  Findings findings;
};

struct TaskPage {
  std::string name, what;
  std::vector<CoveragePage> coverage;     // of each experiment
  std::vector<PreflightPage> preflights;  // one of a fit, one for each candidate of a selection, none of other tasks
  Findings findings;                      // of the data

  /// Those of the data, then of each preflight page.
  Findings all_findings() const;
};

struct CheckPage {
  std::string file;
  std::vector<ModelPage> models;
  std::vector<DictionaryPage> dictionaries;
  std::vector<TaskPage> tasks;
  int data_blocks = 0;
  int errors = 0, warnings = 0;  // told beside the page, with places in the text
};

}  // namespace sysid
