// A forked child does the work, under limits of memory and time, and its answer comes back through a pipe.
#include "data/format/own_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

bool write_all(int file, char const* bytes, std::size_t size) {
  while (size > 0) {
    ssize_t const written = ::write(file, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

/// Bytes of address space in use.
std::size_t space_in_use() {
  std::size_t pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void limit(int resource, rlim_t value) {
  rlimit const limits{value, value};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &limits);
}

int constexpr answer = STDERR_FILENO + 1;  // where the copy writes to
#ifdef __SANITIZE_ADDRESS__
int constexpr open_at_once = 3;  // whether memory can be read is found out with a pipe
#else
int constexpr open_at_once = 1;
#endif

/// In the copy: default signals, no output, limits; then the work.
[[noreturn]] void work_and_exit(int out, std::size_t memory, std::function<std::string()> const& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int const signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGHUP, SIGXCPU}) std::signal(signal, SIG_DFL);
  std::signal(SIGINT, SIG_IGN);  // who asked for the work ends it
  int const nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, 60 + memory / 10'000'000);
  limit(RLIMIT_AS, space_in_use() + memory);
  // Files of the process that asked are closed, with their locks, and one more can be open at a time: the record. HDF5 would follow
  // a dataset that says that its numbers lie in another file, whichever it is.
  if (out != answer) ::dup2(out, answer);
  ::close_range(answer + 1, ~0U, 0);
  limit(RLIMIT_NOFILE, answer + 1 + open_at_once);
  ::setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
  try {
    std::string const result = work();
    ::_exit(write_all(answer, "!", 1) && write_all(answer, result.data(), result.size()) ? 0 : 1);
  } catch (...) {
    ::_exit(1);
  }
}

/// Ends the copy, whatever happens here.
class Child {
 public:
  Child(pid_t process, int in) : process_(process), in_(in) {}
  ~Child() {
    ::close(in_);
    ::kill(process_, SIGKILL);
    wait();
  }
  Child(Child const&) = delete;
  /// Whether it has used processor time since this was last asked, or waits for a processor or a disk and not for a lock.
  bool computes() {
    clockid_t clock{};
    timespec used{};
    if (::clock_getcpuclockid(process_, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return true;  // it has ended
    double const now = static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
    return std::exchange(used_, now) != now || runs();
  }
  bool ended_well() { return wait() == 0; }

 private:
  bool runs() const {
    char state = 0;
    if (std::FILE* const file = std::fopen(fmt::format("/proc/{}/stat", process_).c_str(), "r")) {
      if (std::fscanf(file, "%*d (%*[^)]) %c", &state) != 1) state = 0;
      std::fclose(file);
    }
    return state == 'R' || state == 'D';
  }
  int wait() {
    if (waited_) return status_;
    while (::waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
    }
    waited_ = true;
    return status_;
  }
  pid_t process_;
  int in_, status_ = -1;
  double used_ = -1;  // [s]
  bool waited_ = false;
};

}  // namespace

RecordCopy::RecordCopy(std::string const& bytes)
    : path_((std::filesystem::temp_directory_path() / "sysid_record_XXXXXX").string()), size_(bytes.size()) {
  int const file = ::mkstemp(path_.data());
  bool const written = file >= 0 && write_all(file, bytes.data(), bytes.size());
  std::string const reason = std::strerror(errno);
  if (file >= 0) ::close(file);
  if (written) return;
  if (file >= 0) ::unlink(path_.c_str());
  throw IoError(fmt::format("cannot write `{}`: {}", path_, reason), "make room there, or set TMPDIR to another folder");
}

RecordCopy::~RecordCopy() { ::unlink(path_.c_str()); }

OwnWork in_own_process(std::size_t memory, std::function<std::string()> const& work) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw IoError("cannot read the record: " + std::string(std::strerror(errno)));
  pid_t const process = ::fork();
  if (process < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    throw IoError("cannot read the record: " + std::string(std::strerror(errno)));
  }
  if (process == 0) {
    ::close(ends[0]);
    work_and_exit(ends[1], memory, work);
  }
  ::close(ends[1]);
  Child child(process, ends[0]);
  std::string result;
  std::string piece(1U << 20U, '\0');
  int idle = 0;
  for (;;) {
    stop_if_interrupted();
    pollfd ready{ends[0], POLLIN, 0};
    int const state = ::poll(&ready, 1, 100);
    // Another thread may have held a lock of the library when the copy was made: such a copy waits for ever, without computing.
    if (state == 0 && ++idle % 20 == 0 && !child.computes()) return {WorkEnd::waited, {}};
    if (state == 0 || (state < 0 && errno == EINTR)) continue;
    ssize_t const got = ::read(ends[0], piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    result.append(piece, 0, static_cast<std::size_t>(got));
  }
  if (!child.ended_well() || !result.starts_with('!')) return {};
  result.erase(0, 1);
  return {WorkEnd::done, std::move(result)};
}

}  // namespace sysid
