// `refit`: the statement of a fit that begins where another ended.
#include <fmt/format.h>

#include <set>

#include "core/text/words.hpp"
#include "repl/commands.hpp"
#include "repl/statements.hpp"
#include "repl/tasks.hpp"
#include "repl/words.hpp"
#include "syntax/entry.hpp"
#include "syntax/parse.hpp"

namespace sysid::repl {
namespace {

/// What is typed behind `refit`: [FIT] [as NAME] [with OPTIONS].
struct Typed {
  std::vector<std::string> fits;
  std::string name, options;
};

Typed typed_in(std::string const& arguments) {
  Typed out;
  std::string head = arguments;
  if (auto const at = (" " + arguments).find(" with "); at != std::string::npos) {
    head = arguments.substr(0, at);
    out.options = trimmed(arguments.substr(at + 5));
  }
  out.fits = words_in(head);
  if (out.fits.size() >= 2 && out.fits[out.fits.size() - 2] == "as") {
    out.name = out.fits.back();
    out.fits.resize(out.fits.size() - 2);
  }
  return out;
}

/// What was kept under a name of its own is meant as it is now.
std::string name_now(Workspace const& work, ItemKind kind, std::string const& item) {
  std::size_t const at = work.find(kind, item);
  return at < work.items.size() && !work.items[at].kept_of.empty() ? work.items[at].kept_of : item;
}

/// The text of a fit that is run, with its syntax tree.
struct WrittenFit {
  std::string text;
  ast::Task tree;

  explicit WrittenFit(std::string const& statement) : text(statement), tree(std::get<ast::Task>(item_of(statement))) {}
  std::string at(Span span) const { return text.substr(span.begin, span.end - span.begin); }
};

/// "NAME = fit MODEL(...) to DATA".
std::string fit_of(Workspace const& work, WrittenFit const& earlier, std::string const& name) {
  ast::Task const& task = earlier.tree;
  std::string statement = fmt::format("{} = fit {}", name, name_now(work, ItemKind::model, task.subject.text));
  for (std::size_t i = 0; i < task.arguments.size(); ++i) statement += (i == 0 ? "(" : ", ") + earlier.at(task.arguments[i].span);
  if (!task.arguments.empty()) statement += ")";
  for (std::size_t i = 0; i < task.data.size(); ++i)
    statement += fmt::format("{}{}{}", i == 0 ? " to " : ", ", name_now(work, ItemKind::data, task.data[i].data.text),
                             task.data[i].part ? "." + task.data[i].part->text : "");
  return statement;
}

/// What new options state, by the rules of the language; a mistake in them is told when the fit is entered.
struct Stated {
  std::set<std::string> keys;
  bool backend = false;

  explicit Stated(std::string const& options) {
    Diagnostics ignored;
    auto const given = parse(Source("", fmt::format("fit m to d with {}\n", options)), ignored);
    if (!given || given->items.size() != 1) return;
    auto const* task = std::get_if<ast::Task>(&given->items.front());
    if (task == nullptr) return;
    for (ast::Option const& option : task->options) {
      if (option.key) keys.insert(option.key->text);
      backend = backend || (!option.key && !option.input);
    }
  }
};

/// New options and those of the earlier fit that stay: the back end, where the simulation starts, how it is solved, the seed.
std::string merged_options(WrittenFit const& earlier, Stated const& stated, std::string const& options) {
  std::string kept;
  for (ast::Option const& option : earlier.tree.options) {
    bool const is_backend = !option.key && !option.input;
    bool const replaced = option.key && (option.key->text == "search" || stated.keys.contains(option.key->text));
    if (replaced || (is_backend && stated.backend)) continue;
    kept += (kept.empty() ? "" : ", ") + earlier.at(option.span);
  }
  // Without a back end of their own, new options follow the old one.
  return stated.backend ? options + (kept.empty() ? "" : ", ") + kept
                        : kept + (kept.empty() || options.empty() ? "" : ", ") + options;
}

}  // namespace

namespace command {

bool refit(Context& context, std::string const& arguments) {
  Typed const typed = typed_in(arguments);
  Workspace const& work = context.work.statements;
  if (typed.fits.size() > 1)
    return context.output.refuse("`refit` takes one fit", "`refit`, `refit FIT`, `refit FIT as NAME with mh(samples = 4000)`");
  std::string const from = typed.fits.empty() ? last_fit(context) : typed.fits[0];
  if (from.empty()) return context.output.refuse("no fit has been run yet", "`fit1 = fit MODEL to DATA with map`");
  std::size_t const place = work.find(ItemKind::task, from);
  if (place == work.items.size() || !context.results.fitted.contains(from))
    return context.output.refuse(fmt::format("`{}` is not a fit that has been run", from));
  WrittenFit const earlier(work.items[place].text);
  std::string const name = typed.name.empty() ? free_task_name(context, from) : typed.name;
  Stated const stated(typed.options);
  bool const near = !stated.keys.contains("search");
  if (near && name == from)
    return context.output.refuse(
        fmt::format("`{}` is the fit that the refit starts from and cannot be replaced by it", from),
        fmt::format("use another name, `refit as {}`, or search anew, `refit as {} with search = everywhere`",
                    free_task_name(context, from), from));
  std::string const options = merged_options(earlier, stated, typed.options);
  std::string statement = fit_of(work, earlier, name) + " with " + options;
  if (near) statement += fmt::format("{}search = near({})", options.empty() ? "" : ", ", from);
  context.output.say(statement);
  return enter_statements(context, statement);
}

}  // namespace command

}  // namespace sysid::repl
