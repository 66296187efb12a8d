// fmt: texts in canonical layout.
#include "syntax/format.hpp"

#include <algorithm>
#include <iterator>

#include "cli/command.hpp"
#include "core/system/files.hpp"

namespace sysid::cli {
namespace {

struct FormatOptions {
  std::vector<std::string> files;
  bool only_check = false;
};

std::string read_standard_input() { return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()}; }

/// Says that the layout differs, or writes the text in its place.
ExitCode deliver(std::string const& path, Source const& source, std::string const& text, bool only_check) {
  bool const same = text == source.text();
  if (only_check) {
    if (!same) std::cout << source.name() << ": not in canonical layout\n";
    return same ? ExitCode::success : ExitCode::doubtful;
  }
  if (path == "-") {
    std::cout << text;
  } else if (!same) {
    write_file(path, text);
    std::cout << path << ": rewritten\n";
  }
  return ExitCode::success;
}

ExitCode format_one(Messages const& messages, std::string const& path, bool only_check) {
  return guarded(messages, Source(path, ""), [&] {
    Source const source = path == "-" ? Source("standard input", read_standard_input()) : read_source(path);
    Diagnostics diagnostics;
    auto const text = formatted(source, diagnostics);
    messages.show(diagnostics, source);
    return text ? deliver(path, source, *text, only_check) : ExitCode::user_error;
  });
}

}  // namespace

Work declare_format(CLI::App& verb) {
  auto const options = std::make_shared<FormatOptions>();
  verb.add_option("FILE", options->files, "the .sysid files, or `-` for standard input and output")->required();
  verb.add_flag("--check", options->only_check, "change nothing; list the files that would change and exit with 1");
  return [options](Messages const& messages) {
    ExitCode worst = ExitCode::success;  // every file is looked at
    for (std::string const& path : options->files) worst = std::max(worst, format_one(messages, path, options->only_check));
    return worst;
  };
}

}  // namespace sysid::cli
