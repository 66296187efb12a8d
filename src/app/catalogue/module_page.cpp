// Writes the page of a module from its text and syntax tree.
#include "app/catalogue/module_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

// "# text" to "text"; nothing for a line that is no comment.
std::optional<std::string_view> comment(std::string_view line) {
  if (!line.starts_with('#')) return std::nullopt;
  line.remove_prefix(1);
  if (line.starts_with(' ')) line.remove_prefix(1);
  return line;
}

std::string joined(std::vector<std::string_view> const& lines) {
  std::string text;
  for (std::string_view const line : lines) text += fmt::format("{}\n", line);
  return text;
}

// The comment that begins the file, up to the first empty line.
std::vector<std::string_view> head(Source const& source) {
  std::vector<std::string_view> lines;
  for (int number = 1; auto const text = comment(source.line(number)); ++number) lines.push_back(*text);
  return lines;
}

// The comment directly above a model.
std::string comment_above(Source const& source, ast::Model const& model) {
  std::vector<std::string_view> lines;
  for (int number = source.place(model.span.begin).line - 1; number > 0; --number) {
    auto const text = comment(source.line(number));
    if (!text) break;
    lines.insert(lines.begin(), *text);
  }
  return joined(lines);
}

std::string signature(ast::Model const& model) {
  std::string text;
  for (ast::ModelArgument const& argument : model.arguments)
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", argument.name.text,
                        argument.value ? " = " + unparse(*argument.value) : std::string());
  return text.empty() ? model.name.text : fmt::format("{}({})", model.name.text, text);
}

struct Row {
  std::string name, kind, unit, value;
};
std::vector<Row> rows_of(ast::Model const& model) {
  std::vector<Row> rows;
  auto const add = [&](ast::Declared const& declared, std::string kind, std::string value = {}) {
    std::string sizes;
    for (ast::Expression const& size : declared.sizes) sizes += (sizes.empty() ? "" : ", ") + unparse(size);
    rows.push_back({declared.name.text + (sizes.empty() ? "" : "(" + sizes + ")"), std::move(kind),
                    declared.unit ? unparse(*declared.unit) : std::string(), std::move(value)});
  };
  for (ast::ModelStatement const& statement : model.statements) {
    if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
      for (ast::Declared const& input : inputs->names) add(input, "input");
    } else if (auto const* states = std::get_if<ast::StateDeclaration>(&statement)) {
      for (ast::Declared const& state : states->names) add(state, "state");
    } else if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) {
      add(parameter->name, "parameter",
          parameter->prior ? "~ " + unparse(ast::Expression{{}, ast::Box<ast::Call>(*parameter->prior)})
                           : "= " + unparse(*parameter->value));
    } else if (auto const* disturbance = std::get_if<ast::DisturbanceDeclaration>(&statement)) {
      add(disturbance->name, "disturbance", "~ " + unparse(ast::Expression{{}, ast::Box<ast::Call>(disturbance->law)}));
    } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
      if (definition->kind == ast::DefinitionKind::derived) add(definition->name, "derived");
    } else if (auto const* observation = std::get_if<ast::Observation>(&statement)) {
      add(observation->channel, "channel");
    }
  }
  return rows;
}

// A file that uses the model: as a part of an oscillator when it gives a force, else fitted as it stands.
std::string example(LibraryModule const& module, ast::Model const& model, std::vector<Row> const& rows) {
  auto const count = [&](std::string_view kind) {
    return std::count_if(rows.begin(), rows.end(), [&](Row const& row) { return row.kind == kind; });
  };
  std::string text = fmt::format("use {}\n\n", module.name);
  if (count("channel") == 0) {
    std::string bound;
    for (Row const& row : rows)
      if (row.kind == "input")
        bound += fmt::format("{}{} = {}", bound.empty() ? "" : ", ", row.name, row.name == "velocity" ? "y'" : "y");
    return text +
           fmt::format(
               "model rig {{\n  input x [N]\n  state y [m]\n  initial y = 0, y' = 0\n  part element = {}({})\n"
               "  2 [kg]*y'' + 10 [N s/m]*y' + 500 [N/m]*y + element.force = x\n  observe position ~ normal(y, sd = 1 [mm])\n}}\n",
               model.name.text, bound);
  }
  text += "data record {\n  file \"record.csv\"\n  time t [s]\n";
  for (Row const& row : rows) {
    std::string const unit = row.unit.empty() ? "" : " [" + row.unit + "]";
    if (row.kind == "input") text += fmt::format("  input {} = {}{} hold linear\n", row.name, row.name, unit);
    if (row.kind != "channel") continue;
    std::string const channel = row.name.substr(0, row.name.find('('));
    bool const several = channel.size() < row.name.size();
    text += fmt::format("  measure {}{} = {}{}\n", channel, several ? "[1]" : "", several ? channel + "_1" : channel, unit);
  }
  return text + fmt::format("}}\n\nposterior = fit {} to record with mh\n", model.name.text);
}

}  // namespace

std::string module_summary(LibraryModule const& module) {
  Source const source(std::string(module.name), std::string(module.text));
  return std::string(comment(source.line(1)).value_or(""));
}

std::optional<std::string> module_page(std::string_view name) {
  auto const module = std::find_if(library_modules().begin(), library_modules().end(),
                                   [&](LibraryModule const& each) { return each.name == name; });
  if (module == library_modules().end()) return std::nullopt;
  Source const source(std::string(name), std::string(module->text));
  Diagnostics diagnostics;
  auto const tree = parse(source, diagnostics);
  if (!tree) throw InternalError("a module of the standard library does not parse:\n" + render(diagnostics, source));
  std::string page = fmt::format("# {}\n\nMade from [stdlib/{}.sysid](../../stdlib/{}.sysid) by `./sysid document {}`.\n\n{}", name,
                                 name, name, name, joined(head(source)));
  for (ast::Item const& item : tree->items) {
    auto const* model = std::get_if<ast::Model>(&item);
    if (model == nullptr) continue;
    auto const rows = rows_of(*model);
    page += fmt::format("\n## {}\n\n{}\n", signature(*model), comment_above(source, *model));
    page += "| name | what | unit | prior or value |\n|---|---|---|---|\n";
    for (Row const& row : rows) {
      std::string const unit = row.unit.empty() ? "" : "`" + row.unit + "`", value = row.value.empty() ? "" : "`" + row.value + "`";
      page += fmt::format("| `{}` | {} | {} | {} |\n", row.name, row.kind, unit, value);
    }
    page += fmt::format("\n```sysid file\n{}\n```\n\nIn use:\n\n```sysid file\n{}```\n", source.text(model->span),
                        example(*module, *model, rows));
  }
  return page;
}

}  // namespace sysid
