// Wrong units planted in every shipped model, one at a time: each must be found, at the right place. What a mutant does to the text
// is known; which mutants are no mistake at all (the sign of a quantity has no unit to get wrong) is told by where they stand.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "checking.hpp"
#include "syntax/parse.hpp"
#include "syntax/walk.hpp"

using namespace sysid;
using namespace sysid::test;

namespace {

// A unit that no shipped model uses, so that no mutant is right by accident.
std::string const strange = "[cd]";

struct Mutant {
  std::string what;
  Span place;        // in the original text, replaced by
  std::string text;  // this
  Span term;         // the addend, argument or value that holds the place; of a declaration the declaration
  std::string
      name;  // of a declared unit: the quantity, whose every term is a right place; or of the definition that holds the place
  std::string harmless;  // why it is no mistake; empty: it is one
};

bool inside(Span inner, Span outer) { return outer.begin <= inner.begin && inner.end <= outer.end; }

struct Planter {
  std::string_view text;
  std::set<std::string> pure;  // quantities declared to be pure numbers
  std::vector<Mutant> mutants;

  std::string at(Span span) const { return std::string(text.substr(span.begin, span.end - span.begin)); }

  // Where the unit of an expression is asked for.
  struct Context {
    Span term;
    std::string name;      // of the definition it belongs to, when that has no unit of its own
    std::string harmless;  // it is asked for nowhere
  };

  void add(std::string what, Span place, std::string replacement, Context const& context) {
    mutants.push_back({std::move(what), place, std::move(replacement), context.term, context.name, context.harmless});
  }

  static bool is_bare(ast::Expression const& tree) {
    bool bare = true;
    each_expression(tree, [&](ast::Expression const& part) {
      if (auto const* number = std::get_if<ast::Number>(&part.node)) bare = bare && !number->unit;
      if (auto const* name = std::get_if<ast::Reference>(&part.node)) bare = bare && name->name.text == "pi";
    });
    return bare;
  }

  // A factor without which the units are as before.
  bool is_pure(ast::Expression const& tree) const {
    if (auto const* number = std::get_if<ast::Number>(&tree.node)) return !number->unit;
    if (auto const* reference = std::get_if<ast::Reference>(&tree.node))
      return reference->primes == 0 && (reference->name.text == "pi" || pure.contains(reference->name.text));
    if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return is_pure(*(*unary)->operand);
    if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node))
      return is_pure(*(*binary)->left) && is_pure(*(*binary)->right);
    if (auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) {
      static std::set<std::string> const to_pure{"exp", "log", "sin", "cos", "tan", "tanh", "sign", "step"};
      return to_pure.contains((*call)->function.text) ||
             std::all_of((*call)->arguments.begin(), (*call)->arguments.end(),
                         [&](ast::Argument const& argument) { return is_pure(argument.value); });
    }
    return false;
  }

  // `dropped` is taken out of a product of which `rest` stays.
  void drop(ast::Expression const& dropped, Span place, ast::Expression const& rest, Context context, bool top) {
    if (is_bare(dropped)) return;
    if (is_pure(dropped)) context.harmless = "a pure number changes no unit";
    if (top && is_bare(rest)) context.harmless = "a bare number is left, which adapts";
    add("a factor dropped", place, "", context);
  }

  void plant(ast::Expression const& tree, Context context, bool top = true) {
    if (auto const* number = std::get_if<ast::Number>(&tree.node)) {
      Span const tag{number->unit ? number->unit->span.begin : tree.span.end, tree.span.end};
      if (!number->unit)
        add("a number with a unit", {tree.span.end, tree.span.end}, " " + strange, context);
      else
        add("a number in another unit", tag, strange, context);
    } else if (auto const* reference = std::get_if<ast::Reference>(&tree.node)) {
      if (reference->name.text == "pi" || reference->name.text == "inf") return;
      for (char const* unit : {"cd", "s", "1/kg"})
        add(std::string("a factor in [") + unit + "]", tree.span, "(" + at(tree.span) + "*1 [" + unit + "])", context);
    } else if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) {
      plant(*(*unary)->operand, context, top && (*unary)->symbol == "-");
    } else if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node)) {
      plant_binary(**binary, context, top);
    } else if (auto const* call = std::get_if<ast::Box<ast::Call>>(&tree.node)) {
      std::string const& name = (*call)->function.text;
      if (name == "measured" || name == "predicted" || name == "residual") return;  // takes the name of a channel, not a value
      if (name == "sign" || name == "step") context.harmless = "only the sign is used";
      for (ast::Argument const& argument : (*call)->arguments) plant(argument.value, context, false);
    } else if (auto const* choice = std::get_if<ast::Box<ast::Conditional>>(&tree.node)) {
      plant(*(*choice)->condition, context, false);
      plant(*(*choice)->then, context, false);
      plant(*(*choice)->otherwise, context, false);
    }
  }

  void plant_binary(ast::Binary const& binary, Context context, bool top) {
    std::string const& symbol = binary.symbol;
    bool const sum = symbol == "+" || symbol == "-";
    bool const comparison = symbol.find_first_of("<>=!") != std::string::npos;
    for (ast::Expression const* side : {&*binary.left, &*binary.right}) {
      Context inner = context;
      if (sum && top) inner.term = side->span;
      bool const other_bare = is_bare(side == &*binary.left ? *binary.right : *binary.left);
      if (comparison && other_bare) inner.harmless = "compared with a bare number, which adapts";
      plant(*side, inner, sum && top);
    }
    if (symbol == "^") {
      if (is_pure(*binary.left)) context.harmless = "a pure number is one in every power";
      if (auto const* number = std::get_if<ast::Number>(&binary.right->node); number != nullptr && !is_bare(*binary.left))
        add("another exponent", binary.right->span, std::to_string(static_cast<int>(number->value) + 1), context);
    } else if (symbol == "*" || symbol == "/") {
      drop(*binary.right, {binary.left->span.end, binary.right->span.end}, *binary.left, context, top);
    }
    if (symbol == "*") drop(*binary.left, {binary.left->span.begin, binary.right->span.begin}, *binary.right, context, top);
  }

  void declared(ast::Declared const& declared, Span whole) {
    if (!declared.unit) return;
    // The brackets are part of the span or lie around it.
    Span span = declared.unit->span;
    if (text[span.begin] != '[') span = {span.begin - 1, span.end + 1};
    if (at(span) == "[-]") pure.insert(declared.name.text);
    mutants.push_back({"another declared unit", span, strange, whole, declared.name.text, ""});
  }

  void arguments(ast::Call const& call) {
    for (ast::Argument const& argument : call.arguments) plant(argument.value, {argument.value.span, "", ""}, false);
  }

  void statement(ast::ModelStatement const& any) {
    if (auto const* equation = std::get_if<ast::Equation>(&any)) {
      plant(equation->left, {equation->left.span, "", ""});
      plant(equation->right, {equation->right.span, "", ""});
    } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&any)) {
      for (ast::Declared const& each : inputs->names) declared(each, each.span);
    } else if (auto const* states = std::get_if<ast::StateDeclaration>(&any)) {
      for (ast::Declared const& each : states->names) declared(each, each.span);
    } else if (auto const* initial = std::get_if<ast::InitialDeclaration>(&any)) {
      for (ast::InitialValue const& each : initial->values)
        if (each.value) plant(*each.value, {each.value->span, "", ""});
    } else if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&any)) {
      declared(parameter->name, parameter->span);
      if (!parameter->name.unit) return;  // unchecked
      if (parameter->prior) arguments(*parameter->prior);
      if (parameter->value) plant(*parameter->value, {parameter->value->span, "", ""});
    } else if (auto const* definition = std::get_if<ast::Definition>(&any)) {
      declared(definition->name, definition->span);
      plant(definition->value, {definition->value.span, definition->name.unit ? "" : definition->name.name.text, ""});
    } else if (auto const* observation = std::get_if<ast::Observation>(&any)) {
      declared(observation->channel, observation->span);
      arguments(observation->noise);
    }
  }
};

std::string file_text(std::filesystem::path const& path) {
  std::ifstream const in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::vector<std::filesystem::path> shipped_models() {
  std::vector<std::filesystem::path> paths;
  for (auto const& entry : std::filesystem::recursive_directory_iterator(std::filesystem::path(SYSID_SOURCE_DIR) / "models"))
    if (entry.path().extension() == ".sysid") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

// The messages about units that a text gets, and whether one of them marks the place of the mutant.
struct Finding {
  bool found = false;
  bool at_place = false;
  bool primary_at_place = false;
};
Finding look(std::string const& name, std::string const& text, Mutant const& mutant) {
  std::string mutated = text;
  mutated.replace(mutant.place.begin, mutant.place.end - mutant.place.begin, mutant.text);
  auto const delta = static_cast<int>(mutant.text.size()) - static_cast<int>(mutant.place.end - mutant.place.begin);
  auto const moved = [&](std::uint32_t offset) {
    return offset < mutant.place.end ||
                   (offset == mutant.place.end && mutant.place.begin == mutant.place.end && mutant.text.empty())
               ? offset
               : static_cast<std::uint32_t>(static_cast<int>(offset) + delta);
  };
  Span const term{mutant.term.begin, std::max(moved(mutant.term.end), mutant.term.begin + 1)};
  Span const site{mutant.place.begin,
                  mutant.place.begin + std::max<std::uint32_t>(1, static_cast<std::uint32_t>(mutant.text.size()))};
  Source source(name, mutated);
  Diagnostics diagnostics;
  load(source, diagnostics);
  Finding finding;
  for (Diagnostic const& diagnostic : diagnostics.all()) {
    if (diagnostic.severity != Severity::error || !diagnostic.primary) continue;
    // A count, a shape and a whole number are refused for what they are, which a unit is a part of.
    static std::set<std::string> const of_kinds{"E2118", "E2701", "E2704", "E3102", "E3206"};
    bool const about_units = of_kinds.contains(diagnostic.code) || diagnostic.code == "E2103" ||
                             diagnostic.code.starts_with("E22") || diagnostic.code == "E2014" || diagnostic.code == "E2117" ||
                             diagnostic.code == "E4113" || diagnostic.code == "E4114";
    if (!about_units) continue;
    finding.found = true;
    auto const names_it = [&](Span span) {
      std::string_view const shown = source.text(span);
      std::size_t const place = mutant.name.empty() ? std::string_view::npos : shown.find(mutant.name);
      return place != std::string_view::npos;
    };
    auto const hits = [&](Span span) { return inside(span, term) || names_it(span); };
    bool const primary = hits(diagnostic.primary->span) || inside(site, diagnostic.primary->span);
    finding.primary_at_place = finding.primary_at_place || primary;
    finding.at_place =
        finding.at_place || primary ||
        std::any_of(diagnostic.secondary.begin(), diagnostic.secondary.end(), [&](Label const& label) { return hits(label.span); });
  }
  return finding;
}

}  // namespace

TEST_CASE("wrong units planted in the shipped models are found where they are") {
  int wrong = 0, found = 0, at_place = 0, primary = 0, harmless = 0;
  for (std::filesystem::path const& path : shipped_models()) {
    CAPTURE(path.string());
    std::string const text = file_text(path);
    Source source(path.string(), text);
    Diagnostics diagnostics;
    auto const tree = parse(source, diagnostics);
    REQUIRE(tree);
    load(source, diagnostics);
    CHECK_MESSAGE(diagnostics.all().empty(), render(diagnostics, source));
    Planter planter{text, {}, {}};
    for (ast::Item const& item : tree->items)
      if (auto const* model = std::get_if<ast::Model>(&item)) {
        for (ast::ModelArgument const& argument : model->arguments) planter.pure.insert(argument.name.text);
        for (ast::ModelStatement const& statement : model->statements) planter.statement(statement);
      }
    if (std::none_of(tree->items.begin(), tree->items.end(),
                     [](ast::Item const& item) { return std::holds_alternative<ast::Model>(item); }))
      continue;  // of a dictionary: coefficients take up any unit
    CHECK(planter.mutants.size() > 10);
    for (Mutant const& mutant : planter.mutants) {
      Finding const finding = look(path.string(), text, mutant);
      if (!mutant.harmless.empty() && !finding.found) {
        ++harmless;
        continue;
      }
      ++wrong;
      found += finding.found;
      at_place += finding.at_place;
      primary += finding.primary_at_place;
      if (!finding.at_place) {
        Place const place = source.place(mutant.place.begin);
        MESSAGE(path.filename().string() << ":" << place.line << ":" << place.column << ": " << mutant.what << ", `"
                                         << source.text(mutant.term)
                                         << "`: " << std::string(finding.found ? "found, but shown elsewhere" : "not found"));
      }
    }
  }
  MESSAGE(wrong << " wrong units, " << found << " found, " << at_place << " marked at the place, " << primary
                << " of them as the primary one; " << harmless << " more are no mistake");
  CHECK(wrong > 200);
  CHECK(found == wrong);
  CHECK(at_place >= 0.95 * wrong);
}

TEST_CASE("shipped models declare all units") {
  for (std::filesystem::path const& path : shipped_models()) {
    CAPTURE(path.string());
    for (Model const& model : checked(file_text(path)).models)
      for (Unchecked const& each : model.unchecked) CHECK_MESSAGE(false, model.name << ": `" << each.what << "`: " << each.why);
  }
}
