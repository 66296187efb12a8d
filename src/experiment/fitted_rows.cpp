// Rows are compared by file and number: two blocks may name one file, by two paths, or a copy.
#include "experiment/fitted_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>

#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

/// By another path, or a copy.
bool is_same_record(std::filesystem::path const& fitted, std::filesystem::path const& predicted, std::string const& digest) {
  if (fitted == predicted) return true;
  std::error_code none, other;
  if (std::filesystem::equivalent(fitted, predicted, none)) return true;
  auto const size = std::filesystem::file_size(fitted, none), wanted = std::filesystem::file_size(predicted, other);
  if (none || other || size != wanted) return false;
  try {
    return sha256(read_file(fitted)) == digest;
  } catch (IoError const&) {
    return false;
  }
}

}  // namespace

Findings find_fitted_rows(CheckedFile const& file, std::filesystem::path const& folder, ExperimentData const& predicted,
                          std::vector<ExperimentUse> const& fitted, std::string const& task) {
  auto const path_of = [&](ExperimentUse const& use) { return folder / file.data[static_cast<std::size_t>(use.data)].path; };
  std::vector<ExperimentUse> of_this_record;
  std::copy_if(fitted.begin(), fitted.end(), std::back_inserter(of_this_record), [&](ExperimentUse const& use) {
    return is_same_record(path_of(use), path_of(predicted.use), predicted.record.digest);
  });
  auto const was_fitted = [&](int row) {
    return std::any_of(of_this_record.begin(), of_this_record.end(), [&](ExperimentUse const& use) {
      DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
      if (use.part < 0) return true;
      DataPart const& part = block.parts[static_cast<std::size_t>(use.part)];
      return row >= part.first && (part.last == 0 || row <= part.last);
    });
  };
  Experiment const& experiment = predicted.experiment;
  int scored = 0, seen = 0;
  for (std::size_t i = 0; i < experiment.scored.size(); ++i) {
    bool any = false;
    for (std::size_t c = 0; c < experiment.measured.size() && !any; ++c) any = experiment.is_scored(c, i);
    if (!any) continue;
    ++scored;
    if (was_fitted(experiment.first_row + static_cast<int>(i))) ++seen;
  }
  if (seen == 0) return {};
  std::string const rows =
      seen == scored ? fmt::format("all {} scored rows", scored) : fmt::format("{} of {} scored rows", seen, scored);
  return {{FindingCode::fitted_rows_predicted,
           Severity::note,
           {experiment.name, task},
           fmt::format("{} of {} are rows that `{}` was fitted to: the scores do not show how well it predicts", rows,
                       experiment.name, task),
           "predict rows that were held out of the fit: `split` in the data block"}};
}

}  // namespace sysid
