// A record from a file at hand, as rows that have just arrived are.
#pragma once
#include <optional>

#include "data/record.hpp"
#include "data/table/record_file.hpp"

namespace sysid {

/// As `load` does from a file, but of any number of rows. whole: all rows of the file, whose times may be equal before they were
/// rounded; rows that arrive one after the other keep the times they came with.
std::optional<Record> read_record(RecordRequest const& request, RecordFile const& file, Diagnostics& diagnostics, bool whole = false);

}  // namespace sysid
