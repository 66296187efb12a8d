// Which format a file has, and who reads it.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/text/source.hpp"
#include "data/table/column_needs.hpp"
#include "data/table/reading_rules.hpp"
#include "data/table/record_file.hpp"

namespace sysid {

/// A format that is recognised by the first bytes of a file. What no row recognises is text.
struct FormatRow {
  std::string_view name;  // as messages call it: "MATLAB file"
  bool (*recognises)(std::string_view bytes);
  /// bytes: the file, uncompressed. rules: what is missing. UserError where they cannot be read.
  std::unique_ptr<RecordFile> (*open)(std::string path, std::string const& bytes, std::string digest, ReadingRules const& rules);
};

std::span<FormatRow const> formats();
/// The row of a file that is no text; nullptr for text.
FormatRow const* format_of(std::string_view bytes);

/// IoError where the file cannot be read, UserError at `mention` where it is no record. A gzip file is read as what is in it.
/// shown_path: what messages name in place of the path; empty: the path.
std::unique_ptr<RecordFile> open_record(std::string const& path, ReadingRules const& rules, ColumnNeeds const& needs = {},
                                        std::optional<Span> mention = std::nullopt, std::string const& shown_path = {});

}  // namespace sysid
