// The front end as a server uses it: nothing throws, everything is a value.
#include "assist/analysis.hpp"

#include <sstream>

#include "app/session/preconditions.hpp"
#include "app/session/session.hpp"
#include "assist/resolve.hpp"
#include "grammar/message/layout.hpp"
#include "load/load.hpp"
#include "syntax/parse.hpp"

namespace sysid::assist {
namespace {

/// The text with what it takes to close its last block.
std::string closed(std::string const& text) {
  int open = 0;
  for (grammar::Token const& token : grammar::scan(text).tokens) open += token.is("{") ? 1 : token.is("}") ? -1 : 0;
  return open > 0 ? text + "\n" + std::string(static_cast<std::size_t>(open), '}') : text;
}

void add(Diagnostics& all, Diagnostics const& more) {
  for (Diagnostic const& each : more.all()) all.add(each);
}

Diagnostic unplaced(std::string message, std::string help) {
  return {Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)};
}

}  // namespace

std::shared_ptr<Reading const> read(std::string const& path, std::string const& text, UnsavedText const& unsaved) {
  Diagnostics unsaid;
  for (std::string const& as_read : {text, closed(text)}) {
    Source source(path, as_read);
    ReadableFile readable = parse_readable(source, unsaid);
    if (!readable.tree) continue;
    auto reading = std::make_shared<Reading>(Reading{std::move(source), std::move(*readable.tree), {}, {}, unsaid.all().empty()});
    try {
      reading->modules = load_modules(reading->tree, reading->source, unsaid, unsaved);
    } catch (IoError const&) {  // said by `analyse`
    }
    reading->names = resolve(reading->tree, reading->modules);
    return reading;
  }
  return nullptr;
}

Analysis analyse(std::string const& path, std::string const& text, UnsavedText const& unsaved) {
  Analysis result{Source(path, text), {}};
  try {
    auto const file = load(result.source, result.diagnostics, unsaved);
    if (!file) return result;
    RunOptions const options;
    SilentProgress silent;
    std::ostream nowhere(nullptr);
    Session session(result.source, *file, options, silent, nowhere, nowhere);
    add(result.diagnostics, check_preconditions(session).diagnostics);
  } catch (UnusableData const& error) {
    add(result.diagnostics, error.diagnostics());
  } catch (UnreadableData const& error) {
    add(result.diagnostics, error.diagnostics());
  } catch (UserError const& error) {
    result.diagnostics.add(error.diagnostic());
  } catch (IoError const& error) {
    result.diagnostics.add(unplaced(error.what(), error.help()));
  } catch (std::exception const& error) {
    result.diagnostics.add(unplaced(std::string("this is an error in sysid, not in your file: ") + error.what(),
                                    "please report it with the file that causes it"));
  }
  return result;
}

}  // namespace sysid::assist
