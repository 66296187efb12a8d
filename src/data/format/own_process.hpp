// Work of libraries that a forged file can crash, in a process of its own.
#pragma once
#include <cstddef>
#include <functional>
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

/// How work in a process of its own ended. It failed where it crashed, threw, took more memory than it may or computed too long; it
/// waited where it had not ended and no longer computed, as one that waits for a lock or for a device does.
enum class WorkEnd { done, failed, waited };
struct OwnWork {
  WorkEnd end = WorkEnd::failed;
  std::string result;  // of `done`
};

/// What `work` returns, done in a copy of this process, which ends with it and has `memory` bytes beyond what this process has, and
/// a minute of computing and a second for each 10 MB of that. Interrupted as asked for. Output of the libraries is dropped.
OwnWork in_own_process(std::size_t memory, std::function<std::string()> const& work);

}  // namespace sysid
