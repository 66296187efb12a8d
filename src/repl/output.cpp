// Answers and messages, in the words of the prompt.
#include "repl/output.hpp"

#include <fmt/format.h>

#include <new>

#include "core/system/files.hpp"
#include "core/text/wrapped.hpp"
#include "data/table.hpp"
#include "experiment/experiments.hpp"

namespace sysid::repl {
namespace {

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
}

}  // namespace

std::string at_the_prompt(std::string text) {
  replace_all(text, "sysid explain CODE, for each word in brackets", "`help WORD`, for each word in brackets");
  replace_all(text, "sysid explain ", "help ");
  replace_all(text, "`sysid list ", "`list ");
  replace_all(text, "continue with --resume", "continue with `resume`");
  replace_all(text, "--resume continues from there", "`resume` continues from there");
  replace_all(text, "run the task again with --force", "give the task another name, or start the prompt with --force");
  replace_all(text, "--resume starts it again", "`resume` starts it again");
  replace_all(text, "add --force to replace them, or -o DIR to write elsewhere",
              "give the task another name, or start the prompt with --force or another -o");
  replace_all(text, "continue with `resume`, or start again with --force",
              "give the task another name, or start the prompt with --force or another -o");
  return text;
}

void Output::say(std::string const& line) { voices_.messages << line << '\n' << std::flush; }

void Output::answer(std::string const& text) { voices_.answers << wrapped(text, voices_.columns()) << std::flush; }

bool Output::refuse(std::string const& message, std::string const& help) {
  say(fmt::format("{}{}{}", message, help.empty() ? "" : "\nhelp: ", help));
  return false;
}

void Output::show(Diagnostics const& diagnostics, std::string const& entry) {
  voices_.messages << at_the_prompt(render(diagnostics, Source("prompt", entry), voices_.colour)) << std::flush;
}

void Output::show(Diagnostics const& diagnostics, Source const& source) {
  voices_.messages << at_the_prompt(render(diagnostics, source, voices_.colour)) << std::flush;
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
  Diagnostics mapped;
  for (Diagnostic each : diagnostics.all()) {
    if (each.severity != Severity::error && !is_new(each)) continue;
    if (each.primary) each.primary->span = place(each.primary->span);
    for (Label& label : each.secondary) label.span = place(label.span);
    mapped.add(std::move(each));
  }
  show(mapped, shown);
}

bool Output::is_new(Diagnostic const& warning) { return warned_.insert(warning.code + warning.message).second; }

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
  } catch (std::bad_alloc const&) {
    return refuse("out of memory");
  } catch (std::exception const& error) {
    return refuse(fmt::format("this is an error in sysid, not in your file: {}", error.what()),
                  "please `save` the work and report it with that file");
  }
}

}  // namespace sysid::repl
