// The bar and the lines. Rates count from the first report, so a resumed run does not credit itself with work of before.
#include "core/system/progress_terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/text/utf8.hpp"
#include "core/text/wrapped.hpp"

namespace sysid {

namespace {

constexpr double bar_interval = 0.1;  // s between redraws
constexpr double line_interval = 10;  // s between lines
constexpr int bar_cells = 20;

TerminalProgress::Means stderr_means() {
  TerminalProgress::Means means;
  means.bar = isatty(STDERR_FILENO) == 1;
  if (means.bar) means.columns = terminal_columns(STDERR_FILENO);
  means.clock = [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
  means.write = [](std::string_view text) {
    // Progress nobody reads is no reason to stop: a failed write is let go.
    while (!text.empty()) {
      ssize_t const written = ::write(STDERR_FILENO, text.data(), text.size());
      if (written <= 0) return;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  };
  return means;
}

std::string format_rate(double rate) {
  if (rate >= 1e6) return fmt::format("{:.3g} million/s", rate / 1e6);
  if (rate >= 100) return fmt::format("{:.0f}/s", rate);
  return fmt::format("{:.2g}/s", rate);
}

}  // namespace

std::string format_duration(double seconds) {
  auto const s = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60) : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

TerminalProgress::TerminalProgress() : TerminalProgress(stderr_means()) {}

TerminalProgress::TerminalProgress(Means means) : means_(std::move(means)) {}

TerminalProgress::~TerminalProgress() {
  // A bar left behind by an exception would run into the message that follows.
  if (visible_ && means_.bar) means_.write("\r\033[K");
}

void TerminalProgress::begin(std::string_view what, std::uint64_t total) {
  if (running_) end();
  what_ = what;
  note_.clear();
  total_ = total;
  done_ = 0;
  begun_ = means_.clock();
  shown_ = means_.bar ? begun_ - bar_interval : begun_;
  running_ = true;
  has_first_ = false;
  visible_ = false;
}

std::string TerminalProgress::status(double now) const {
  double const share = total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0;
  std::string out = what_;
  if (total_ > 0) {
    if (means_.bar) {
      int const full = static_cast<int>(share * bar_cells);
      out += fmt::format(" [{}{}]", std::string(static_cast<std::size_t>(full), '='),
                         std::string(static_cast<std::size_t>(bar_cells - full), ' '));
      out += fmt::format(" {:3.0f} %", std::floor(100 * share));
    } else {
      out += fmt::format(": {:.0f} % ({} of {})", std::floor(100 * share), done_, total_);
    }
  } else {
    out += fmt::format("{} {}", means_.bar ? "" : ":", done_);
  }
  if (has_first_ && now > first_time_ && done_ > first_done_) {
    double const rate = static_cast<double>(done_ - first_done_) / (now - first_time_);
    out += fmt::format(", {}", format_rate(rate));
    if (total_ > done_) out += fmt::format(", {} left", format_duration(static_cast<double>(total_ - done_) / rate));
  }
  if (!note_.empty()) out += fmt::format(", {}", note_);
  return out;
}

void TerminalProgress::advance(std::uint64_t done, std::string_view note) {
  if (!running_) return;
  double const now = means_.clock();
  done_ = done;
  if (!has_first_) {
    has_first_ = true;
    first_time_ = now;
    first_done_ = done;
  }
  if (now - shown_ < (means_.bar ? bar_interval : line_interval)) return;
  note_ = note;
  shown_ = now;
  visible_ = true;
  if (means_.bar)
    means_.write(fmt::format("\r\033[K{}", first_characters(status(now), means_.columns - 1)));
  else
    means_.write(status(now) + "\n");
}

void TerminalProgress::end(bool finished) {
  if (!running_) return;
  running_ = false;
  // A job shorter than an interval is not worth a line; a bar leaves the screen to what follows.
  if (visible_) {
    if (means_.bar)
      means_.write("\r\033[K");
    else
      means_.write(
          fmt::format("{}: {} {}\n", what_, finished ? "done in" : "stopped after", format_duration(means_.clock() - begun_)));
  }
  visible_ = false;
}

}  // namespace sysid
