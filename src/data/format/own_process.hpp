// Work of libraries that a forged file can crash, in a process of its own.
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

namespace sysid {

/// The bytes of a record as a file, for a library that opens files by name: what is read is what was hashed and unpacked, whatever
/// becomes of the record. Removed with the object. HDF5 follows links, so no name under /proc does.
class RecordCopy {
 public:
  /// IoError where it cannot be written.
  explicit RecordCopy(std::string const& bytes);
  ~RecordCopy();
  RecordCopy(RecordCopy const&) = delete;
  std::string const& path() const { return path_; }
  std::size_t size() const { return size_; }

 private:
  std::string path_;
  std::size_t size_ = 0;
};

/// What `work` returns, done in a copy of this process, which ends with it; nothing where that crashed, took more memory than
/// `memory` bytes beyond what this process has, or computed for longer than a minute and a second for each 10 MB of that.
/// Interrupted as asked for. Output of the libraries is dropped.
std::optional<std::string> in_own_process(std::size_t memory, std::function<std::string()> const& work);

}  // namespace sysid
