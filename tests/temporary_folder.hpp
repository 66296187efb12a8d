// A folder for the time of a test.
#pragma once
#include <stdlib.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace sysid {

/// Of its own, whatever runs beside; removed with all in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (parent() / "sysid_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::filesystem::filesystem_error("mkdtemp", name, std::error_code(errno, std::generic_category()));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(TemporaryFolder const&) = delete;
  TemporaryFolder& operator=(TemporaryFolder const&) = delete;

  std::filesystem::path const& path() const { return path_; }

 private:
  /// In memory where there is room: a test that saves its state at every step would wait for the disk longer than it computes.
  /// TMPDIR overrides it.
  static std::filesystem::path parent() {
    std::error_code error;
    bool const stated = std::getenv("TMPDIR") != nullptr;
    auto const memory = stated ? std::filesystem::space_info{} : std::filesystem::space("/dev/shm", error);
    constexpr std::uintmax_t enough = std::uintmax_t{1} << 30;
    return !stated && !error && memory.available >= enough ? "/dev/shm" : std::filesystem::temp_directory_path();
  }
  std::filesystem::path path_;
};

}  // namespace sysid
