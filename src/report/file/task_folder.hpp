// A task's folder of results: what its files are called, that nothing is overwritten unasked, and the writing of all of them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/figure/figure_format.hpp"
#include "report/page/html.hpp"
#include "result/report.hpp"

namespace sysid {

/// The table of `track`, which grows while rows arrive: a result as soon as it is there, and not written by `write_result`.
inline constexpr char const* tracked_rows = "track.csv";

/// True when the folder holds a result of before. A checkpoint is none.
bool holds_result(std::filesystem::path const& folder);

/// UserError when it holds a result.
void require_no_result(std::filesystem::path const& folder);

/// Removes the files of a result (draws of more chains than a new run has would otherwise stay), with the pictures, texts and
/// scripts that lie in its figures/. but: a file that stays, whatever its name.
void remove_result(std::filesystem::path const& folder, std::filesystem::path const& but = {});

/// Removes what a killed run left half written, of the files that a run writes into its folder; those of other names stay. To be
/// called by whoever holds the folder's lock.
void remove_partial(std::filesystem::path const& folder);

/// draws_N.csv, predict.csv (predict_EXPERIMENT.csv when there are several), states.csv (the same), pointwise.csv, figures/,
/// report.html, report.cbor, resolved.sysid, timing.json and, last of all, summary.json: where it stands, the result is whole.
/// `pictures`: what figures are drawn as, beside their scripts; with none the page has none either. Returns what `write_figures`
/// does; IoError names the file that could not be written.
std::vector<std::string> write_result(Report const& report, std::filesystem::path const& folder,
                                      std::vector<FigureFormat> const& pictures = {FigureFormat::svg});

/// All figures of a report, drawn where `pictures` are wanted and gnuplot is there.
std::vector<DrawnFigure> drawn_figures(Report const& report, bool pictures);

/// Their scripts, and each as `pictures` say, into figures/ of the folder. Returns the pictures that gnuplot did not draw:
/// "pairs.pdf".
std::vector<std::string> write_figures(std::vector<DrawnFigure> const& figures, std::filesystem::path const& folder,
                                       std::vector<FigureFormat> const& pictures);

/// "gnuplot did not draw pairs.pdf and 2 more; the scripts are in figures/". undrawn: as `write_figures` returns it, not empty.
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
