// Data blocks to experiments: a record is read once per model and block, parts are cut from it for each task.
#pragma once
#include <filesystem>

#include "check/checked.hpp"
#include "core/diagnostic.hpp"
#include "data/record.hpp"
#include "report/report.hpp"

namespace sysid {

/// A data file that cannot be read, with the place in the text that names it: exit code 74.
class UnreadableData : public IoError {
 public:
  explicit UnreadableData(Diagnostic diagnostic) : IoError(diagnostic.message), diagnostic_(std::move(diagnostic)) {}
  Diagnostic const& diagnostic() const { return diagnostic_; }

 private:
  Diagnostic diagnostic_;
};

/// Data that cannot be used, with all that is wrong with them.
class UnusableData : public UserError {
 public:
  explicit UnusableData(Diagnostics diagnostics) : UserError(diagnostics.all().front()), diagnostics_(std::move(diagnostics)) {}
  Diagnostics const& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

/// The record of a data block as a model reads it; `folder`: that of the .sysid file, from which paths are relative.
/// UnusableData when something is wrong with it, UnreadableData when the file cannot be read.
Record load_record(DataBlock const& block, Model const& model, std::filesystem::path const& folder);

/// The rows of a part (-1: all), started as the task says. Throws UserError when they are outside the record or the start needs
/// more rows.
Experiment cut(Record const& record, DataBlock const& block, int part, StartRule start);

/// Provenance for reports.
DataInfo describe_data(Record const& record, DataBlock const& block, int part, Model const& model, Experiment const& experiment);

/// "bench.train".
std::string data_name(DataBlock const& block, int part);

std::string_view rule_name(InputRule rule);

}  // namespace sysid
