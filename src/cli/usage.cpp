// CLI11 reports what it could not read; we add similar names.
#include "cli/usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/text/words.hpp"
#include "syntax/words.hpp"

namespace sysid::cli {
namespace {

constexpr std::size_t most_named = 3;  // commands in a message

std::vector<std::string> verb_names(CLI::App const& app) {
  std::vector<std::string> names;
  for (CLI::App const* verb : app.get_subcommands({})) names.push_back(verb->get_name());
  return names;
}

/// With those of the program, which work behind any verb.
std::vector<std::string> option_names(CLI::App const& verb) {
  std::vector<std::string> names;
  for (CLI::App const* app : {&verb, verb.get_parent()})
    for (CLI::Option const* option : app->get_options())
      if (!option->get_group().empty())
        for (std::string const& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Other verbs with an option of this name.
std::vector<std::string> verbs_with(CLI::App const& app, CLI::App const& but, std::string const& option) {
  std::vector<std::string> names;
  for (CLI::App const* verb : app.get_subcommands({}))
    for (CLI::Option const* each : verb->get_options())
      if (verb != &but && !each->get_group().empty() && each->check_name(option)) names.push_back("sysid " + verb->get_name());
  return names;
}

/// The argument before these, if all of them joined by blanks are the path of something: a name that has blanks.
std::string path_with_blanks(CLI::App const& verb, std::vector<std::string> const& unread) {
  for (CLI::Option const* option : verb.get_options()) {
    if (!option->get_positional() || option->results().empty()) continue;
    std::string path = option->results().back();
    for (std::string const& word : unread) {
      path += " " + word;
      if (std::error_code ignored; std::filesystem::exists(path, ignored)) return path;
    }
  }
  return {};
}

constexpr std::string_view of_tasks =
    "a command runs all its tasks of the file, and `--resume` keeps those that are complete; tasks that are run alone have a file "
    "of "
    "their own";
constexpr std::string_view of_values = "a value is written in the file: `parameter m [kg] = 3`";
/// Verbs of other programs.
constexpr std::pair<std::string_view, std::string_view> other_verbs[] = {
    {"validate", "check"}, {"verify", "check"},     {"lint", "check"},   {"sample", "fit"},   {"infer", "fit"},
    {"estimate", "fit"},   {"identify", "fit"},     {"optimize", "fit"}, {"optimise", "fit"}, {"train", "fit"},
    {"sim", "simulate"},   {"forecast", "predict"}, {"shell", "repl"},   {"console", "repl"}, {"filter", "track"},
};
/// Options of other programs, and what there is in their place.
constexpr std::pair<std::string_view, std::string_view> other_options[] = {
    {"--json", "messages are written as JSON by `--error-format json`; the folder of a task has its results as JSON"},
    {"--plot", "figures of each task are written into its folder of results"},
    {"--only", of_tasks},
    {"--task", of_tasks},
    {"--tasks", of_tasks},
    {"--set", of_values},
    {"--param", of_values},
    {"--parameter", of_values},
    {"--params", of_values},
    {"--values", of_values},
    {"--fix", of_values},
};

/// Whether the command runs the tasks of a file.
bool runs_tasks(CLI::App const& verb) { return verb.get_name() == "run" || words::task_kind(verb.get_name()).has_value(); }

/// The option behind a dash of typesetting, `–force`; empty for other words.
std::string behind_dash(std::string const& word) {
  for (std::string_view const dash : {"\u2013", "\u2014", "\u2212"})
    if (word.starts_with(dash)) return word.substr(word.find_first_not_of('-', dash.size()));
  return {};
}

/// What to do about an argument that the command does not take.
std::string instead_of_argument(CLI::App const& verb, std::vector<std::string> const& unread, std::string const& see) {
  if (std::string const path = path_with_blanks(verb, unread); !path.empty())
    return fmt::format("write the name of a file with blanks in quotes: `\"{}\"`", path);
  if (std::string const option = behind_dash(unread.front()); !option.empty())
    return fmt::format("an option begins with two hyphens: `--{}`", option);
  if (runs_tasks(verb) && unread.front().find_first_of("=./") == std::string::npos) return std::string(of_tasks);
  if (unread.front().find('=') != std::string::npos) return "values of parameters and options of a task are written in its file";
  return see;
}

/// CLI11's words in our manner.
std::string reason(CLI::ParseError const& error) {
  std::string text = error.what();
  // It would name the type and its bounds in the place of the value.
  if (dynamic_cast<CLI::ArgumentMismatch const*>(&error) != nullptr && text.ends_with("missing"))
    return fmt::format("`{}` needs a value", text.substr(0, text.find(':')));
  if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0)
    text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

/// `sysid --seed 1 run FILE` and the like: an option that stands where a command should.
ExitCode no_verb_but_option(Messages const& messages, CLI::App const& app, std::string const& word) {
  std::vector<std::string> known;
  for (CLI::App const* verb : app.get_subcommands({}))
    for (std::string const& name : option_names(*verb))
      if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
  bool const exact = std::find(known.begin(), known.end(), word) != known.end();
  std::string const guess = exact ? std::string() : did_you_mean(word, known);
  std::string const order = "the command comes first, then its file and its options: `sysid run FILE";
  messages.complain(fmt::format("`{}` stands before a command{}", word, exact ? "" : ", and is no option of `sysid`"),
                    exact           ? fmt::format("{} {}`", order, word)
                    : guess.empty() ? order + "`"
                                    : fmt::format("{} {}`", guess, order));
  return ExitCode::usage;
}

ExitCode no_verb(Messages const& messages, CLI::App const& app) {
  if (auto const words = app.remaining(); !words.empty() && words.front().starts_with('-'))
    return no_verb_but_option(messages, app, words.front().substr(0, words.front().find('=')));
  for (std::string const& word : app.remaining()) {
    if (word.starts_with('-')) continue;
    std::string guess = did_you_mean(word, verb_names(app));
    for (auto const& [foreign, ours] : other_verbs)
      if (word == foreign) guess = fmt::format("did you mean `{}`?", ours);
    if (word.ends_with(".sysid")) guess = fmt::format("the command comes first: `sysid run {}`", word);
    messages.complain(
        fmt::format("there is no command `{}`", word),
        guess.empty() ? fmt::format("commands (`sysid --help` describes them): {}", fmt::join(verb_names(app), ", ")) : guess);
    return ExitCode::usage;
  }
  *messages.out << app.help();
  return ExitCode::usage;
}

}  // namespace

ExitCode misread(Messages const& messages, CLI::App const& app, CLI::ParseError const& error) {
  if (app.get_subcommands().empty()) return no_verb(messages, app);
  CLI::App const& verb = *app.get_subcommands().front();
  std::string const see = fmt::format("`sysid {} --help` lists its arguments and options", verb.get_name());
  std::vector<std::string> const unread = app.remaining(true);
  if (auto const before = app.remaining(false); !before.empty() && before.front() == "help") {
    messages.complain("there is no command `help`", fmt::format("write `sysid {} --help`", verb.get_name()));
    return ExitCode::usage;
  }
  // A misspelt option may be why something is missing.
  bool const missing = dynamic_cast<CLI::RequiredError const*>(&error) != nullptr;
  bool const unknown =
      dynamic_cast<CLI::ExtrasError const*>(&error) != nullptr || (missing && !unread.empty() && unread.front().starts_with("--"));
  if (!unknown || unread.empty()) {
    messages.complain(reason(error), see);
    return ExitCode::usage;
  }
  std::string const word = unread.front().substr(0, unread.front().find('='));
  if (!word.starts_with('-')) {
    messages.complain(fmt::format("`sysid {}` takes no argument `{}`", verb.get_name(), unread.front()),
                      instead_of_argument(verb, unread, see));
    return ExitCode::usage;
  }
  std::vector<std::string> const own = option_names(verb);
  if (std::find(own.begin(), own.end(), word) != own.end()) {
    CLI::Option const* option = verb.get_option_no_throw(word);
    if (option == nullptr) option = app.get_option_no_throw(word);
    bool const has_value = option != nullptr && option->get_items_expected_max() > 0;
    messages.complain(
        fmt::format("`{}` stands before the command", word),
        fmt::format("options follow the command: `sysid {} FILE {}{}`", verb.get_name(), word, has_value ? " VALUE" : ""));
    return ExitCode::usage;
  }
  for (auto const& [option, instead] : other_options)
    if (word == option) {
      messages.complain(fmt::format("`sysid {}` has no option `{}`", verb.get_name(), word), std::string(instead));
      return ExitCode::usage;
    }
  if (std::vector<std::string> const others = verbs_with(app, verb, word); !others.empty() && others.size() <= most_named) {
    messages.complain(fmt::format("`sysid {}` has no option `{}`", verb.get_name(), word),
                      fmt::format("it is an option of {}", quoted(others)));
    return ExitCode::usage;
  }
  constexpr std::string_view of_files[] = {"--with",    "--method", "--backend", "--sampler",
                                           "--samples", "--chains", "--solver",  "--model"};
  if (std::find(std::begin(of_files), std::end(of_files), word) != std::end(of_files)) {
    messages.complain(fmt::format("`sysid {}` has no option `{}`", verb.get_name(), word),
                      "what a task does is written in its file: `fit MODEL to DATA with mh(samples = 1000)`");
    return ExitCode::usage;
  }
  std::string const guess = did_you_mean(word, own);
  messages.complain(fmt::format("`sysid {}` has no option `{}`", verb.get_name(), word), guess.empty() ? see : guess);
  return ExitCode::usage;
}

}  // namespace sysid::cli
