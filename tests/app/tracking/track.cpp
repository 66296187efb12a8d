// `track` from the text to its folder: the table, alarms, rows as they are appended, what is refused.
#include "app/tracking/track.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/running.hpp"
#include "app/session/left_by_kill.hpp"
#include "app/tracking/followed_rows.hpp"
#include "app/tracking/track_report.hpp"
#include "core/numeric/random.hpp"
#include "core/text/number.hpp"

using namespace sysid;

namespace {

std::string const oscillator = R"(model oscillator {
  input x [N]
  state y [m]
  initial y = 0, y' = 0
  parameter m [kg] = 1
  parameter c [N s/m] ~ log_uniform(0.1, 10)
  parameter k [N/m] ~ log_uniform(10, 1000)
  parameter sigma [mm] ~ log_uniform(0.1, 100)
  m*y'' + c*y' + k*y = x
  observe displacement ~ normal(y, sd = sigma)
}
data beam {
  file    "beam.csv"
  time    t
  input   x = force [N] hold zero_order
  measure displacement = d [mm]
  split   train = rows 1..500, later = rows 501..1500
}
posterior = fit oscillator to beam.train with mh(samples = 2000, burn_in = 1000, thin = 2, chains = 2), seed = 3, solver = rk4
)";

/// Rows of beam.csv; the stiffness falls by a tenth after row `change`.
std::vector<std::string> beam_rows(int rows, int change) {
  Stream stream(StreamKey{5, Purpose::test, 1, 0});
  std::vector<std::string> lines;
  double y = 0, v = 0;
  double const h = 0.03;
  for (int i = 0; i < rows; ++i) {
    double const x = 9 * stream.normal(), measured = y + 0.0055 * stream.normal();
    lines.push_back(fmt::format("{:.2f},{:.6f},{}\n", i * h, x, i == 700 ? "" : fmt::format("{:.5f}", 1000 * measured)));
    double const k = i + 1 >= change ? 90 : 100;
    for (int s = 0; s < 20; ++s) {
      double const half = v + h / 40 * (x - v - k * y);
      y += h / 20 * half;
      v = half + h / 40 * (x - half - k * y);
    }
  }
  return lines;
}

struct TrackResult {
  int exit = 0;
  std::string out, notices;
};

struct Beam {
  TemporaryFolder folder;
  std::vector<std::string> rows = beam_rows(1500, 1000);

  explicit Beam(std::string const& text = oscillator) : text_(text) {
    write(1500);
    RunOptions options;
    options.output = folder.path() / "results";
    run_text(folder.path() / "beam.sysid", text_, options);
  }
  void write(int count) const {
    std::string csv = "t,force,d\n";
    for (int i = 0; i < count; ++i) csv += rows[static_cast<std::size_t>(i)];
    write_file(folder.path() / "beam.csv", csv);
  }
  TrackOptions options() const {
    TrackOptions track;
    track.result = folder.path() / "results/posterior";
    return track;
  }
  TrackResult run(TrackOptions const& options, std::string const& output = "tracked", bool force = false) const {
    RunOptions run;
    run.force = force;
    run.output = folder.path() / output;
    run.figures = false;
    Source source((folder.path() / "beam.sysid").string(), text_);
    Diagnostics diagnostics;
    auto const file = load(source, diagnostics);
    REQUIRE(file);
    SilentProgress silent;
    std::ostringstream out, notices;
    Session session(source, *file, run, silent, out, notices);
    ExitCode const code = track(session, options);
    return {static_cast<int>(code), out.str(), notices.str()};
  }
  std::string refusal(TrackOptions const& options) const {
    try {
      run(options, "refused");
    } catch (UserError const& error) {
      return error.diagnostic().message;
    }
    return "";
  }
  std::vector<std::string> table(std::string const& output = "tracked") const {
    std::istringstream text(read_file(folder.path() / output / "posterior/track.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);)
      if (!line.starts_with('#')) lines.push_back(line);
    return lines;
  }

 private:
  std::string text_;
};

}  // namespace

TEST_CASE("a track has a line for every row, an alarm where the stiffness has fallen, and a page") {
  Beam const beam;
  TrackOptions options = beam.options();
  options.first_row = 501;
  TrackResult const result = beam.run(options);
  CHECK(result.exit == 1);
  CHECK(result.notices.find("`k` fell by ") != std::string::npos);
  CHECK(result.out.find("1 change found in 1000 rows") != std::string::npos);
  CHECK(result.out.find("warning[parameter_changed]: `k` fell by ") != std::string::npos);
  CHECK(result.out.find(" N/m") != std::string::npos);
  std::vector<std::string> const table = beam.table();
  REQUIRE(table.size() == 1001);
  CHECK(table.front() ==
        "row,t,y_mean,y_sd,y'_mean,y'_sd,c_mean,c_sd,k_mean,k_sd,displacement_innovation,displacement_expected_sd,"
        "squared,samples,alarm");
  CHECK(table[1].starts_with("501,15,"));
  CHECK(table[201].find(",NaN,NaN,0,0,") != std::string::npos);  // row 701 has no sample
  int alarms = 0;
  for (std::string const& line : table) alarms += line.ends_with(",k");
  CHECK(alarms == 1);
  auto const summary = nlohmann::json::parse(read_file(beam.folder.path() / "tracked/posterior/summary.json"));
  CHECK(summary.at("verb") == "track");
  CHECK(summary.at("settings").at("parameters") == "c, k");
  CHECK(summary.at("settings").at("fixed") == "sigma");
  CHECK(summary.at("findings").front().at("code") == "parameter_changed");
  CHECK(summary.at("findings").front().at("names") == nlohmann::json{"k"});
  std::string const page = read_file(beam.folder.path() / "tracked/posterior/report.html");
  CHECK(page.find("class=\"part verdict doubtful\"") != std::string::npos);
  CHECK(page.find("That nothing was found") == std::string::npos);
  // What repeats it writes beside it, and has the options that it had, no others.
  std::string const folder = beam.folder.path().string();
  CHECK_MESSAGE(
      page.find(fmt::format("<code>sysid track {0}/beam.sysid {0}/results/posterior --rows 501.. -o {0}/tracked_again</code>",
                            folder)) != std::string::npos,
      page.substr(std::min(page.find("<code>sysid track"), page.size()), 200));
  options.parameters = {"k"};
  options.drift = {0.02, 3600, "0.02/h"};
  options.window = 512;
  beam.run(options, "other");
  std::string const other = read_file(beam.folder.path() / "other/posterior/report.html");
  CHECK(other.find(fmt::format("--rows 501.. --parameters k --drift 0.02/h --window 512 -o {}/other_again</code>", folder)) !=
        std::string::npos);
  CHECK(page.find("<th scope=\"col\" class=\"n\">from the fit</th>") != std::string::npos);
  CHECK(std::filesystem::exists(beam.folder.path() / "tracked/posterior/report.html"));
  CHECK(!std::filesystem::exists(beam.folder.path() / "tracked/posterior/track.csv.partial"));
}

TEST_CASE("a sample that is far off is left out and named, and no parameter changes by it") {
  Beam beam;
  for (std::size_t const row : {650, 651, 820}) {
    std::string& line = beam.rows[row];
    line = line.substr(0, line.rfind(',') + 1) + "900\n";
  }
  beam.write(1500);
  TrackOptions options = beam.options();
  options.first_row = 501;
  TrackResult const result = beam.run(options);
  CAPTURE(result.out);
  CHECK(result.out.find("1 change found in 1000 rows") != std::string::npos);
  CHECK(result.out.find("samples_far_off]: 3 samples far from the predictions were left out: displacement at row 651 (") !=
        std::string::npos);
  CHECK(result.out.find("innovation_size") == std::string::npos);
  CHECK(beam.table()[151].find(",NaN,NaN,0,0,") != std::string::npos);
}

TEST_CASE("samples that stay far off are a change, also where other rows have none") {
  for (std::size_t const every : {1, 2}) {
    CAPTURE(every);
    // The sensor is read in another unit from row 901 on.
    Beam beam;
    for (std::size_t row = 900; row < 1500; ++row) {
      std::string& line = beam.rows[row];
      std::size_t const comma = line.rfind(',');
      line = line.substr(0, comma + 1) + (row % every != 0 ? "\n" : fmt::format("{:.5f}\n", 4 * std::stod(line.substr(comma + 1))));
    }
    beam.write(1500);
    TrackOptions options = beam.options();
    options.first_row = 501;
    TrackResult const result = beam.run(options);
    CAPTURE(result.out);
    // Not always a parameter: the gain of a sensor moves none of them as much as it enlarges the innovations.
    bool const changed = result.out.find("parameter_changed") != std::string::npos;
    CHECK((changed || result.out.find("noise_changed") != std::string::npos));
    CHECK(result.out.find("check the sensor") != std::string::npos);
    CHECK(result.out.find("innovation_size") != std::string::npos);
  }
}

TEST_CASE("rows that are appended one by one give the table of the whole record, line by line") {
  Beam const beam;
  TrackOptions options = beam.options();
  options.first_row = 501;
  options.last_row = 800;
  beam.run(options);
  beam.write(503);
  options.follow = true;
  TrackResult followed;
  std::thread tracking([&] { followed = beam.run(options, "followed"); });
  std::ofstream file(beam.folder.path() / "beam.csv", std::ios::app);
  for (int i = 503; i < 800; ++i) {
    std::string const& line = beam.rows[static_cast<std::size_t>(i)];
    file << line.substr(0, 5) << std::flush;  // half of a line is no row
    if (i % 30 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    file << line.substr(5) << std::flush;
  }
  tracking.join();
  CHECK(followed.exit == 0);
  CHECK(beam.table("followed") == beam.table());
  // Without a change and with the noise of the fit there is nothing to warn of.
  CHECK(followed.out.find("no change found in 300 rows") != std::string::npos);
  CHECK(followed.out.find("warning[") == std::string::npos);
}

TEST_CASE("innovations that are larger than expected are a warning, and settling rows no change") {
  Beam beam;
  for (std::size_t i = 500; i < beam.rows.size(); ++i) {  // three times the noise, alternating
    std::size_t const at = beam.rows[i].rfind(',');
    std::string const sample = beam.rows[i].substr(at + 1);
    if (sample.size() > 1)
      beam.rows[i] = fmt::format("{},{:.5f}\n", beam.rows[i].substr(0, at), std::stod(sample) + (i % 2 == 0 ? 15 : -15));
  }
  beam.write(900);
  TrackOptions options = beam.options();
  options.first_row = 501;
  options.last_row = 900;
  TrackResult const result = beam.run(options);
  CHECK(result.out.find("warning[innovation_size]: the rms of the innovations is ") != std::string::npos);
  CHECK(result.out.find("larger than expected") != std::string::npos);

  // Without an order, they are noise.
  auto const fresh = beam_rows(1500, 1000);
  beam.rows = fresh;
  Stream stream(StreamKey{6, Purpose::test, 1, 0});
  for (std::size_t i = 700; i < beam.rows.size(); ++i) {
    std::size_t const at = beam.rows[i].rfind(',');
    std::string const sample = beam.rows[i].substr(at + 1);
    double const noise = 17 * stream.normal();
    if (sample.size() > 1) beam.rows[i] = fmt::format("{},{:.5f}\n", beam.rows[i].substr(0, at), std::stod(sample) + noise);
  }
  beam.write(990);
  options.last_row = 990;
  TrackResult const noisy = beam.run(options, "noisy");
  CAPTURE(noisy.out);
  CHECK(noisy.exit == 1);
  CHECK(noisy.out.find("warning[noise_changed]: the noise of `displacement` rose to ") != std::string::npos);
  CHECK(noisy.out.find("parameter_changed") == std::string::npos);

  // Rows are missing, and the times show it.
  beam.rows = fresh;
  beam.rows.erase(beam.rows.begin() + 700, beam.rows.begin() + 707);
  beam.write(980);
  options.last_row = 980;
  TrackResult const gap = beam.run(options, "gap");
  CAPTURE(gap.out);
  CHECK(gap.exit == 0);
  CHECK(gap.out.find("warning[time_gap]: the time has a gap of 0.24") != std::string::npos);
  CHECK(gap.out.find("before row 701") != std::string::npos);
  CHECK(gap.out.find("parameter_changed") == std::string::npos);
}

TEST_CASE("an interruption ends a track that follows, with its results; one of a whole record leaves nothing") {
  Beam const beam;
  TrackOptions options = beam.options();
  options.follow = true;
  TrackResult followed;
  std::thread tracking([&] { followed = beam.run(options); });
  auto const path = beam.folder.path() / "tracked/posterior/track.csv";
  for (int i = 0; i < 1000 && !(std::filesystem::exists(path) && beam.table().size() > 1500); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  request_interrupt();
  tracking.join();
  CHECK(followed.exit == 1);
  CHECK(beam.table().size() == 1501);
  CHECK(std::filesystem::exists(beam.folder.path() / "tracked/posterior/summary.json"));
  options.follow = false;
  TrackResult const stopped = beam.run(options, "stopped");
  clear_interrupt();
  CHECK(stopped.exit == 75);
  CHECK(!std::filesystem::exists(beam.folder.path() / "stopped/posterior/track.csv"));
}

TEST_CASE("a track that was killed is run again as if it had not been; rows that it followed are not overwritten unasked") {
  Beam const beam;
  TrackOptions options = beam.options();
  options.first_row = 501;
  options.last_row = 700;
  int const exit = beam.run(options).exit;
  std::filesystem::path const folder = beam.folder.path() / "tracked/posterior";
  std::string const table = read_file(folder / "track.csv"), summary = read_file(folder / "summary.json");
  auto const same = [&] { return read_file(folder / "track.csv") == table && read_file(folder / "summary.json") == summary; };
  // While its rows were gathered, and while its files were written.
  test::leave_half_written(folder);
  std::filesystem::rename(folder / "track.csv", folder / "track.csv.partial");
  CHECK(beam.run(options).exit == exit);
  CHECK(same());
  CHECK(!std::filesystem::exists(folder / "track.csv.partial"));
  // While they got their names.
  test::leave_half_renamed(folder);
  write_file(folder / staged_list, read_file(folder / staged_list) + "track.csv\n");
  std::filesystem::rename(folder / "track.csv", folder / "track.csv.partial");
  CHECK_THROWS_WITH_AS(beam.run(options), doctest::Contains("already contains results"), UserError);
  CHECK(same());
  CHECK(beam.run(options, "tracked", true).exit == exit);
  CHECK(same());
  // While it followed.
  remove_result(folder, folder / "track.csv");
  CHECK_THROWS_WITH_AS(beam.run(options), doctest::Contains("it has no `summary.json`"), UserError);
  CHECK(read_file(folder / "track.csv") == table);
  CHECK(beam.run(options, "tracked", true).exit == exit);
  CHECK(same());
}

TEST_CASE("a track that follows leaves an earlier result until its first row") {
  Beam const beam;
  TrackOptions options = beam.options();
  options.first_row = 501;
  options.last_row = 700;
  beam.run(options);
  std::filesystem::path const folder = beam.folder.path() / "tracked/posterior";
  std::string const table = read_file(folder / "track.csv"), summary = read_file(folder / "summary.json");
  options.follow = true;
  options.first_row = 1600;
  options.last_row = 0;
  std::thread ending([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    request_interrupt();
  });
  try {
    beam.run(options, "tracked", true);
  } catch (UserError const&) {  // it has no rows
  }
  ending.join();
  clear_interrupt();
  CHECK(read_file(folder / "track.csv") == table);
  CHECK(read_file(folder / "summary.json") == summary);
  options.first_row = 501;
  options.last_row = 560;
  beam.run(options, "tracked", true);
  CHECK(read_file(folder / "track.csv") != table);
  CHECK(beam.table().size() == 61);
  CHECK(read_file(folder / "summary.json") != summary);
}

TEST_CASE("a fit of very many steps between samples is tracked by as many") {
  std::string text = oscillator;
  text.replace(text.rfind("rk4"), 3, "rk4(substeps = 100)");
  Beam const beam(text);
  TrackResult const result = beam.run(beam.options());
  CHECK(result.exit == 1);  // the stiffness falls
  CHECK(result.notices.find("`k` fell by ") != std::string::npos);
  CHECK(beam.table().size() == 1501);
}

TEST_CASE("what cannot be tracked is refused, with the reason") {
  Beam const beam(oscillator + "best = fit oscillator to beam.train with map, seed = 1, solver = rk4\n");
  TrackOptions options = beam.options();
  options.parameters = {"sigma"};
  CHECK(beam.refusal(options) == "`sigma` cannot be tracked");
  options.parameters.clear();
  options.data = "bench";
  CHECK(beam.refusal(options) == "the fit has no data `bench`");
  options.data.clear();
  options.result = beam.folder.path() / "results/best";
  CHECK(beam.refusal(options).find("contains an optimum") != std::string::npos);
  options = beam.options();
  options.first_row = 2000;
  CHECK(beam.refusal(options).find("1500") != std::string::npos);
  options.first_row = options.last_row = 1;
  options.follow = true;
  CHECK(beam.refusal(options) == "tracking needs at least two rows");
}

TEST_CASE("a value has digits by its sd, nine of them beside the smallest") {
  CHECK(with_sd(1, 0.004) == significant(1, 5) + " ± " + significant(0.004, 2));
  CHECK(with_sd(1, 5e-324) == significant(1, 9) + " ± " + significant(5e-324, 2));
  CHECK(with_sd(0, 0.1) == significant(0, 2) + " ± " + significant(0.1, 2));
  CHECK(with_sd(1, 0) == significant(1, 4));
}

TEST_CASE("lines of a followed file come whole, blank ones and the header apart") {
  TemporaryFolder const folder;
  auto const path = folder.path() / "rows.csv";
  write_file(path, "# made\nsep=;\na;b\r\n1;2\n\n3;4\n5;");
  FollowedRows rows(path, false);
  CHECK(rows.next(1) == std::vector<std::string>{"1;2"});
  CHECK(rows.next(10) == std::vector<std::string>{"3;4"});
  CHECK(rows.next(10) == std::vector<std::string>{"5;"});
  CHECK(rows.next(10).empty());
  CHECK(rows.header() == "# made\nsep=;\na;b\n");

  // Of one column a blank line is a row whose sample is missing, unless it ends the file, as in a file that is read whole.
  write_file(path, "a\n1\n\n3\n\n");
  FollowedRows column(path, false);
  CHECK(column.next(10) == std::vector<std::string>{"1", "", "3"});
  CHECK(column.next(10).empty());
}
