// Read with the calls of the system: a stream would not see what is appended behind its end.
#include "app/tracking/followed_rows.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

constexpr int wait_milliseconds = 50;

}  // namespace

FollowedRows::FollowedRows(std::filesystem::path const& path, bool waits) : name_(path.string()), waits_(waits) {
  if (name_ == "-") {
    file_ = STDIN_FILENO;
    name_ = "standard input";
    return;
  }
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0) throw IoError(fmt::format("cannot read `{}`: {}", name_, std::strerror(errno)));
}

FollowedRows::~FollowedRows() {
  if (file_ > STDIN_FILENO) ::close(file_);
}

bool FollowedRows::read_more() {
  if (ended_) return false;
  if (at_ > 0) pending_.erase(0, std::exchange(at_, 0));
  char buffer[1 << 16];
  for (;;) {
    if (interrupt_requested()) return false;
    pollfd waiting{file_, POLLIN, 0};
    // A regular file is always ready, a pipe when something comes.
    if (::poll(&waiting, 1, wait_milliseconds) <= 0) continue;
    ssize_t const count = ::read(file_, buffer, sizeof buffer);
    if (count > 0) {
      pending_.append(buffer, static_cast<std::size_t>(count));
      return true;
    }
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw IoError(fmt::format("cannot read `{}`: {}", name_, std::strerror(errno)));
    if (!waits_ || file_ == STDIN_FILENO) {
      ended_ = true;
      return false;
    }
    ::poll(nullptr, 0, wait_milliseconds);
  }
}

std::optional<std::string> FollowedRows::line() {
  auto const end = pending_.find('\n', at_);
  if (end == std::string::npos) {
    if (!ended_ || at_ >= pending_.size()) return std::nullopt;
    return pending_.substr(std::exchange(at_, pending_.size()));
  }
  std::string text = pending_.substr(at_, end - at_);
  at_ = end + 1;
  if (!text.empty() && text.back() == '\r') text.pop_back();
  return text;
}

std::vector<std::string> FollowedRows::next(std::size_t most) {
  std::vector<std::string> rows;
  for (;;) {
    while (rows.size() < most) {
      auto text = line();
      if (!text) break;
      bool const blank = text->find_first_not_of(" \t") == std::string::npos;
      if (!header_found_) {
        header_ += *text + '\n';
        bool const says_more = text->starts_with('#') || text->starts_with("sep=") || text->starts_with("\xef\xbb\xbf#");
        header_found_ = !blank && !says_more;
        one_column_ = text->find_first_of(",;\t") == std::string::npos;
      } else if (blank) {
        if (one_column_) ++blanks_;  // a row, with its sample missing, where another follows
      } else {
        for (; blanks_ > 0; --blanks_) rows.emplace_back();
        rows.push_back(std::move(*text));
      }
    }
    if (!rows.empty()) return rows;
    if (!read_more() && (at_ >= pending_.size() || !ended_)) return rows;
  }
}

}  // namespace sysid
