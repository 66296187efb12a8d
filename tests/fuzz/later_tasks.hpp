// Results of a file that was run, as later tasks of that file and `--resume` read them.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace sysid::fuzz {

class LaterTasks {
 public:
  /// Runs all of `file`; results go to `output`, a folder for each task.
  LaterTasks(std::filesystem::path const& file, std::filesystem::path const& output);
  ~LaterTasks();

  /// Of tasks that leave a result.
  std::vector<std::string> names() const;
  /// All numbers that a prediction takes from this task's folder, and whether the result is of this file. UserError or IoError
  /// where it is refused.
  std::string read(std::string const& name) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sysid::fuzz
