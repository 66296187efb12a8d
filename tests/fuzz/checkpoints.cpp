// The file is read and checked once for all changes, in one process; `Resumed` runs the task as `--resume` does, `Kept` the part of
// such a run that reads the checkpoint.
#include "fuzz/checkpoints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "app/run/pipeline.hpp"
#include "app/run/task_runners.hpp"
#include "app/session/session.hpp"
#include "app/session/task_checkpoint.hpp"
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

/// What `read` gives; nothing where the file is refused.
template <class Value>
std::optional<Value> unless_refused(std::function<std::optional<Value>()> const& read) {
  try {
    return read();
  } catch (UserError const&) {
    return std::nullopt;
  } catch (IoError const&) {
    return std::nullopt;
  }
}

/// Whole runs.
class Resumed {
 public:
  Resumed(fs::path const& folder, CheckpointCase const& what)
      : folder_(folder), what_(what), source_((folder / "case.sysid").string(), models + ("task = " + what.statement + "\n")) {
    fs::create_directories(folder);
    put(folder / "dish.csv", data);
    put(folder / "case.sysid", std::string(source_.text()));
    Diagnostics diagnostics;
    file_ = load(source_, diagnostics);
    if (!file_) throw UserError(diagnostics.all().front());
  }

  Source const& source() const { return source_; }
  CheckedFile const& file() const { return *file_; }
  fs::path path() const { return results() / "checkpoint.cbor"; }

  RunOptions options(bool resume) const {
    RunOptions options;
    options.output = folder_ / "results";
    options.figures = false;
    options.resume = resume;
    if (!resume) options.seed = 1;  // else that of the checkpoint
    options.execution.threads = 1;
    return options;
  }

  /// As it is left by a run that is interrupted as late as what is asked about is kept.
  std::string checkpoint() {
    std::uint64_t late = 8;
    while (interrupted_at(late)) late *= 2;
    for (std::uint64_t early = 0; late - early > 1;) {
      std::uint64_t const between = (early + late) / 2;
      (interrupted_at(between) ? early : late) = between;
    }
    while (--late > 0)
      if (interrupted_at(late) && fs::exists(path()))
        if (std::string bytes = bytes_of(path()); holds(bytes)) return bytes;
    throw std::runtime_error("no checkpoint is left with " + what_.holds);
  }

  /// What a run that goes on from `bytes` writes; nothing where it is refused or stops. polls: until it is interrupted, 0: never.
  std::optional<std::string> from(std::string const& bytes, std::uint64_t polls) {
    clear();
    fs::create_directories(results());
    put(path(), bytes);
    return unless_refused<std::string>([&]() -> std::optional<std::string> {
      if (run(polls, true) > ExitCode::doubtful) return std::nullopt;
      return written();
    });
  }

 private:
  fs::path results() const { return folder_ / "results" / "task"; }
  void clear() const { fs::remove_all(folder_ / "results"); }

  bool interrupted_at(std::uint64_t poll) {
    clear();
    return run(poll, false) == ExitCode::interrupted;
  }

  bool holds(std::string const& bytes) const {
    json const content = json::from_cbor(json::from_cbor(bytes).at("content").get_binary()).at("content");
    json::json_pointer const part(what_.holds);
    return content.contains(part) && !content[part].is_null();
  }

  ExitCode run(std::uint64_t polls, bool resume) {
    RunOptions options = this->options(resume);
    options.interrupt_after = polls;
    if (polls > 0) options.checkpoint_interval = 0;  // of a run to its end nobody reads a checkpoint
    SilentProgress silent;
    std::ostringstream out, notices;
    struct Cleared {
      ~Cleared() { clear_interrupt(); }
    } const cleared;
    return run_tasks(source_, *file_, {what_.verb}, options, silent, out, notices);
  }

  std::string written() const {
    std::string all;
    std::vector<fs::path> files;
    for (fs::directory_entry const& entry : fs::recursive_directory_iterator(results()))
      if (entry.is_regular_file() && entry.path().filename() != "timing.json") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (fs::path const& file : files) all += file.filename().string() + "\n" + bytes_of(file);
    return all;
  }

  fs::path folder_;
  CheckpointCase what_;
  Source source_;
  std::optional<CheckedFile> file_;
};

/// Calls at each report of a job's progress that may end the job.
class Reports : public SilentProgress {
 public:
  explicit Reports(std::function<void()> at) : at_(std::move(at)) {}
  void begin(std::string_view, std::uint64_t) override { at_(); }
  void advance(std::uint64_t, std::string_view) override { at_(); }

 private:
  std::function<void()> at_;
};

/// Runs of the task alone, whose data and compiled models are kept from one to the next, from a checkpoint to where a run computes
/// something that is not in it. So changes cost what reading costs.
class Kept {
 public:
  /// checkpoint: as it was written.
  Kept(Resumed const& run, std::string const& checkpoint)
      : path_(run.path()),
        file_(run.file()),
        options_(run.options(true)),
        reports_([this] { report(); }),
        session_(run.source(), file_, options_, reports_, nowhere_, nowhere_) {
    fs::create_directories(path_.parent_path());
    FitTask const& fit = first_fit();
    data_ = load_experiments(session_, fit.experiments, file_.models[static_cast<std::size_t>(fit.model)], fit.start,
                             fit.prediction, fit.solver);
    find_end_of_reading(checkpoint);
  }

  /// Whether the reader takes the file, which a run that goes on calls first.
  bool opens(std::string const& bytes) {
    put(path_, bytes);
    return unless_refused<bool>([&]() -> std::optional<bool> {
             TaskCheckpoint checkpoint(session_, task(), std::nullopt);
             checkpoint.of_data(data_);
             return checkpoint.stored() != nullptr;
           })
        .value_or(false);
  }

  /// Whether all of it is read, by the task's own run, and not refused.
  bool reads(std::string const& bytes) {
    put(path_, bytes);
    left_ = end_of_reading_;
    return unless_refused<bool>([&]() -> std::optional<bool> {
             try {
               (void)task_runner(kind_of(task())).run(session_, 0, task());
             } catch (AllRead const&) {
             }
             return true;
           })
        .value_or(false);
  }

 private:
  struct AllRead {};

  Task const& task() const { return file_.tasks.front(); }

  FitTask const& first_fit() const {
    SelectTask const* const selection = std::get_if<SelectTask>(&task().what);
    return selection != nullptr ? selection->fits.front() : std::get<FitTask>(task().what);
  }

  void report() {
    if (left_ > 0 && --left_ == 0) throw AllRead();
    if (looking_) looking_();
  }

  /// The last report of an unchanged run before it has kept anything new.
  void find_end_of_reading(std::string const& checkpoint) {
    put(path_, checkpoint);
    options_.checkpoint_interval = 0;
    std::uint64_t number = 0;
    looking_ = [&] {
      ++number;
      if (bytes_of(path_) != checkpoint) throw AllRead();
      end_of_reading_ = number;
    };
    try {
      (void)task_runner(kind_of(task())).run(session_, 0, task());
    } catch (AllRead const&) {
    }
    looking_ = {};
    options_.checkpoint_interval = std::numeric_limits<double>::infinity();
    if (end_of_reading_ == 0) throw std::runtime_error("a run from the checkpoint reports no progress");
  }

  fs::path path_;
  CheckedFile const& file_;
  RunOptions options_;
  Reports reports_;
  std::ostream nowhere_{nullptr};
  Session session_;
  std::vector<ExperimentData> data_;
  std::uint64_t end_of_reading_ = 0, left_ = 0;  // reports
  std::function<void()> looking_;
};

/// A checkpoint with a changed content that its seal vouches for.
class Forger {
 public:
  explicit Forger(std::string const& checkpoint)
      : form_(json::from_cbor(checkpoint).at("form").get<int>()),
        content_(json::from_cbor(json::from_cbor(checkpoint).at("content").get_binary())) {
    std::vector<std::uint8_t> const whole = json::to_cbor(content_.at("content"));
    bytes_.assign(whole.begin(), whole.end());
  }

  /// Mostly of what is stored, as a value or as bytes; else of whose it is.
  json operator()(Mutator& mutate) const {
    json forged = content_;
    if (mutate.below(16) == 0) {
      forged["who"] = mutate(content_.at("who"));
      return forged;
    }
    while (mutate.below(2) == 0) {
      std::string const other = mutate(bytes_);
      if (!is_plain_cbor(other)) continue;
      json read = json::from_cbor(other, true, false);
      if (read.is_discarded()) continue;
      forged["content"] = std::move(read);
      return forged;
    }
    forged["content"] = mutate(content_.at("content"));
    return forged;
  }

  std::string sealed(json const& forged) const { return sealed_cbor(forged, form_); }

 private:
  int form_;
  json content_;
  std::string bytes_;
};

/// Changes of what was written.
std::string resume_changed(Resumed& run, Kept& kept, std::string const& checkpoint, std::string const& meant,
                           std::string const& changed, bool always, CheckpointOutcome& outcome) {
  bool const opens = kept.opens(changed);
  if (changed == checkpoint) {
    ++outcome.same;
    return opens ? "" : "refuses what was written";
  }
  std::optional<std::string> written;
  if (opens || always) {
    ++outcome.whole;
    written = run.from(changed, 0);
  }
  ++(written ? outcome.same : outcome.refused);
  if (written && *written != meant) return "went on to another result: " + changed;
  return written && !opens ? "went on from what the reader refuses: " + changed : "";
}

/// What goes wrong from content that the seal vouches for.
std::string resume_forged(Resumed& run, Kept& kept, Forger const& forger, json const& forged, bool goes_on,
                          CheckpointOutcome& outcome) {
  try {
    std::string const bytes = forger.sealed(forged);
    ++(kept.reads(bytes) ? outcome.forged_taken : outcome.forged_refused);
    if (goes_on) {
      ++outcome.whole;
      run.from(bytes, 30);
    }
    return "";
  } catch (std::bad_alloc const&) {
    ++outcome.forged_refused;
    return "";
  } catch (std::exception const& error) {
    return fmt::format("forged to `{}`: {}", forged.dump(-1, ' ', false, json::error_handler_t::replace), error.what());
  }
}

}  // namespace

std::vector<CheckpointCase> checkpoint_cases() {
  std::string const decay = "fit decay to dish with ", chains = "(samples = 40, burn_in = 20, thin = 1, chains = 2";
  return {{"search", "fit", decay + "map", "/journal"},
          {"mh", "fit", decay + "mh" + chains + ")", "/state"},
          {"nuts", "fit", decay + "nuts" + chains + ")", "/state"},
          {"tempering", "fit", decay + "tempering" + chains + ", temperatures = 2)", "/state"},
          {"abc_smc", "select",
           "select laws to dish with abc_smc(particles = 20, populations = 3, polish = yes, polish_samples = 100)", "/chains"},
          {"reversible_jump", "select",
           "select laws to dish with reversible_jump(samples = 40, burn_in = 16, thin = 1, chains = 2, pilot = 100)", "/state"},
          {"function", "fit", "fit curve to list with map", "/journal"},
          {"climb", "fit", decay + "map", "/journal/part/1/climbers"}};
}

CheckpointOutcome mutate_checkpoint(fs::path const& folder, CheckpointCase const& what, std::uint64_t count, std::uint64_t seed,
                                    std::uint64_t every) {
  Resumed run(folder, what);
  CheckpointOutcome outcome;
  Mutator mutate({seed, Purpose::test, std::hash<std::string>()(what.name), 0});
  std::string const checkpoint = run.checkpoint();
  auto const meant = run.from(checkpoint, 0);
  if (!meant) throw std::runtime_error(what.name + ": the checkpoint as it was written is refused");
  Kept kept(run, checkpoint);
  if (!kept.reads(checkpoint)) throw std::runtime_error(what.name + ": the checkpoint as it was written is not read");
  Forger const forger(checkpoint);
  for (std::uint64_t i = 0; i < count && outcome.fault.empty(); ++i) {
    std::string wrong = resume_changed(run, kept, checkpoint, *meant, mutate(checkpoint), i % every == 0, outcome);
    if (wrong.empty()) wrong = resume_forged(run, kept, forger, forger(mutate), i % every == 0, outcome);
    if (!wrong.empty()) outcome.fault = what.name + ": " + wrong;
  }
  return outcome;
}

}  // namespace sysid::fuzz
