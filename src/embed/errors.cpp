// Each kind of failure of the engine, with what there is to say about it.
#include "embed/errors.hpp"

#include <filesystem>
#include <new>

#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "experiment/experiments.hpp"

namespace sysid::embed {
namespace {

Diagnostics alone(Diagnostic diagnostic) {
  Diagnostics diagnostics;
  diagnostics.add(std::move(diagnostic));
  return diagnostics;
}

/// About no place in a text.
Diagnostics alone(std::string message, std::string help) {
  return alone(Diagnostic{Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)});
}

std::string without_line_end(std::string text) {
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace

Raised::Raised(Diagnostics const& diagnostics, Source const& source)
    : text_(without_line_end(render(diagnostics, source))), json_(render_json(diagnostics, source)) {}

void raise_caught(Source const& source) {
  try {
    throw;
  } catch (Raised const&) {
    throw;
  } catch (UnusableData const& error) {
    throw Raised(error.diagnostics(), source);
  } catch (UnreadableData const& error) {
    throw Raised(error.diagnostics(), source);
  } catch (UserError const& error) {
    throw Raised(alone(error.diagnostic()), source);
  } catch (IoError const& error) {
    throw Raised(alone(error.what(), error.help()), source);
  } catch (std::filesystem::filesystem_error const& error) {
    throw Raised(alone(path_error(error).what(), path_error(error).help()), source);
  } catch (Interrupted const&) {
    throw;
  } catch (std::bad_alloc const&) {
    throw;
  } catch (std::exception const& error) {
    throw Raised(alone(std::string("this is an error in sysid, not in your file: ") + error.what(),
                       "please report it with the file that causes it"),
                 source);
  }
}

}  // namespace sysid::embed
