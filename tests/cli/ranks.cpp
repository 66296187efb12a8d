// Several processes of mpirun do what one does, to the byte, and end together.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <thread>

#include "cli/asked.hpp"
#include "sanitized.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

std::filesystem::path const models = std::filesystem::path(SYSID_SOURCE_DIR) / "models";

/// A shipped case and its data, with the settings of its back end replaced.
class CaseDesk : public Desk {
 public:
  CaseDesk(std::string const& name, std::string const& from, std::string const& to) {
    for (auto const& entry : std::filesystem::directory_iterator(models / name))
      if (entry.path().extension() == ".csv") std::filesystem::copy_file(entry.path(), path(entry.path().filename().string()));
    std::string text = std::regex_replace(read_file(models / name / (name + ".sysid")), std::regex("truth [^;]*?csv\"\\)?\n"), "");
    text = std::regex_replace(text, std::regex("truth [\\s\\S]*?file = [^\n]*\n"), "");
    save("case.sysid", std::regex_replace(text, std::regex(from), to));
  }
  /// `mpirun -n RANKS sysid ARGUMENTS`; 0: without mpirun.
  Said with(int ranks, std::string const& arguments) const {
    if (ranks == 0) return ask(arguments);
    return said_by(command(ranks, arguments));
  }
  std::string command(int ranks, std::string const& arguments) const {
    return fmt::format("cd '{}' && NO_COLOR=1 exec mpirun --allow-run-as-root --oversubscribe -n {} '{}' {}", path(".").string(),
                       ranks, SYSID_PROGRAM, arguments);
  }
  /// All files below a folder but those of times, by name.
  std::map<std::string, std::string> files(std::string const& folder) const {
    std::map<std::string, std::string> all;
    for (auto const& entry : std::filesystem::recursive_directory_iterator(path(folder)))
      if (entry.is_regular_file() && entry.path().filename() != "timing.json")
        all[entry.path().lexically_relative(path(folder)).string()] = read_file(entry.path());
    return all;
  }
  /// A page states the command that repeats it, with the folder: all are written under one name.
  void keep_as(std::string const& name) const { std::filesystem::rename(path("out"), path(name)); }
  /// Of a result: how many ranks, and how often they exchanged results.
  int timed(std::string const& folder, std::string const& what) const {
    std::smatch found;
    std::string const text = read_file(path(folder + "/timing.json"));
    return std::regex_search(text, found, std::regex("\"" + what + "\": (\\d+)")) ? std::stoi(found[1]) : 0;
  }
};

CaseDesk selection() { return {"bouc_wen", "abc_smc\\([^)]*\\)", "abc_smc(particles = 150, populations = 6)"}; }

/// Each of the first runs in the folder, one more in `other` below it.
Said with_another(CaseDesk const& desk, int ranks, std::string const& arguments) {
  return said_by(desk.command(ranks, arguments) + " : -n 1 --wdir '" + desk.path("other").string() + "' '" SYSID_PROGRAM "' " +
                 arguments);
}

void copy_into_another(CaseDesk const& desk) {
  std::filesystem::create_directory(desk.path("other"));
  for (auto const& entry : std::filesystem::directory_iterator(desk.path(".")))
    if (entry.is_regular_file()) std::filesystem::copy_file(entry.path(), desk.path("other") / entry.path().filename());
}

bool have_mpi() {
  if (sanitized) return false;  // what the library does not give back would be reported
  bool const found =
      said_by("command -v mpirun").exit == 0 && said_by("'" SYSID_PROGRAM "' version").text.find("no MPI") == std::string::npos;
  if (!found) MESSAGE("no MPI: not tested");
  return found;
}

void check_same(CaseDesk const& desk, std::string const& folder, std::string const& other) {
  auto const expected = desk.files(folder), found = desk.files(other);
  CHECK(expected.size() == found.size());
  CHECK(expected.size() > 2);
  for (auto const& [name, bytes] : expected) {
    CAPTURE(name);
    REQUIRE(found.contains(name));
    CHECK((found.at(name) == bytes));
  }
}

void check_ranks(CaseDesk const& desk, std::string const& arguments, std::string const& result, std::vector<int> const& numbers) {
  Said const alone = desk.with(0, arguments + " -o out");
  REQUIRE_MESSAGE(alone.exit <= 1, alone.text);
  desk.keep_as("alone");
  for (int const ranks : numbers) {
    CAPTURE(ranks);
    std::string const folder = fmt::format("by{}", ranks);
    Said const said = desk.with(ranks, arguments + " -o out" + (ranks == 2 ? " --threads 3" : ""));
    CHECK_MESSAGE(said.exit == alone.exit, said.text);
    desk.keep_as(folder);
    check_same(desk, "alone", folder);
    if (ranks == 1) continue;
    CHECK(desk.timed(folder + "/" + result, "ranks") == ranks);
    if (static_cast<unsigned>(ranks) > std::thread::hardware_concurrency()) continue;  // that may not be worth it
    CHECK(desk.timed(folder + "/" + result, "exchanges") > 1);
  }
}

/// A process group of its own, in the background.
class Running {
 public:
  explicit Running(std::string const& command, std::string const& log) : child_(fork()) {
    if (child_ != 0) return;
    setpgid(0, 0);
    execl("/bin/sh", "sh", "-c", (command + " >'" + log + "' 2>&1").c_str(), nullptr);
    _exit(127);
  }
  ~Running() {
    if (child_ > 0) kill(-child_, SIGKILL);
  }
  Running(Running const&) = delete;
  Running& operator=(Running const&) = delete;
  pid_t process() const { return child_; }
  /// The exit code, as a shell gives it; -1 where it has not ended within some seconds.
  int end(double seconds) {
    for (int k = 0; k < 20 * seconds; ++k) {
      int status = 0;
      if (waitpid(child_, &status, WNOHANG) == child_) {
        child_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return -1;
  }
  /// Processes of the ranks, in order.
  std::vector<pid_t> ranks() const {
    std::vector<pid_t> all;
    std::istringstream listed(said_by(fmt::format("ps -o pid= --ppid {}", child_)).text);
    for (pid_t each; listed >> each;) all.push_back(each);
    return all;
  }

 private:
  pid_t child_;
};

bool wait_for(std::filesystem::path const& path, double seconds) {
  for (int k = 0; k < 50 * seconds && !std::filesystem::exists(path); ++k)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return std::filesystem::exists(path);
}

/// What a job is that takes long enough to be stopped.
CaseDesk long_selection(int particles) {
  return {"bouc_wen", "abc_smc\\([^)]*\\)", fmt::format("abc_smc(particles = {}, populations = 6)", particles)};
}

}  // namespace

TEST_CASE("the program itself needs no MPI") {
  CHECK(said_by("ldd '" SYSID_PROGRAM "'").text.find("libmpi") == std::string::npos);
  Desk const desk;
  std::filesystem::copy_file(SYSID_PROGRAM, desk.path("alone"));  // away from its module
  std::string const alone = "cd '" + desk.path(".").string() + "' && NO_COLOR=1 ";
  CHECK(said_by(alone + "./alone --version").text.find("no MPI") != std::string::npos);
  CHECK(said_by(alone + "OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=1 ./alone run none.sysid").text.find("E6213") ==
        std::string::npos);
  Said const said = said_by(alone + "OMPI_COMM_WORLD_RANK=0 OMPI_COMM_WORLD_SIZE=2 ./alone run none.sysid");
  CHECK(said.exit == 74);
  CHECK_MESSAGE(
      said.text.find("error[E6213]: started as one of several processes, but they cannot find each other: ") != std::string::npos,
      said.text);
  // What is not divided is done by the first.
  CHECK(said_by(alone + "OMPI_COMM_WORLD_RANK=1 OMPI_COMM_WORLD_SIZE=2 ./alone list solvers").text.empty());
}

TEST_CASE("a selection and its forecast are the same bytes on any number of ranks") {
  if (!have_mpi()) return;
  check_ranks(selection(), "run case.sysid --no-figures", "selection", {1, 2, 4});
}

TEST_CASE("a fit is the same bytes on any number of ranks") {
  if (!have_mpi()) return;
  CaseDesk const desk("duffing", "mh\\([^)]*\\)", "mh(samples = 600, burn_in = 200, thin = 1, chains = 12)");
  check_ranks(desk, "run case.sysid --no-figures", "posterior", {2, 4});
}

TEST_CASE("a calibration is the same bytes on any number of ranks") {
  if (!have_mpi()) return;
  CaseDesk const desk("duffing", "mh\\([^)]*\\)", "mh(samples = 300, burn_in = 100, thin = 1, chains = 4)");
  check_ranks(desk, "calibrate case.sysid --no-figures --replications 11", "posterior", {2});  // one has more of them
}

TEST_CASE("a run is resumed on another number of ranks") {
  if (!have_mpi()) return;
  CaseDesk const desk = selection();
  REQUIRE(desk.with(0, "run case.sysid --no-figures -o out").exit <= 1);
  desk.keep_as("whole");
  Said const stopped = desk.with(4, "run case.sysid --no-figures -o out --interrupt-after 9");
  CHECK_MESSAGE(stopped.exit == 75, stopped.text);
  CHECK(desk.has("out/selection/checkpoint.cbor"));
  Said const again = desk.with(2, "run case.sysid --no-figures -o out --resume --interrupt-after 6");
  CHECK_MESSAGE(again.exit == 75, again.text);
  CHECK(desk.with(3, "run case.sysid --no-figures -o out --resume").exit <= 1);
  check_same(desk, "whole", "out");
}

TEST_CASE("a calibration is resumed on another number of ranks") {
  if (!have_mpi()) return;
  CaseDesk const desk("duffing", "mh\\([^)]*\\)", "mh(samples = 300, burn_in = 100, thin = 1, chains = 4)");
  std::string const calibrate = "calibrate case.sysid --no-figures --replications 10 -o ";
  REQUIRE(desk.with(0, calibrate + "out").exit <= 1);
  desk.keep_as("whole");
  CHECK(desk.with(2, calibrate + "out --interrupt-after 3").exit == 75);
  CHECK(desk.with(3, calibrate + "out --resume").exit <= 1);
  check_same(desk, "whole", "out");
}

TEST_CASE("what is wrong is said once") {
  if (!have_mpi()) return;
  CaseDesk const desk = selection();
  Said const said = desk.with(3, "run missing.sysid");
  auto const first = said.text.find("cannot read `missing.sysid`");
  CHECK_MESSAGE(first != std::string::npos, said.text);
  CHECK(said.text.find("cannot read `missing.sysid`", first + 1) == std::string::npos);
  CHECK(said.exit == 74);
  Said const unknown = desk.with(2, "run case.sysid --no-such-option");
  CHECK_MESSAGE(unknown.exit == 2, unknown.text);
}

TEST_CASE("what one rank alone cannot do ends all, and its reason is said") {
  if (!have_mpi()) return;
  CaseDesk const desk = selection();
  std::filesystem::create_directory(desk.path("other"));
  Said const said = with_another(desk, 2, "run case.sysid --no-figures -q");
  CHECK_MESSAGE(said.exit == 74, said.text);
  auto const who = said.text.find("sysid: rank 2 (process ");
  REQUIRE(who != std::string::npos);
  CHECK(said.text.find("cannot read `case.sysid`", who) != std::string::npos);
  CHECK(said.text.find("sysid: stopped, as rank 2 has failed") != std::string::npos);
}

TEST_CASE("ranks with another text, other data or other arguments are named, and nothing is computed") {
  if (!have_mpi()) return;
  CaseDesk const desk("duffing", "mh\\([^)]*\\)", "mh(samples = 300, burn_in = 100, thin = 1, chains = 4)");
  auto const check = [](Said const& said, int exit, std::initializer_list<char const*> words) {
    CHECK_MESSAGE(said.exit == exit, said.text);
    std::size_t at = said.text.find("error[E6215]: rank 2 (process ");
    CHECK_MESSAGE(at != std::string::npos, said.text);
    for (char const* word : words) CHECK_MESSAGE(said.text.find(word) != std::string::npos, said.text);
    CHECK(said.text.find("E6215", at + 20) > said.text.find("sysid explain", at));  // once
  };
  std::string const run = "run case.sysid --no-figures -o out";
  auto const replaced = [&](std::string const& name, std::string const& from, std::string const& to) {
    copy_into_another(desk);
    std::string text = read_file(desk.path(name));
    auto const at = text.rfind(from);
    REQUIRE(at != std::string::npos);
    write_file(desk.path("other/" + name), text.replace(at, from.size(), to));
    Said const said = with_another(desk, 2, run);
    CHECK_FALSE(desk.has("out"));
    std::filesystem::remove_all(desk.path("other"));
    return said;
  };
  check(replaced("case.sysid", "samples = 300", "samples = 301"), 65,
        {"case.sysid:", "another text of `case.sysid` than rank 0", "the first line that differs", "samples = 300"});
  check(replaced("duffing_1pct.csv", "1", "2"), 65, {"case.sysid:", "other data in `duffing_1pct.csv` than rank 0"});
  check(said_by(desk.command(2, run + " --seed 1") + " : -n 1 '" SYSID_PROGRAM "' " + run + " --seed 2"), 2,
        {"other arguments than rank 0: `run case.sysid", "--seed 2`, not `run case.sysid", "--seed 1`"});
}

TEST_CASE("ranks that come to different decisions end") {
  if (!have_mpi()) return;
  CaseDesk const desk = selection();
  copy_into_another(desk);
  // Results that the other has already, and rank 0 does not see.
  REQUIRE(said_by("cd '" + desk.path("other").string() + "' && '" SYSID_PROGRAM "' run case.sysid --no-figures -q").exit <= 1);
  for (auto const& entry : std::filesystem::directory_iterator(desk.path("other/results")))
    if (entry.path().filename() != "selection") std::filesystem::remove_all(entry.path());
  Said const said = with_another(desk, 1, "run case.sysid --no-figures -q --resume");
  CHECK_MESSAGE(said.exit == 70, said.text);
  CHECK(said.text.find("the ranks came to different places of the program") != std::string::npos);
}

TEST_CASE("what the leader alone cannot do ends all") {
  if (!have_mpi()) return;
  CaseDesk const desk = selection();
  desk.save("occupied", "a file where the folder should be");
  Said const said = desk.with(3, "run case.sysid --no-figures -o occupied");
  CHECK_MESSAGE(said.exit == 74, said.text);
  CHECK(said.text.find("cannot create the folder") != std::string::npos);
}

TEST_CASE("a rank that is killed ends the others, and the run goes on from its checkpoint") {
  if (!have_mpi()) return;
  CaseDesk const desk = long_selection(2500);
  REQUIRE(desk.with(0, "run case.sysid --no-figures -o out").exit <= 1);
  desk.keep_as("whole");
  for (std::size_t const victim : {1U, 0U}) {
    CAPTURE(victim);
    Running job(desk.command(3, "run case.sysid --no-figures --checkpoint-interval 0.05 -o out"), desk.path("log").string());
    REQUIRE(wait_for(desk.path("out/selection/checkpoint.cbor"), 60));
    std::vector<pid_t> const ranks = job.ranks();
    REQUIRE(ranks.size() == 3);
    kill(ranks[victim], SIGKILL);
    int const code = job.end(10);
    std::string const said = read_file(desk.path("log"));
    CHECK_MESSAGE((code == 137 || code == 75), said);
    // A busy machine lets mpirun end the others before they can say so themselves.
    bool const told = said.find("error[E6214]: rank ") != std::string::npos || said.find("signal 9") != std::string::npos;
    CHECK_MESSAGE(told, said);
    CHECK(desk.has("out/selection/checkpoint.cbor"));
    CHECK(desk.with(2, "run case.sysid --no-figures --resume -o out").exit <= 1);
    check_same(desk, "whole", "out");
    std::filesystem::remove_all(desk.path("out"));
  }
}

TEST_CASE("a job at its time limit ends with a checkpoint") {
  if (!have_mpi()) return;
  // mpirun passes SIGTERM on after one to two seconds, SIGUSR1 at once; it takes SIGINT the same way as SIGTERM.
  for (int const signal : {SIGTERM, SIGUSR1}) {
    CAPTURE(signal);
    CaseDesk const desk = long_selection(signal == SIGTERM ? 20000 : 2500);
    // Without the interval the first checkpoint would come with the last population.
    Running job(desk.command(2, "run case.sysid --no-figures --checkpoint-interval 0.05 -o out"), desk.path("log").string());
    REQUIRE(wait_for(desk.path("out/selection/checkpoint.cbor"), 60));
    kill(job.process(), signal);
    int const code = job.end(10);
    std::string const said = read_file(desk.path("log"));
    CHECK_MESSAGE(code > 0, said);
    REQUIRE(desk.has("out/selection/checkpoint.cbor"));
    if (signal == SIGTERM) continue;  // mpirun leaves a second, in which nothing may be said
    CHECK_MESSAGE(code == 75, said);
    CHECK_MESSAGE(said.find("interrupted") != std::string::npos, said);
    // By one process, which does once what every rank would do for itself.
    CHECK(desk.with(0, "run case.sysid --no-figures --resume -o out").exit <= 1);
    desk.keep_as("resumed");
    REQUIRE(desk.with(0, "run case.sysid --no-figures -o out").exit <= 1);
    check_same(desk, "resumed", "out");
  }
}
