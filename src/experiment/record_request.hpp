// What a model reads of a data block, before any file is opened.
#pragma once
#include <filesystem>

#include "check/checked/checked.hpp"
#include "data/record.hpp"

namespace sysid {

/// folder: that of the .sysid file, from which paths are relative.
RecordRequest record_request(DataBlock const& block, Model const& model, std::filesystem::path const& folder);
/// Whether anything in its equations depends on the time itself.
bool reads_time(Model const& model);
/// UserError where the rows of a model in discrete time are not as far apart as it says, or not equally far.
void require_steps(Record const& record, DataBlock const& block, Model const& model);

}  // namespace sysid
