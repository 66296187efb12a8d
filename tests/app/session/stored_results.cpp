// What a run meets in its output folder: earlier results, draws of another model, damaged checkpoints, places that take no files.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>

#include "app/answer.hpp"
#include "app/run/report_results.hpp"
#include "app/session/left_by_kill.hpp"
#include "core/system/folder_lock.hpp"
#include "core/system/interrupt.hpp"
#include "report/file/sealed_cbor.hpp"
#include "report/file/stored_files.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

std::string text_with(std::string const& parameter) {
  return "model decay {\n  state y\n  initial y = 1\n  parameter " + parameter + " ~ log_uniform(0.1, 10)\n  y' = -" + parameter +
         "*y\n  observe size ~ normal(y, sd = 0.1)\n}\n" +
         "data dish {\n  file \"data/growth.csv\"\n  time t [s]\n  measure size = y\n}\n" +
         "posterior = fit decay to dish with mh(samples = 60, burn_in = 20, thin = 1, chains = 2), seed = 1\n" +
         "forecast = predict posterior on dish with draws(10), seed = 1\n";
}

Answer run(std::string const& parameter, std::filesystem::path const& output, std::vector<std::string> const& verbs = {},
           RunOptions options = {}) {
  WorkingFolder const here(error_examples);
  return answer("example.sysid", text_with(parameter), Depth::run, output, std::move(options), verbs);
}

// Interrupts runs ever later, until one has begun to sample.
std::string checkpoint_of_an_interrupted_run(std::filesystem::path const& output) {
  std::filesystem::path const checkpoint = output / "posterior" / "checkpoint.cbor";
  RunOptions options;
  options.force = true;
  for (options.interrupt_after = 16; !std::filesystem::exists(checkpoint) && options.interrupt_after < 1U << 20;
       options.interrupt_after *= 2) {
    ExitCode const exit = run("k", output, {"fit"}, options).exit;
    clear_interrupt();
    REQUIRE(exit == ExitCode::interrupted);
  }
  return content(checkpoint);
}

}  // namespace

TEST_CASE("results that exist already are kept unless force is asked for") {
  TemporaryFolder const output;
  CHECK(run("k", output.path()).exit <= ExitCode::doubtful);
  std::string const before = content(output.path() / "posterior" / "draws_1.csv");
  Answer const again = run("k", output.path());
  CHECK(again.exit == ExitCode::user_error);
  CHECK(again.messages ==
        "sysid: error: `OUT/posterior` already contains results\n"
        "help: add --force to replace them, or -o DIR to write elsewhere\n");
  CHECK(content(output.path() / "posterior" / "draws_1.csv") == before);
  RunOptions options;
  options.force = true;
  CHECK(run("k", output.path(), {}, options).exit <= ExitCode::doubtful);
}

TEST_CASE("a run that was killed while it wrote its files is run again as if it had not been") {
  TemporaryFolder const output;
  std::filesystem::path const fit = output.path() / "posterior";
  ExitCode const exit = run("k", output.path(), {"fit"}).exit;
  std::string const summary = content(fit / "summary.json");
  RunOptions resume, force;
  resume.resume = force.force = true;
  for (RunOptions const& options : {RunOptions(), resume, force}) {
    CAPTURE(options.resume);
    CAPTURE(options.force);
    leave_half_written(fit);
    CHECK(run("k", output.path(), {"predict"}).messages.find("error[E6202]: there are no draws of `posterior`") !=
          std::string::npos);
    CHECK(run("k", output.path(), {"fit"}, options).exit == exit);
    CHECK(content(fit / "summary.json") == summary);
    for (auto const& entry : std::filesystem::recursive_directory_iterator(fit)) CHECK(entry.path().extension() != ".partial");
  }
}

TEST_CASE("a run that was killed while its files got their names has a result, for everything that comes next") {
  TemporaryFolder const output;
  std::filesystem::path const fit = output.path() / "posterior";
  ExitCode const exit = run("k", output.path()).exit;
  std::string const summary = content(fit / "summary.json");
  RunOptions resume, force;
  resume.resume = force.force = true;
  auto const whole = [&] {
    CHECK(content(fit / "summary.json") == summary);
    CHECK_FALSE(std::filesystem::exists(fit / staged_list));
    CHECK_NOTHROW(read_whole_summary(fit));
  };
  leave_half_renamed(fit);
  CHECK(run("k", output.path(), {"fit"}).messages.starts_with("sysid: error: `OUT/posterior` already contains results\n"));
  whole();
  leave_half_renamed(fit);
  CHECK(run("k", output.path(), {}, resume).exit == exit);
  whole();
  leave_half_renamed(fit);
  CHECK(run("k", output.path(), {"predict"}, force).exit <= ExitCode::doubtful);
  whole();
  leave_half_renamed(fit);
  CHECK(run("k", output.path(), {"fit"}, force).exit <= ExitCode::doubtful);
  whole();
}

TEST_CASE("files of a result that have lost their summary are named as such, and replaced if that is asked for") {
  TemporaryFolder const output;
  CHECK(run("k", output.path(), {"fit"}).exit <= ExitCode::doubtful);
  std::filesystem::remove(output.path() / "posterior/summary.json");
  CHECK(run("k", output.path(), {"fit"}).messages ==
        "sysid: error: `OUT/posterior` contains no complete result: it has no `summary.json`\n"
        "help: add --force to replace them, or -o DIR to write elsewhere\n");
  RunOptions options;
  options.force = true;
  CHECK(run("k", output.path(), {"fit"}, options).exit <= ExitCode::doubtful);
}

TEST_CASE("a prediction without stored draws says what to run first") {
  TemporaryFolder const output;
  Answer const shown = run("k", output.path(), {"predict"});
  CHECK(shown.exit == ExitCode::user_error);
  CHECK(shown.messages ==
        "example.sysid:13:13: error[E6202]: there are no draws of `posterior` in `OUT/posterior`\n"
        "  13 | posterior = fit decay to dish with mh(samples = 60, burn_in = 20, thin = 1, chains = 2), seed = 1\n"
        "     |             ^^^\n"
        "help: run the fit first: sysid run FILE -o OUT, or sysid fit FILE -o OUT\n"
        "more: sysid explain E6202\n");
}

TEST_CASE("stored draws of a model with other parameters are refused") {
  TemporaryFolder const output;
  CHECK(run("k", output.path(), {"fit"}).exit <= ExitCode::doubtful);
  Answer const shown = run("rate", output.path(), {"predict"});
  CHECK(shown.exit == ExitCode::user_error);
  CHECK(shown.messages.find("error[E6201]: the results in `OUT/posterior` were computed with another text of model") !=
        std::string::npos);
  CHECK(run("k", output.path(), {"predict"}).exit <= ExitCode::doubtful);
}

TEST_CASE("complete results of another text are not kept by --resume") {
  TemporaryFolder const output;
  ExitCode const before = run("k", output.path(), {"fit"}).exit;
  CHECK(before <= ExitCode::doubtful);
  RunOptions options;
  options.resume = true;
  CHECK(run("k", output.path(), {"fit"}, options).exit == before);
  Answer const shown = run("rate", output.path(), {"fit"}, options);
  CHECK(shown.exit == ExitCode::user_error);
  CHECK(shown.messages.find("error[E6208]: the results in `OUT/posterior` were computed with another text of model") !=
        std::string::npos);
}

TEST_CASE("complete results of another statement are not kept by --resume, nor predicted with") {
  TemporaryFolder const output;
  CHECK(run("k", output.path(), {"fit"}).exit <= ExitCode::doubtful);
  std::string longer = text_with("k");
  longer.replace(longer.find("samples = 60"), 12, "samples = 80");
  RunOptions options;
  options.resume = true;
  WorkingFolder const here(error_examples);
  Answer const kept = answer("example.sysid", longer, Depth::run, output.path(), options, {"fit"});
  CHECK(kept.exit == ExitCode::user_error);
  CHECK(
      kept.messages.find("error[E6208]: the results in `OUT/posterior` were computed with another statement, or with other rows") !=
      std::string::npos);
  Answer const predicted = answer("example.sysid", longer, Depth::run, output.path(), {}, {"predict"});
  CHECK(predicted.messages.find("error[E6201]: the results in `OUT/posterior` were computed with another statement") !=
        std::string::npos);
  // To force the prediction would lead here again.
  CHECK(predicted.messages.find("help: run the fit again first: sysid fit FILE --force -o OUT\n") != std::string::npos);
  CHECK(predicted.messages.starts_with("example.sysid:13:13: "));
  RunOptions forced;
  forced.force = true;
  CHECK(answer("example.sysid", longer, Depth::run, output.path(), forced, {"fit"}).exit <= ExitCode::doubtful);
  CHECK(answer("example.sysid", longer, Depth::run, output.path(), {}, {"predict"}).exit <= ExitCode::doubtful);
}

TEST_CASE("stored draws of other data, or of other experiments, are not taken up") {
  TemporaryFolder const output, folder;
  WorkingFolder const here(folder.path());
  std::string const csv = content(error_examples / "data/growth.csv");
  std::filesystem::create_directory("data");
  write("data/growth.csv", csv);
  auto const run_here = [&](std::string const& file, std::vector<std::string> const& verbs) {
    return answer("example.sysid", file, Depth::run, output.path(), {}, verbs);
  };
  CHECK(run_here(text_with("k"), {"fit"}).exit <= ExitCode::doubtful);
  CHECK(run_here(text_with("k"), {"predict"}).exit <= ExitCode::doubtful);
  std::filesystem::remove_all(output.path() / "forecast");
  std::string parted = text_with("k");
  parted.replace(parted.find("  measure"), 0, "  split all = rows 1..4\n");
  parted.replace(parted.find("to dish"), 7, "to dish.all");
  CHECK(run_here(parted, {"predict"})
            .messages.find("error[E6201]: the results in `OUT/posterior` were computed with another set of experiments") !=
        std::string::npos);
  write("data/growth.csv", csv + "99,1\n");
  CHECK(
      run_here(text_with("k"), {"predict"})
          .messages.find("error[E6201]: the results in `OUT/posterior` were computed with another content of `data/growth.csv`") !=
      std::string::npos);
}

TEST_CASE("a damaged checkpoint and one of another text are told apart") {
  TemporaryFolder const output;
  std::string const checkpoint = checkpoint_of_an_interrupted_run(output.path());
  REQUIRE_FALSE(checkpoint.empty());
  RunOptions options;
  options.resume = true;
  Answer const other = run("rate", output.path(), {}, options);
  CHECK(other.exit == ExitCode::user_error);
  CHECK(other.messages.find("error[E6208]: `OUT/posterior/checkpoint.cbor` belongs to a run with another text of the file\n") !=
        std::string::npos);
  options.seed = 77;
  CHECK(run("k", output.path(), {}, options).messages.find("belongs to a run with another seed\n") != std::string::npos);
  options.seed.reset();
  for (std::size_t const at : {checkpoint.size() / 4, checkpoint.size() / 2, checkpoint.size() - 1}) {
    std::string flipped = checkpoint;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    write(output.path() / "posterior" / "checkpoint.cbor", flipped);
    Answer const changed = run("k", output.path(), {}, options);
    CHECK(changed.messages.find("error[E6207]: `OUT/posterior/checkpoint.cbor` is damaged") != std::string::npos);
  }
  write(output.path() / "posterior" / "checkpoint.cbor", std::string(1000000, '\x81'));  // lists in lists
  CHECK(run("k", output.path(), {}, options).exit == ExitCode::user_error);
  write(output.path() / "posterior" / "checkpoint.cbor", checkpoint.substr(0, checkpoint.size() / 2));
  Answer const damaged = run("k", output.path(), {}, options);
  CHECK(damaged.exit == ExitCode::user_error);
  CHECK(damaged.messages.find("error[E6207]: `OUT/posterior/checkpoint.cbor` is damaged") != std::string::npos);
  nlohmann::json older = nlohmann::json::from_cbor(checkpoint);
  older.erase("form");
  std::vector<std::uint8_t> const bytes = nlohmann::json::to_cbor(older);
  write(output.path() / "posterior" / "checkpoint.cbor", std::string(bytes.begin(), bytes.end()));
  CHECK(run("k", output.path(), {}, options).messages.find("error[E6207]: `OUT/posterior/checkpoint.cbor` is damaged") !=
        std::string::npos);
}

TEST_CASE("a checkpoint with a whole seal and other content than is written is damaged, and one of the same content is taken up") {
  using json = nlohmann::json;
  TemporaryFolder const output;
  std::string const checkpoint = checkpoint_of_an_interrupted_run(output.path());
  REQUIRE_FALSE(checkpoint.empty());
  json const outer = json::from_cbor(checkpoint);
  json const content = json::from_cbor(outer.at("content").get_binary());
  RunOptions options;
  options.resume = true;
  auto const resumed = [&](json const& forged) {
    write(output.path() / "posterior" / "checkpoint.cbor", sealed_cbor(forged, outer.at("form").get<int>()));
    return run("k", output.path(), {"fit"}, options);
  };
  auto const with = [&](char const* pointer, json const& value) {
    json forged = content;
    forged[json::json_pointer(pointer)] = value;
    return forged;
  };
  json seedless = content;
  seedless["who"].erase("seed");
  json const short_numbers = json::binary(std::vector<std::uint8_t>(8, 0));
  for (json const& forged :
       {json(3), json::array(), json{{"who", 1}}, with("/content", 7), with("/content/preparation", "none"),
        with("/content/preparation/moves", "many"), with("/content/preparation/solver/solver", 4),
        with("/content/preparation/solver/solver", "none"), with("/content/preparation/solver/substeps", 0),
        with("/content/preparation/findings", {{"no finding", 1, json::array(), "", ""}}),
        with("/content/preparation/modes/0/numbers", short_numbers),
        with("/content/preparation/ledger/failures",
             {{{"kind", 99}, {"where", ""}, {"count", 1}, {"time", short_numbers}, {"example", short_numbers}}})}) {
    CAPTURE(forged.dump(-1, ' ', false, json::error_handler_t::replace).substr(0, 200));
    Answer const refused = resumed(forged);
    CHECK(refused.exit == ExitCode::user_error);
    CHECK(refused.messages.find("error[E6207]: `OUT/posterior/checkpoint.cbor` is damaged") != std::string::npos);
  }
  CHECK(resumed(seedless).exit == ExitCode::user_error);
  CHECK(resumed(content).exit <= ExitCode::doubtful);
}

TEST_CASE("a summary with a whole seal and other content than is written is damaged, and one of the same content is read") {
  using json = nlohmann::ordered_json;
  TemporaryFolder const output;
  REQUIRE(run("k", output.path(), {"fit"}).exit <= ExitCode::doubtful);
  std::filesystem::path const path = output.path() / "posterior" / "summary.json";
  json const original = json::parse(content(path));
  auto const predicted = [&](char const* pointer, json const& value) {
    json forged = original;
    forged[json::json_pointer(pointer)] = value;
    forged["versions"]["summary_sha256"] = unsealed();
    write(path, sealed_summary(forged.dump(2) + "\n"));
    RunOptions options;
    options.force = true;
    return run("k", output.path(), {"predict"}, options);
  };
  CHECK(predicted("/task", original.at("task")).exit <= ExitCode::doubtful);
  struct Forged {
    char const* pointer;
    json value;
  };
  for (Forged const& each : {Forged{"/settings", 3}, Forged{"/settings/solver", 3}, Forged{"/settings/solver", "none"},
                             Forged{"/settings", {{"solver", "rk4"}, {"substeps", -1}}}, Forged{"/findings", json::array({4})},
                             Forged{"/task", 9}, Forged{"/data", json::array({1})}, Forged{"/data/0/name", 1},
                             Forged{"/versions/model_sha256", 1}, Forged{"/versions/files", 1}}) {
    CAPTURE(each.pointer);
    Answer const refused = predicted(each.pointer, each.value);
    CHECK(refused.exit == ExitCode::user_error);
    CHECK(refused.messages.find("`OUT/posterior/summary.json` is damaged") != std::string::npos);
  }
}

TEST_CASE("an output folder that cannot be made or written is an error of input and output, before any work") {
  for (char const* folder : {"/dev/full/x", "/proc/x", "/dev/null"}) {
    CAPTURE(folder);
    Answer const shown = run("k", folder);
    CHECK(shown.exit == ExitCode::io);
    CHECK(shown.messages.starts_with("sysid: error: cannot create the folder `OUT/posterior`: "));
  }
  TemporaryFolder const output;
  std::filesystem::permissions(output.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  if (::geteuid() != 0) {  // nothing is read-only to root
    Answer const shown = run("k", output.path() / "x");
    CHECK(shown.exit == ExitCode::io);
    CHECK(shown.messages.starts_with("sysid: error: cannot create the folder `OUT/posterior`: permission denied"));
  }
}

TEST_CASE("a disk that takes no byte is found before any work, and nothing half-written stays") {
  // A limit on the size of files stands in for the full disk.
  TemporaryFolder const output;
  auto const before_signal = ::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  rlimit none = before;
  none.rlim_cur = 0;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &none) == 0);
  Answer const shown = run("k", output.path());
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
  ::signal(SIGXFSZ, before_signal);
  CHECK(shown.exit == ExitCode::io);
  CHECK(shown.messages ==
        "sysid: error: cannot write `OUT/posterior/claim`: file too large\n"
        "help: check that the folder is writable and the disk has free space\n");
  CHECK_FALSE(std::filesystem::exists(output.path() / "posterior"));
}

TEST_CASE("a disk that is full after a checkpoint leaves it, and says how to go on") {
  TemporaryFolder const output;
  REQUIRE_FALSE(checkpoint_of_an_interrupted_run(output.path()).empty());
  RunOptions options;
  options.resume = true;
  auto const before_signal = ::signal(SIGXFSZ, SIG_IGN);
  rlimit before = {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  rlimit little = before;
  little.rlim_cur = 10;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
  Answer const shown = run("k", output.path(), {}, options);
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &before) == 0);
  ::signal(SIGXFSZ, before_signal);
  CHECK(shown.exit == ExitCode::io);
  CHECK(shown.messages.find("; the last checkpoint is kept: --resume continues from there\n") != std::string::npos);
  CHECK(run("k", output.path(), {}, options).exit <= ExitCode::doubtful);
}

TEST_CASE("draws that are not all there are neither predicted with nor kept by --resume") {
  TemporaryFolder const output;
  CHECK(run("k", output.path()).exit <= ExitCode::doubtful);
  std::filesystem::path const fit = output.path() / "posterior", forecast = output.path() / "forecast";
  std::string const draws = content(fit / "draws_2.csv"), band = content(forecast / "predict.csv");
  RunOptions force, resume;
  force.force = resume.resume = true;
  auto const refused = [&](std::string const& what) {
    for (auto const& [verb, options] : {std::pair("predict", force), std::pair("fit", resume)}) {
      CAPTURE(verb);
      Answer const shown = run("k", output.path(), {verb}, options);
      CHECK(shown.exit == ExitCode::user_error);
      CHECK(shown.messages.find(what) != std::string::npos);
    }
    CHECK(content(forecast / "predict.csv") == band);  // a refused prediction leaves that of before
  };
  for (int chain : {2, 1}) {
    std::filesystem::remove(fit / fmt::format("draws_{}.csv", chain));
    refused("draws_");  // one, then all
  }
  run("k", output.path(), {"fit"}, force);
  write(fit / "draws_2.csv", draws.substr(0, draws.rfind('\n', draws.size() / 4) + 1));
  refused("`OUT/posterior/draws_2.csv` has been changed since it was written");
  write(fit / "draws_2.csv", draws);
  CHECK(run("k", output.path(), {"predict"}, force).exit <= ExitCode::doubtful);
  CHECK(run("k", output.path(), {"fit"}, resume).exit <= ExitCode::doubtful);  // the verdict of what is kept
}

TEST_CASE("a forced run that ends without a result leaves the old ones, and a run that fails leaves no folders") {
  TemporaryFolder const output;
  CHECK(run("k", output.path()).exit <= ExitCode::doubtful);
  std::string const before = content(output.path() / "posterior" / "draws_1.csv");
  std::string impossible = text_with("k");  // E5002: the likelihood is finite nowhere
  impossible.replace(impossible.find("y' = -k*y"), 9, "y' = -k*y + sqrt(-1 - y^2)");
  WorkingFolder const here(error_examples);
  RunOptions force;
  force.force = true;
  Answer const failed = answer("example.sysid", impossible, Depth::run, output.path(), force, {"fit"});
  CHECK(failed.exit == ExitCode::user_error);
  CHECK(content(output.path() / "posterior" / "draws_1.csv") == before);
  CHECK(std::filesystem::exists(output.path() / "forecast" / "summary.json"));
  Answer const elsewhere = answer("example.sysid", impossible, Depth::run, output.path() / "a" / "b", {}, {});
  CHECK(elsewhere.exit == ExitCode::user_error);
  CHECK_FALSE(std::filesystem::exists(output.path() / "a"));
  CHECK(run("k", output.path(), {"fit"}, force).exit <= ExitCode::doubtful);
}

namespace {

/// All files of a task, but for what two runs of one seed may differ in.
std::map<std::string, std::string> files_in(std::filesystem::path const& folder) {
  std::map<std::string, std::string> files;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(folder))
    if (std::string const name = entry.path().filename(); entry.is_regular_file() && name != "timing.json" && name != "lock")
      files[name] = content(entry.path());
  return files;
}

}  // namespace

TEST_CASE("a forced run that is interrupted leaves the old result until it has one, and is gone on with") {
  TemporaryFolder const output;
  std::filesystem::path const folder = output.path() / "posterior", page = output.path() / "page.html";
  RunOptions other;
  other.seed = 2;
  CHECK(run("k", output.path(), {"fit"}, other).exit <= ExitCode::doubtful);
  auto const old = files_in(folder);
  RunOptions force;
  force.force = true;
  TemporaryFolder const elsewhere;
  std::filesystem::path const whole = elsewhere.path() / "posterior";
  CHECK(run("k", elsewhere.path(), {"fit"}).exit <= ExitCode::doubtful);
  for (std::uint64_t const poll : {1, 7, 23}) {  // nothing is kept yet; in the search
    CAPTURE(poll);
    std::filesystem::remove_all(output.path());
    CHECK(run("k", output.path(), {"fit"}, other).exit <= ExitCode::doubtful);
    force.interrupt_after = poll;
    force.checkpoint_interval = 0;
    CHECK(run("k", output.path(), {"fit"}, force).exit == ExitCode::interrupted);
    clear_interrupt();
    auto standing = files_in(folder);
    REQUIRE(standing.erase("checkpoint.cbor") == 1);
    CHECK(standing.at("draws_1.csv") == old.at("draws_1.csv"));
    CHECK(standing.at("summary.json") == old.at("summary.json"));
    report_results(folder, page, false);
    CHECK(std::filesystem::exists(page));
    // Which of the two is meant is not guessed.
    Answer const predicted = run("k", output.path(), {"predict"});
    CHECK(predicted.exit == ExitCode::user_error);
    CHECK(predicted.messages.find("is unfinished") != std::string::npos);
    RunOptions resume;
    resume.resume = true;
    CHECK(run("k", output.path(), {"fit"}, resume).exit <= ExitCode::doubtful);
    CHECK_FALSE(std::filesystem::exists(folder / "checkpoint.cbor"));
    for (char const* name : {"draws_1.csv", "draws_2.csv", "summary.json"}) CHECK(content(folder / name) == content(whole / name));
  }
}

TEST_CASE("a forced run that is interrupted once it samples leaves a result of its own") {
  TemporaryFolder const output;
  RunOptions other;
  other.seed = 2;
  CHECK(run("k", output.path(), {"fit"}, other).exit <= ExitCode::doubtful);
  std::string const old = content(output.path() / "posterior" / "summary.json");
  RunOptions force;
  force.force = true;
  bool replaced = false;
  for (force.interrupt_after = 16; !replaced && force.interrupt_after < 2000; force.interrupt_after += 16) {
    ExitCode const exit = run("k", output.path(), {"fit"}, force).exit;
    clear_interrupt();
    if (exit != ExitCode::interrupted) break;
    std::string const now = content(output.path() / "posterior" / "summary.json");
    replaced = now != old;
    if (replaced) CHECK(now.find("\"interrupted\"") != std::string::npos);
    CHECK(std::filesystem::exists(output.path() / "posterior" / "checkpoint.cbor"));
  }
  CHECK(replaced);
}
