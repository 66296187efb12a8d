// CLI11 reports what it could not read; we add similar names.
#include "cli/usage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace sysid::cli {
namespace {

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

ExitCode no_verb(Messages const& messages, CLI::App const& app) {
  for (std::string const& word : app.remaining()) {
    if (word.starts_with('-')) continue;
    std::string const guess = did_you_mean(word, verb_names(app));
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
  if (dynamic_cast<CLI::ExtrasError const*>(&error) == nullptr || unread.empty()) {
    messages.complain(reason(error), see);
    return ExitCode::usage;
  }
  std::string const word = unread.front().substr(0, unread.front().find('='));
  if (!word.starts_with('-')) {
    messages.complain(fmt::format("`sysid {}` takes no argument `{}`", verb.get_name(), word), see);
    return ExitCode::usage;
  }
  std::string const guess = did_you_mean(word, option_names(verb));
  messages.complain(fmt::format("`sysid {}` has no option `{}`", verb.get_name(), word), guess.empty() ? see : guess);
  return ExitCode::usage;
}

}  // namespace sysid::cli
