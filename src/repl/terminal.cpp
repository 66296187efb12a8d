// The dialogue on libedit: Tab completes, arrows recall, Ctrl-C takes back the line or stops a run, Ctrl-D ends.
#include <fmt/format.h>
#include <histedit.h>
#include <langinfo.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstring>
#include <cwchar>
#include <iostream>
#include <memory>

#include "core/system/interrupt.hpp"
#include "core/text/number.hpp"
#include "core/text/wrapped.hpp"
#include "repl/completion.hpp"
#include "repl/prompt.hpp"
#include "repl/state.hpp"
#include "syntax/entry.hpp"

namespace sysid::repl {
namespace {

volatile std::sig_atomic_t interrupts = 0, resized = 0;

void on_interrupt(int) {
  interrupts = interrupts + 1;
  request_interrupt();  // a run stops at its next safe point, however often it is asked
}
void on_resize(int) { resized = 1; }

void handle(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // a read at the prompt must end
  sigaction(signal, &action, nullptr);
}

/// Letters of all alphabets, whatever the locale.
void read_utf8() {
  std::setlocale(LC_CTYPE, "");
  if (std::strcmp(nl_langinfo(CODESET), "UTF-8") != 0) std::setlocale(LC_CTYPE, "C.UTF-8");
}

/// One character from the terminal; -1 when Ctrl-C came instead: libedit's own read would go on after it.
int next_character(EditLine* line, wchar_t* character) {
  std::mbstate_t state = {};
  while (true) {
    pollfd wanted = {STDIN_FILENO, POLLIN, 0};
    int const ready = poll(&wanted, 1, -1);
    if (resized != 0) {
      resized = 0;
      el_resize(line);
    }
    if (interrupts != 0) {
      errno = EINTR;
      return -1;
    }
    if (ready < 0) continue;
    char byte = 0;
    ssize_t const got = read(STDIN_FILENO, &byte, 1);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return static_cast<int>(got);
    std::size_t const used = std::mbrtowc(character, &byte, 1, &state);
    if (used == static_cast<std::size_t>(-2)) continue;  // the character goes on
    if (used == static_cast<std::size_t>(-1)) {
      state = {};
      continue;
    }
    if (byte == 0) *character = L'\0';
    return 1;
  }
}

int columns() {
  int const known = terminal_columns(STDOUT_FILENO);
  return known > 0 ? known : 80;
}

class Dialogue {
 public:
  explicit Dialogue(Workbench& workbench)
      : workbench_(workbench), editor_(el_init("sysid", stdin, stdout, stderr), &el_end), history_(history_init(), &history_end) {
    HistEvent event;
    history(history_.get(), &event, H_SETSIZE, 2000);
    history(history_.get(), &event, H_SETUNIQUE, 1);
    if (auto const folder = state_folder(); !folder.empty()) {
      file_ = (folder / "history").string();
      history(history_.get(), &event, H_LOAD, file_.c_str());
    }
    el_set(editor_.get(), EL_CLIENTDATA, this);
    el_set(editor_.get(), EL_EDITOR, "emacs");
    el_set(editor_.get(), EL_PROMPT, &Dialogue::prompt);
    el_set(editor_.get(), EL_HIST, history, history_.get());
    el_set(editor_.get(), EL_GETCFN, &next_character);
    el_set(editor_.get(), EL_ADDFN, "sysid-complete", "complete the word before the cursor", &Dialogue::on_tab);
    el_set(editor_.get(), EL_BIND, "^I", "sysid-complete", nullptr);
    el_set(editor_.get(), EL_BIND, "^R", "em-inc-search-prev", nullptr);
    el_source(editor_.get(), nullptr);
  }

  int run() {
    std::cout << "sysid " SYSID_VERSION ": `help` lists the commands, Tab completes, Ctrl-D ends\n" << std::flush;
    while (!workbench_.over()) {
      interrupts = 0;
      errno = 0;
      int length = 0;
      char const* text = el_gets(editor_.get(), &length);
      if (text == nullptr || length <= 0) {
        std::cout << (interrupts != 0 ? "^C\n" : "\n") << std::flush;
        if (interrupts == 0 && entry_.empty()) break;  // Ctrl-D
        entry_.clear();
        continue;
      }
      entry_.append(text, static_cast<std::size_t>(length));
      if (!workbench_.complete(entry_)) continue;
      remember();
      workbench_.set_plot_size({std::clamp(columns() - 16, 20, 100), 14});
      workbench_.enter(entry_);
      entry_.clear();
    }
    return 0;
  }

 private:
  static Dialogue& of(EditLine* line) {
    void* self = nullptr;
    el_get(line, EL_CLIENTDATA, &self);
    return *static_cast<Dialogue*>(self);
  }

  static char* prompt(EditLine* line) {
    static char first[] = "sysid> ", further[] = "  ...> ";
    return of(line).entry_.empty() ? first : further;
  }

  static unsigned char on_tab(EditLine* line, int) { return of(line).complete(); }

  unsigned char complete() {
    LineInfo const* info = el_line(editor_.get());
    std::string const so_far = entry_ + std::string(info->buffer, info->cursor);
    Completions const found = completions(workbench_, so_far);
    if (found.words.empty()) return CC_REFRESH_BEEP;
    std::string const written = so_far.substr(found.begin), common = common_beginning(found.words);
    if (common.size() > written.size()) {
      el_insertstr(editor_.get(), common.substr(written.size()).c_str());
      return CC_REFRESH;
    }
    if (found.words.size() == 1) return CC_REFRESH;
    show(found.words);
    return CC_REDISPLAY;
  }

  /// In columns, as a shell does.
  void show(std::vector<std::string> const& words) const {
    constexpr std::size_t most = 200;
    std::size_t width = 0;
    for (std::string const& word : words) width = std::max(width, word.size() + 2);
    std::size_t const across = std::max<std::size_t>(1, static_cast<std::size_t>(columns()) / width);
    std::cout << '\n';
    for (std::size_t i = 0; i < words.size() && i < most; ++i)
      std::cout << fmt::format("{:<{}}{}", words[i], width, (i + 1) % across == 0 || i + 1 == words.size() ? "\n" : "");
    if (words.size() > most) std::cout << fmt::format("\n... and {} more\n", words.size() - most);
    std::cout << std::flush;
  }

  /// A statement of several lines comes back as one, which can be edited as one.
  void remember() {
    std::string arguments;
    std::string text = command_of(entry_, arguments) != nullptr ? entry_ : in_one_line(entry_);
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    if (text.empty()) return;
    HistEvent event;
    history(history_.get(), &event, H_ENTER, text.c_str());
    if (!file_.empty()) history(history_.get(), &event, H_SAVE, file_.c_str());
  }

  Workbench& workbench_;
  std::unique_ptr<EditLine, void (*)(EditLine*)> editor_;
  std::unique_ptr<History, void (*)(History*)> history_;
  std::string entry_, file_;
};

}  // namespace

int talk(Workbench& workbench) {
  read_utf8();
  handle(SIGINT, &on_interrupt);
  handle(SIGWINCH, &on_resize);
  return Dialogue(workbench).run();
}

}  // namespace sysid::repl
