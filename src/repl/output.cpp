// Answers and messages, in the words of the prompt.
#include "repl/output.hpp"

#include <fmt/format.h>

#include <new>

#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/wrapped.hpp"
#include "experiment/experiments.hpp"

namespace sysid::repl {

void Output::say(std::string const& line) { voices_.messages << line << '\n' << std::flush; }

void Output::answer(std::string const& text) { voices_.answers << wrapped(text, voices_.columns()) << std::flush; }

bool Output::refuse(std::string const& message, std::string const& help) {
  say(fmt::format("{}{}{}", message, help.empty() ? "" : "\nhelp: ", help));
  return false;
}

void Output::show(Diagnostics const& diagnostics, std::string const& entry) {
  voices_.messages << render(diagnostics, Source("prompt", entry), voices_.colour, Surface::prompt) << std::flush;
}

void Output::show(Diagnostics const& diagnostics, Source const& source) {
  voices_.messages << render(diagnostics, source, voices_.colour, Surface::prompt) << std::flush;
}

void Output::show(Diagnostics const& diagnostics, Source const& source, Workspace const& work, std::string const& entry) {
  Source shown("prompt", entry);
  auto const shift = shown.next_begin();
  for (int file = 0; file < source.files(); ++file) shown.include(source.name(file), std::string(source.text(file)));
  auto const place = [&](Span span) {
    for (std::size_t i = 0; i < work.items.size(); ++i) {
      std::uint32_t const begin = work.begin(i);
      for (TypedPart const& part : work.items[i].typed)
        if (span.begin >= begin + part.in_text.begin && span.end <= begin + part.in_text.end) {
          std::uint32_t const from = part.in_typed - (begin + part.in_text.begin);  // may wrap around, and back
          return Span{span.begin + from, span.end + from};
        }
    }
    return Span{span.begin + shift, span.end + shift};
  };
  auto const item_of = [&](Diagnostic const& each) {
    for (std::size_t i = 0; each.primary && i < work.items.size(); ++i)
      if (each.primary->span.begin >= work.begin(i) && each.primary->span.begin < work.begin(i) + work.items[i].text.size())
        return title_of(work.items[i].kind, work.items[i].name);
    return std::string();
  };
  Diagnostics mapped;
  for (Diagnostic each : diagnostics.all()) {
    if (each.severity != Severity::error && !is_new(each, item_of(each))) continue;
    if (each.primary) each.primary->span = place(each.primary->span);
    for (Label& label : each.secondary) label.span = place(label.span);
    mapped.add(std::move(each));
  }
  show(mapped, shown);
}

bool Output::is_new(Diagnostic const& warning, std::string_view item) {
  std::vector<std::string> matter{warning.code, std::string(item), warning.kind, warning.function};
  matter.insert(matter.end(), warning.names.begin(), warning.names.end());
  return warned_.insert(std::move(matter)).second;
}

bool Output::guarded(Source const& source, std::function<bool()> const& act) {
  auto const told = [&](Diagnostics const& diagnostics) {
    show(diagnostics, source);
    return false;
  };
  try {
    return act();
  } catch (UnusableData const& error) {
    return told(error.diagnostics());
  } catch (UserError const& error) {
    Diagnostics one;
    one.add(error.diagnostic());
    return told(one);
  } catch (UnreadableData const& error) {
    return told(error.diagnostics());
  } catch (IoError const& error) {
    return refuse(error.what(), error.help());
  } catch (Interrupted const&) {
    return refuse("interrupted");
  } catch (std::filesystem::filesystem_error const& error) {
    return refuse(path_error(error).what(), path_error(error).help());
  } catch (std::bad_alloc const&) {
    return refuse("out of memory");
  } catch (std::exception const& error) {
    return refuse(fmt::format("this is an error in sysid, not in your file: {}", error.what()),
                  "please `save` the session and report it with that file");
  }
}

}  // namespace sysid::repl
