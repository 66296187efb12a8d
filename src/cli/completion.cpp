// completion: scripts by which bash, zsh and fish complete commands, options and their values, made from the commands' own tables.
#include <fmt/format.h>

#include "app/catalogue/explain.hpp"
#include "cli/command.hpp"
#include "cli/described.hpp"
#include "load/modules.hpp"

namespace sysid::cli {
namespace {

/// What a shell offers for a value, by the one word that stands for it.
enum class Offer { nothing, choices, models, tables, folders, files };

struct OfferRow {
  char const* value;
  Offer offer;
};
constexpr OfferRow offers[] = {
    {"FOLDER", Offer::folders}, {"RESULT", Offer::folders}, {"FILE", Offer::models},
    {"CSV", Offer::tables},     {"WHAT", Offer::files},     {"RESULTS", Offer::files},
};

Offer offer_of(DescribedOption const& option) {
  if (!option.choices.empty()) return Offer::choices;
  for (OfferRow const& row : offers)
    if (option.value == row.value) return row.offer;
  return Offer::nothing;
}

std::string words(std::vector<std::string> const& all) { return fmt::format("{}", fmt::join(all, " ")); }

std::vector<std::string> command_names(CLI::App const& program) {
  std::vector<std::string> names;
  for (CLI::App const* verb : commands_of(program)) names.push_back(verb->get_name());
  return names;
}

/// The options of a command with all choices that its checks do not know: those are tables of the program.
std::vector<DescribedOption> completed_options(CLI::App const& app) {
  std::vector<DescribedOption> options = described_options(app);
  for (DescribedOption& option : options) {
    if (option.value == "CODE") option.choices = codes();
    if (option.value == "COMMAND") option.choices = command_names(*app.get_parent());
    if (option.value == "MODULE")
      for (LibraryModule const& module : library_modules()) option.choices.emplace_back(module.name);
  }
  return options;
}

// ---- bash

std::string bash_offer(DescribedOption const& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return fmt::format("_sysid_words '{}'", words(option.choices));
    case Offer::models:
      return "_sysid_files sysid";
    case Offer::tables:
      return "_sysid_files csv";
    case Offer::folders:
      return "_sysid_folders";
    case Offer::files:
      return "_sysid_files";
    case Offer::nothing:
      break;
  }
  return ":";
}

std::string bash_command(std::string const& pattern, std::vector<DescribedOption> const& options, std::string const& otherwise) {
  std::string cases, arguments = otherwise;
  std::vector<std::string> names;
  for (DescribedOption const& option : options) {
    if (option.is_argument()) {
      arguments = bash_offer(option);
      continue;
    }
    for (std::string const& name : {option.short_name, option.long_name})
      if (!name.empty()) names.push_back(name);
    if (!option.value.empty()) cases += fmt::format("        {}) {}; return ;;\n", option.names("|"), bash_offer(option));
  }
  return fmt::format("    {})\n{}      if [[ $word == -* ]]; then _sysid_words '{}'; else {}; fi ;;\n", pattern,
                     cases.empty() ? "" : fmt::format("      case $before in\n{}      esac\n", cases), words(names), arguments);
}

constexpr char const* bash_functions = R"(# Completion of sysid for bash; made by `sysid completion bash`.
_sysid_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_sysid_folders() { compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$word"); }
# Folders, and files with an ending, if one is given.
_sysid_files() {
  _sysid_folders
  local more each
  mapfile -t more < <(compgen -f ${1:+-X "!*.$1"} -- "$word")
  for each in "${more[@]}"; do [[ -d $each ]] || COMPREPLY+=("$each"); done
}
_sysid() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case ${COMP_WORDS[i]} in
)";

std::string bash(CLI::App const& program) {
  std::vector<std::string> const names = command_names(program);
  std::string out = bash_functions;
  out +=
      fmt::format("      {}) command=${{COMP_WORDS[i]}}; break ;;\n    esac\n  done\n  case $command in\n", fmt::join(names, "|"));
  out += bash_command("''", completed_options(program), fmt::format("_sysid_words '{}'", words(names)));
  for (CLI::App const* verb : commands_of(program)) out += bash_command(verb->get_name(), completed_options(*verb), ":");
  return out + "  esac\n}\ncomplete -F _sysid sysid\n";
}

// ---- zsh

/// In the description of `_arguments`, between brackets and single quotes.
std::string zsh_text(std::string const& text) {
  std::string out;
  for (char const c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return out;
}

std::string zsh_action(DescribedOption const& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return fmt::format("({})", words(option.choices));
    case Offer::models:
      return "_files -g \"*.sysid\"";
    case Offer::tables:
      return "_files -g \"*.csv\"";
    case Offer::folders:
      return "_files -/";
    case Offer::files:
      return "_files";
    case Offer::nothing:
      break;
  }
  return " ";
}

std::string zsh_specifications(std::vector<DescribedOption> const& options, std::string const& indent) {
  std::string out;
  for (DescribedOption const& option : options) {
    std::string const value = option.value.empty() ? "" : fmt::format(":{}:{}", option.value, zsh_action(option));
    if (option.is_argument())
      out += fmt::format(" \\\n{}'{}{}'", indent, option.many ? "*" : option.required ? "" : ":", value);
    else if (!option.short_name.empty() && !option.long_name.empty())
      out += fmt::format(" \\\n{}'({})'{{{}}}'[{}]{}'", indent, option.names(" "), option.names(","), zsh_text(option.text), value);
    else
      out += fmt::format(" \\\n{}'{}[{}]{}'", indent, option.names(), zsh_text(option.text), value);
  }
  return out;
}

std::string zsh(CLI::App const& program) {
  std::string out =
      "#compdef sysid\n# Completion of sysid for zsh; made by `sysid completion zsh`.\n_sysid() {\n"
      "  local curcontext=$curcontext state line\n  typeset -A opt_args\n  local -a commands=(\n";
  for (CLI::App const* verb : commands_of(program))
    out += fmt::format("    '{}:{}'\n", verb->get_name(), zsh_text(verb->get_description()));
  out += "  )\n  _arguments -C" + zsh_specifications(completed_options(program), "    ") +
         " \\\n    '1:command:->command' \\\n    '*::argument:->argument'\n"
         "  case $state in\n    command) _describe command commands ;;\n    argument)\n      case $words[1] in\n";
  for (CLI::App const* verb : commands_of(program))
    out +=
        fmt::format("        {}) _arguments{} ;;\n", verb->get_name(), zsh_specifications(completed_options(*verb), "          "));
  return out + "      esac ;;\n  esac\n}\nif [[ $funcstack[1] == _sysid ]]; then _sysid \"$@\"; else compdef _sysid sysid; fi\n";
}

// ---- fish

std::string fish_quoted(std::string const& text) {
  std::string out = "'";
  for (char const c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string fish_values(DescribedOption const& option) {
  switch (offer_of(option)) {
    case Offer::choices:
      return words(option.choices);
    case Offer::models:
      return "(__fish_complete_suffix .sysid)";
    case Offer::tables:
      return "(__fish_complete_suffix .csv)";
    case Offer::folders:
      return "(__fish_complete_directories)";
    case Offer::files:
      return "(__fish_complete_path)";
    case Offer::nothing:
      break;
  }
  return "";
}

/// condition: of fish, under which the options hold.
std::string fish_options(std::vector<DescribedOption> const& options, std::string const& condition) {
  std::string out;
  for (DescribedOption const& option : options) {
    std::string line = "complete -c sysid" + condition;
    if (option.is_argument()) {
      if (std::string const values = fish_values(option); !values.empty()) out += line + " -a " + fish_quoted(values) + "\n";
      continue;
    }
    if (!option.short_name.empty()) line += " -s " + option.short_name.substr(1);
    if (!option.long_name.empty()) line += " -l " + option.long_name.substr(2);
    if (!option.value.empty()) line += " -x";
    if (std::string const values = fish_values(option); !values.empty() && !option.value.empty())
      line += " -a " + fish_quoted(values);
    out += line + " -d " + fish_quoted(option.text) + "\n";
  }
  return out;
}

std::string fish(CLI::App const& program) {
  std::string const none = " -n '__fish_use_subcommand'";
  std::string out = "# Completion of sysid for fish; made by `sysid completion fish`.\ncomplete -c sysid -f\n";
  for (CLI::App const* verb : commands_of(program))
    out += fmt::format("complete -c sysid{} -a {} -d {}\n", none, verb->get_name(), fish_quoted(verb->get_description()));
  out += fish_options(completed_options(program), none);
  for (CLI::App const* verb : commands_of(program))
    out += fish_options(completed_options(*verb), fmt::format(" -n '__fish_seen_subcommand_from {}'", verb->get_name()));
  return out;
}

struct ShellRow {
  char const* name;
  std::string (*script)(CLI::App const& program);
};
constexpr ShellRow shells[] = {{"bash", &bash}, {"zsh", &zsh}, {"fish", &fish}};

}  // namespace

Work declare_completion(CLI::App& verb) {
  auto const shell = std::make_shared<std::string>();
  std::vector<std::string> names;
  for (ShellRow const& row : shells) names.emplace_back(row.name);
  verb.add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember(names));
  return [shell, &verb](Messages const&) {
    for (ShellRow const& row : shells)
      if (*shell == row.name) std::cout << row.script(*verb.get_parent());
    return ExitCode::success;
  };
}

}  // namespace sysid::cli
