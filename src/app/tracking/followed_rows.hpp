// Lines of a table as they are appended to a file or come along standard input.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sysid {

class FollowedRows {
 public:
  /// path: "-" for standard input. waits: for more at the end of a file, until an interruption is asked for.
  FollowedRows(std::filesystem::path const& path, bool waits);
  ~FollowedRows();
  FollowedRows(FollowedRows const&) = delete;

  /// The lines of the header, up to the one with the names.
  std::string const& header() const { return header_; }
  /// Whole lines with rows, at least one and about `most`, as soon as there are any; nothing at the end or on an interruption.
  /// A last line without a line end is a row once nothing can follow it.
  std::vector<std::string> next(std::size_t most);

 private:
  /// Reads what there is; false at the end.
  bool read_more();
  std::optional<std::string> line();

  std::string name_;
  int file_ = -1;
  bool waits_, ended_ = false, header_found_ = false, one_column_ = false;
  std::string header_, pending_;
  std::size_t at_ = 0;
  int blanks_ = 0;  // since the last row
};

}  // namespace sysid
