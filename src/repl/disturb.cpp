// `disturb`: a fit once more, with a disturbance in its model, as statements of the session.
#include <fmt/format.h>

#include <algorithm>

#include "app/disturbed/fit_disturbed.hpp"
#include "repl/commands.hpp"
#include "repl/statements.hpp"
#include "repl/tasks.hpp"
#include "repl/words.hpp"
#include "syntax/entry.hpp"
#include "syntax/find_model.hpp"
#include "syntax/parse.hpp"

namespace sysid::repl {
namespace {

/// The statement of a fit with another name and model, searched anew.
std::string fit_of(std::string const& statement, std::string const& name, std::string const& model) {
  std::string text = statement;
  ast::Task const task = std::get<ast::Task>(item_of(statement));
  auto const replace = [&](Span place, std::string const& by) { text.replace(place.begin, place.end - place.begin, by); };
  for (auto option = task.options.rbegin(); option != task.options.rend(); ++option)
    if (option->key && option->key->text == "search") replace(option->value.span, "everywhere");
  replace(task.subject.span, model);
  if (task.name)
    replace(task.name->span, name);
  else
    text = name + " = " + text;
  return text;
}

/// Whether all stand in the text of this model, none in that of a part.
bool all_in(Source const& source, std::string const& model, std::vector<DisturbedEquation> const& equations) {
  Diagnostics ignored;
  auto const tree = parse(source, ignored);
  ast::Model const* const written = tree ? find_model(*tree, model) : nullptr;
  return written != nullptr && std::all_of(equations.begin(), equations.end(), [&](DisturbedEquation const& each) {
           return each.place.begin >= written->span.begin && each.place.end <= written->span.end;
         });
}

Task const& fit_in_text(CheckedText const& checked, std::string const& name) {
  auto const& tasks = checked.file.tasks;
  auto const task = std::find_if(tasks.begin(), tasks.end(), [&](Task const& each) { return each.name == name; });
  if (task == tasks.end()) throw InternalError("a fit that was run is not there");
  return *task;
}

}  // namespace

namespace command {

bool disturb(Context& context, std::string const& arguments) {
  std::vector<std::string> const fits = words_in(arguments);
  Workspace const& work = context.work.statements;
  if (fits.size() > 1) return context.output.refuse("`disturb` takes one fit", "`disturb`, `disturb FIT`");
  std::string const from = fits.empty() ? last_fit(context) : fits[0];
  if (from.empty()) return context.output.refuse("no fit has been run yet", "`fit1 = fit MODEL to DATA with map`");
  std::size_t const place = work.find(ItemKind::task, from);
  Result const* result = context.results.find(from);
  if (place == work.items.size() || result == nullptr || !context.results.fitted.contains(from))
    return context.output.refuse(fmt::format("`{}` is not a fit that has been run", from));
  std::string const statement = in_one_line(work.items[place].text);
  std::string const model = std::get<ast::Task>(item_of(statement)).subject.text;
  std::string const name = changed_name(from), changed_model = changed_name(model);
  std::filesystem::path const before = result->folder;
  auto const checked = context.work.checked;
  std::string text;
  std::vector<DisturbedEquation> equations;
  bool const found = context.output.guarded(checked->source, [&] {
    std::ostream nowhere(nullptr);
    Session session(checked->source, checked->file, context.options, context.progress, nowhere, nowhere);
    Task const& task = fit_in_text(*checked, from);
    session.find_results_in(before, task);
    DisturbanceFound const disturbance = find_disturbance(session, task);
    equations = disturbance.equations;
    if (all_in(checked->source, model, equations))
      text = model_with_disturbances(checked->source, model, changed_model, equations, disturbance.sizes);
    return true;
  });
  if (!found) return false;
  if (text.empty())
    return context.output.refuse(fmt::format("the equations of `{}` are written in its parts", model),
                                 "`save FILE`, then `sysid fit FILE --with-disturbance`");
  std::string const fit = fit_of(statement, name, changed_model);
  context.output.say(text + "\n" + fit);
  if (!enter_statements(context, text) || !enter_statements(context, fit)) return false;
  Result const* after = context.results.find(name);
  if (after == nullptr || context.results.interrupted.contains(name)) return true;
  return context.output.guarded(checked->source, [&] {
    std::ostream nowhere(nullptr);
    Session session(checked->source, checked->file, context.options, context.progress, nowhere, nowhere);
    Task const& task = fit_in_text(*checked, from);
    session.find_results_in(before, task);
    context.output.answer(disturbance_words(before, after->folder, equations, explained_shares(session, task, after->folder)));
    return true;
  });
}

}  // namespace command

}  // namespace sysid::repl
