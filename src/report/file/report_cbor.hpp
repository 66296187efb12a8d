// report.cbor: what a page and its figures are made of and no other file of a result holds, so that they can be made anew.
#pragma once
#include <filesystem>
#include <string>

#include "result/report.hpp"

namespace sysid {

/// All of a report but the columns of its CSV files (draws, bands, functions, particles), its densities and its timing. CBOR:
/// numbers and the user's bytes come back as they were.
std::string record_bytes(Report const& report);

/// The inverse. The columns are empty, draws have chains without rows, `PriorInfo::density` is empty. UserError, naming `path`,
/// where the bytes are damaged or of another version of the form.
Report read_record(std::string const& bytes, std::filesystem::path const& path);

}  // namespace sysid
