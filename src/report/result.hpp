// A task's folder of results: what its files are called, that nothing is overwritten unasked, and the writing of all of them.
#pragma once
#include <filesystem>

#include "report/report.hpp"

namespace sysid {

/// True when the folder holds a result of before. A checkpoint is none.
bool holds_result(std::filesystem::path const& folder);

/// Makes the folder ready before the work begins. Throws UserError when it holds a result and `force` is not given; with `force`
/// the files of that result are removed (draws of more chains than the new run has would otherwise stay), nothing else.
void prepare_result(std::filesystem::path const& folder, bool force);

/// draws_N.csv, predict.csv (predict_EXPERIMENT.csv when there are several), figures/, report.html, resolved.sysid, timing.json
/// and, last of all, summary.json: where it stands, the result is whole. Without `pictures` figures are left as scripts.
/// IoError names the file that could not be written.
void write_result(Report const& report, std::filesystem::path const& folder, bool pictures = true);

}  // namespace sysid
