// manual: the pages of --help for `man`, from the same tables.
#include <fmt/format.h>

#include "cli/command.hpp"
#include "cli/described.hpp"
#include "core/system/files.hpp"

namespace sysid::cli {
namespace {

/// Text as troff prints it word for word.
std::string roff(std::string const& text) {
  std::string out;
  for (char const c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '`' || c == '\'')
      out += c == '`' ? "\\(ga" : "\\(aq";
    else
      out += c;
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string bold(std::string const& text) { return "\\fB" + roff(text) + "\\fR"; }
std::string italic(std::string const& text) { return "\\fI" + roff(text) + "\\fR"; }

std::string heading(std::string const& page, std::string const& name, std::string const& what) {
  return fmt::format(".TH \"{}\" 1 \"\" \"sysid {}\" \"sysid\"\n.SH NAME\n{} \\- {}\n", page, SYSID_VERSION, roff(name),
                     roff(what));
}

std::string option_rows(std::vector<DescribedOption> const& options, bool arguments) {
  std::string out;
  for (DescribedOption const& option : options) {
    if (option.is_argument() != arguments) continue;
    out += ".TP\n";
    if (!option.short_name.empty()) out += bold(option.short_name) + (option.long_name.empty() ? "" : ", ");
    if (!option.long_name.empty()) out += bold(option.long_name);
    if (!option.value.empty()) out += (arguments ? "" : " ") + italic(option.value);
    out += "\n" + roff(option.text) + "\n";
  }
  return out;
}

std::string examples(std::string const& commands) {
  if (commands.empty()) return "";
  std::string out = ".SH EXAMPLES\n.EX\n";
  for (std::string const& line : lines_of(commands)) out += roff(line) + "\n";
  return out + ".EE\n";
}

/// An exit code and when it is returned.
struct ExitRow {
  ExitCode code;
  char const* meaning;
};
constexpr ExitRow exits[] = {
    {ExitCode::success, "done; no check of the results fails, but there may be warnings"},
    {ExitCode::doubtful,
     "done, but a check fails; of fmt --check: a file is not in canonical layout; of export --stan: a fit is left out; of track: "
     "a parameter has changed"},
    {ExitCode::usage, "the command line is wrong"},
    {ExitCode::user_error, "something is wrong with the model, the data or the place for results"},
    {ExitCode::internal, "an error in sysid"},
    {ExitCode::io, "a file cannot be read or written, or memory or a library is missing"},
    {ExitCode::interrupted, "interrupted; commands that have --resume can continue the run"},
};

std::string exit_status() {
  std::string out = ".SH EXIT STATUS\n";
  for (ExitRow const& row : exits) out += fmt::format(".TP\n\\fB{}\\fR\n{}\n", static_cast<int>(row.code), roff(row.meaning));
  return out;
}

std::string manual_name(CLI::App const& verb) { return "sysid-" + verb.get_name(); }

std::string manual_of_program(CLI::App const& program) {
  std::string const summary = program.get_description();  // "sysid: Bayesian identification ..."
  std::string out = heading("SYSID", "sysid", summary.substr(summary.find(' ') + 1));
  out += ".SH SYNOPSIS\n" + bold("sysid") + " " + italic("COMMAND") + " [" + italic("OPTIONS") + "] ...\n.SH COMMANDS\n";
  std::string group;
  for (CLI::App const* verb : commands_of(program)) {
    if (verb->get_group() != group) out += ".SS " + roff(group = verb->get_group()) + "\n";
    out += ".TP\n" + bold(manual_name(*verb)) + "(1)\n" + roff(verb->get_description()) + "\n";
  }
  return out + ".SH OPTIONS\n" + option_rows(described_options(program), false) + exit_status() + examples(program.get_footer());
}

std::string manual_of(CLI::App const& verb) {
  std::string upper = manual_name(verb);
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::vector<DescribedOption> const options = described_options(verb);
  std::string const called = "sysid " + verb.get_name();
  std::string out = heading(upper, manual_name(verb), verb.get_description());
  out += ".SH SYNOPSIS\n" + bold(called) + roff(usage(verb).substr(called.size())) + " [" + italic("OPTIONS") + "]\n";
  if (std::string const arguments = option_rows(options, true); !arguments.empty()) out += ".SH ARGUMENTS\n" + arguments;
  return out + ".SH OPTIONS\n" + option_rows(options, false) + examples(verb.get_footer()) + ".SH SEE ALSO\n" + bold("sysid") +
         "(1)\n";
}

struct ManualOptions {
  std::string command;
  std::filesystem::path folder;
};

ExitCode write_pages(CLI::App const& program, std::filesystem::path const& folder) {
  make_folder(folder);
  write_file(folder / "sysid.1", manual_of_program(program));
  for (CLI::App const* verb : commands_of(program)) write_file(folder / (manual_name(*verb) + ".1"), manual_of(*verb));
  return ExitCode::success;
}

}  // namespace

Work declare_manual(CLI::App& verb) {
  auto const options = std::make_shared<ManualOptions>();
  verb.add_option("COMMAND", options->command, "a command of sysid; without it, the page of sysid itself is printed");
  verb.add_option("-o,--output", options->folder, "write the pages of all commands into this folder")
      ->type_name("FOLDER")
      ->check(refuse_no_path);
  return [options, &verb](Messages const& messages) {
    CLI::App const& program = *verb.get_parent();
    if (!options->folder.empty()) return write_pages(program, options->folder);
    if (options->command.empty()) {
      std::cout << manual_of_program(program);
      return ExitCode::success;
    }
    for (CLI::App const* each : commands_of(program))
      if (each->get_name() == options->command) {
        std::cout << manual_of(*each);
        return ExitCode::success;
      }
    messages.complain(fmt::format("there is no command `{}`", options->command), "`sysid --help` lists all commands");
    return ExitCode::usage;
  };
}

}  // namespace sysid::cli
