// The one place that turns what is thrown into messages and exit codes.
#include "cli/messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <new>

#include "core/system/colour.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/wrapped.hpp"
#include "experiment/experiments.hpp"
#include "syntax/parse.hpp"

namespace sysid::cli {
void Messages::show(Diagnostics const& diagnostics, Source const& source) const {
  if (json)
    *out << render_json(diagnostics, source);
  else
    *out << wrapped(render(diagnostics, source, coloured_messages()), terminal_columns(STDERR_FILENO)) << std::flush;
}

void Messages::complain(std::string message, std::string help) const {
  Diagnostics diagnostics;
  diagnostics.add({Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)});
  show(diagnostics, Source("sysid", ""));
}

ExitCode guarded(Messages const& messages, Source const& source, std::function<ExitCode()> const& work) {
  try {
    return work();
  } catch (UnusableData const& error) {
    messages.show(error.diagnostics(), source);
    return ExitCode::user_error;
  } catch (UserError const& error) {
    Diagnostics diagnostics;
    diagnostics.add(error.diagnostic());
    messages.show(diagnostics, source);
    return ExitCode::user_error;
  } catch (UnreadableData const& error) {
    messages.show(error.diagnostics(), source);
    return ExitCode::io;
  } catch (IoError const& error) {
    messages.complain(error.what(), error.help());
    return ExitCode::io;
  } catch (std::filesystem::filesystem_error const& error) {
    messages.complain(path_error(error).what(), path_error(error).help());
    return ExitCode::io;
  } catch (Interrupted const&) {
    return ExitCode::interrupted;
  } catch (std::bad_alloc const&) {
    messages.complain("out of memory", "use a shorter record, fewer draws or fewer threads, or a machine with more memory");
    return ExitCode::io;
  } catch (std::exception const& error) {
    messages.complain(fmt::format("this is an error in sysid, not in your file: {}", error.what()),
                      "please report it with the file that causes it");
    return ExitCode::internal;
  }
}

Source read_source(std::string const& path) { return Source(path, read_file(path, most_text_bytes + 1)); }

ExitCode with_checked_file(Messages const& messages, std::string const& path,
                           std::function<ExitCode(Source const&, CheckedFile const&, Diagnostics const& said)> const& work) {
  return guarded(messages, Source(path, ""), [&] {
    Source source = read_source(path);
    return guarded(messages, source, [&] {
      Diagnostics diagnostics;
      auto const file = load(source, diagnostics);
      messages.show(diagnostics, source);
      return file ? work(source, *file, diagnostics) : ExitCode::user_error;
    });
  });
}

}  // namespace sysid::cli
