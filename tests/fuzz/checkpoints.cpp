// The file is read and checked once; each change is a run with --resume in the same process.
#include "fuzz/checkpoints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "app/run/pipeline.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "fuzz/files.hpp"
#include "fuzz/mutator.hpp"
#include "report/file/sealed_cbor.hpp"

namespace sysid::fuzz {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::json;

constexpr char data[] = "t,size\n0,1.1\n1,0.62\n2,0.31\n3,0.28\n4,0.07\n5,0.12\n6,0.15\n7,0.02\n";
constexpr char models[] =
    "model decay {\n  state y\n  initial y = 1\n  parameter k ~ log_uniform(0.1, 10)\n  y' = -k*y\n"
    "  observe size ~ normal(y, sd = 0.1)\n}\n"
    "model level {\n  parameter a ~ normal(0, sd = 1)\n  observe size ~ normal(a, sd = 0.1)\n}\n"
    "model curve {\n  input x\n  parameter s ~ log_uniform(0.01, 1)\n"
    "  function d(x) ~ gp(squared_exponential(amplitude = 1, length = 3))\n  observe size ~ normal(d(x), sd = s)\n}\n"
    "candidates laws {\n  decay\n  level\n}\n"
    "data dish {\n  file \"dish.csv\"\n  time t [s]\n  measure size = size\n}\n"
    "data list {\n  file \"dish.csv\"\n  input x = t\n  measure size = size\n}\n";

class Resumed {
 public:
  Resumed(fs::path const& folder, CheckpointCase const& what)
      : folder_(folder), verb_(what.verb), source_((folder / "case.sysid").string(), models + ("task = " + what.statement + "\n")) {
    fs::create_directories(folder);
    put(folder / "dish.csv", data);
    put(folder / "case.sysid", std::string(source_.text()));
    Diagnostics diagnostics;
    file_ = load(source_, diagnostics);
    if (!file_) throw UserError(diagnostics.all().front());
  }

  /// As it is left by a run that is interrupted as late as checkpoints are kept.
  std::string checkpoint() {
    std::string latest;
    for (std::uint64_t poll = 8;; poll += poll / 2) {
      clear();
      if (run(poll, false) != ExitCode::interrupted) break;
      if (fs::exists(path())) latest = bytes_of(path());
    }
    if (latest.empty()) throw std::runtime_error("no checkpoint is left");
    return latest;
  }

  /// What a run that goes on from `bytes` writes; nothing where it is refused or stops. polls: until it is interrupted, 0: never.
  std::optional<std::string> from(std::string const& bytes, std::uint64_t polls) {
    clear();
    fs::create_directories(results());
    put(path(), bytes);
    try {
      if (run(polls, true) > ExitCode::doubtful) return std::nullopt;
    } catch (UserError const&) {
      return std::nullopt;
    } catch (IoError const&) {
      return std::nullopt;
    }
    std::string written;
    std::vector<fs::path> files;
    for (fs::directory_entry const& entry : fs::recursive_directory_iterator(results()))
      if (entry.is_regular_file() && entry.path().filename() != "timing.json") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (fs::path const& file : files) written += file.filename().string() + "\n" + bytes_of(file);
    return written;
  }

 private:
  fs::path results() const { return folder_ / "results" / "task"; }
  fs::path path() const { return results() / "checkpoint.cbor"; }
  void clear() const { fs::remove_all(folder_ / "results"); }

  ExitCode run(std::uint64_t polls, bool resume) {
    RunOptions options;
    options.output = folder_ / "results";
    options.figures = false;
    options.resume = resume;
    options.seed = 1;
    options.execution.threads = 1;
    options.interrupt_after = polls;
    options.checkpoint_interval = 0;
    SilentProgress silent;
    std::ostringstream out, notices;
    struct Cleared {
      ~Cleared() { clear_interrupt(); }
    } const cleared;
    return run_tasks(source_, *file_, {verb_}, options, silent, out, notices);
  }

  fs::path folder_;
  std::string verb_;
  Source source_;
  std::optional<CheckedFile> file_;
};

/// Resumes from content that the seal vouches for: changed as bytes or as a value, of the same owner. What goes wrong is told.
std::string resume_forged(Resumed& run, json const& outer, json const& content, Mutator& mutate) {
  json forged = content;
  if (mutate.below(2) == 0) {
    forged["content"] = mutate(content.at("content"));
  } else {
    std::vector<std::uint8_t> const whole = json::to_cbor(content.at("content"));
    std::string const other = mutate(std::string(whole.begin(), whole.end()));
    if (!is_plain_cbor(other)) return "";
    forged["content"] = json::from_cbor(other, true, false);
    if (forged["content"].is_discarded()) return "";
  }
  try {
    run.from(sealed_cbor(forged, outer.at("form").get<int>()), 30);
    return "";
  } catch (std::bad_alloc const&) {
    return "";
  } catch (std::exception const& error) {
    return fmt::format("forged to `{}`: {}", forged.dump(-1, ' ', false, json::error_handler_t::replace), error.what());
  }
}

}  // namespace

std::vector<CheckpointCase> checkpoint_cases() {
  return {
      {"search", "fit", "fit decay to dish with map"},
      {"mh", "fit", "fit decay to dish with mh(samples = 40, burn_in = 20, thin = 1, chains = 2)"},
      {"nuts", "fit", "fit decay to dish with nuts(samples = 40, burn_in = 20, thin = 1, chains = 2)"},
      {"tempering", "fit", "fit decay to dish with tempering(samples = 40, burn_in = 20, thin = 1, chains = 2, temperatures = 2)"},
      {"abc_smc", "select",
       "select laws to dish with abc_smc(particles = 20, populations = 3, polish = yes, polish_samples = 100)"},
      {"function", "fit", "fit curve to list with map"}};
}

Outcome mutate_checkpoint(fs::path const& folder, CheckpointCase const& what, std::uint64_t count, std::uint64_t seed) {
  Resumed run(folder, what);
  Outcome outcome;
  Mutator mutate({seed, Purpose::test, std::hash<std::string>()(what.name), 0});
  std::string const checkpoint = run.checkpoint();
  auto const meant = run.from(checkpoint, 0);
  if (!meant) throw std::runtime_error(what.name + ": the checkpoint as it was written is refused");
  json const outer = json::from_cbor(checkpoint);
  json const content = json::from_cbor(outer.at("content").get_binary());
  for (std::uint64_t i = 0; i < count && outcome.fault.empty(); ++i) {
    std::string const changed = mutate(checkpoint);
    auto const written = run.from(changed, 0);
    ++(written ? outcome.same : outcome.refused);
    if (written && *written != *meant) outcome.fault = what.name + ": went on to another result: " + changed;
    if (std::string const wrong = resume_forged(run, outer, content, mutate); !wrong.empty())
      outcome.fault = what.name + ": " + wrong;
  }
  return outcome;
}

}  // namespace sysid::fuzz
