// A task's folder of results: what its files are called, and the writing of all of them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/figure/figure_format.hpp"
#include "report/page/html.hpp"
#include "result/report.hpp"

namespace sysid {

/// draws_N.csv, predict.csv (predict_EXPERIMENT.csv when there are several), states.csv (the same), pointwise.csv, figures/,
/// report.html, report.cbor, resolved.sysid, timing.json and summary.json, in the place of an earlier result, which stays as it is
/// until all of them are written (`NewFiles`). `pictures`: what figures are drawn as, beside their scripts; with none the page has
/// none either. written: files of this result that stand ready under their partial names. Returns what `write_figures` does;
/// IoError names the file that could not be written.
std::vector<std::string> write_result(Report const& report, std::filesystem::path const& folder,
                                      std::vector<FigureFormat> const& pictures = {FigureFormat::svg},
                                      std::vector<std::string> const& written = {});

/// All figures of a report, drawn where `pictures` are wanted and gnuplot is there.
std::vector<DrawnFigure> drawn_figures(Report const& report, bool pictures);

/// Their scripts, and each as `pictures` say, into figures/ of the folder. Returns the pictures that gnuplot did not draw:
/// "pairs.pdf".
std::vector<std::string> write_figures(std::vector<DrawnFigure> const& figures, std::filesystem::path const& folder,
                                       std::vector<FigureFormat> const& pictures);

/// "gnuplot failed to draw pairs.pdf and 2 more; the scripts are in figures/". undrawn: as `write_figures` returns it, not empty.
std::string undrawn_words(std::vector<std::string> const& undrawn);

// Names of its files, as the writer gives them and the reader looks for them.

/// Of the chain with this index, from 0.
std::string draws_file(std::size_t chain);
/// Of each prediction, in order.
std::vector<std::string> prediction_files(Report const& report);
/// Of each free run of a discovery, in order.
std::vector<std::string> free_run_files(Report const& report);
/// Of the smoothed states of each experiment, in order.
std::vector<std::string> states_files(Report const& report);
/// Of each unknown function, in order.
std::vector<std::string> function_files(Report const& report);
/// Of a candidate model, by what `model_file_names` calls it.
std::string model_draws_file(std::string const& model);
std::string particles_file(std::string const& model);
std::string refined_file(std::string const& model, std::size_t chain);

}  // namespace sysid
