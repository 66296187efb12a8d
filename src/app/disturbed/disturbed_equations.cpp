// Which equations: by the flat tree, where parts and vectors are written out. What stands there: by the tree of the user's text.
#include "app/disturbed/disturbed_equations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/text/diagnostic.hpp"
#include "syntax/find_model.hpp"
#include "syntax/parse.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

UserError refused(Span place, std::string message, std::string help) {
  return UserError({Severity::error, "", std::move(message), Label{place, {}}, {}, std::move(help)});
}

/// What a model may not have; each with its cure.
void require_open(Model const& model, Task const& fit) {
  std::string const name = fmt::format("`{}`", model.name);
  if (!model.disturbances.empty())
    throw refused(model.disturbances.front().span, fmt::format("{} already has a disturbance", name),
                  "fit it as it is, and also fit the same model without the disturbance; `sysid compare` compares both fits");
  if (!model.processes.empty())
    throw refused(model.processes.front().span,
                  fmt::format("{} has a Gaussian process, which cannot be combined with a disturbance", name),
                  "give the function a range, `within = (low, high)`, which makes it a finite sum");
  if (!model.unknowns.empty() || model.implicit)
    throw refused(model.unknowns.empty() ? fit.span : model.unknowns.front().span,
                  fmt::format("{} has equations that cannot be solved for the highest derivatives: no filter supports these", name),
                  "write the model with ordinary differential equations");
  if (model.dynamics == Dynamics::none)
    throw refused(fit.span, fmt::format("{} has no states: a disturbance in one row would not affect later rows", name),
                  "fit it as it is: only a model with states can have a disturbance");
  for (Channel const& channel : model.channels)
    if (!channel.noise.row->gaussian || channel.noise.lower || channel.noise.upper)
      throw refused(channel.span,
                    fmt::format("the noise of `{}` is not normal, which the filters of disturbances need", channel.name),
                    "fit with `normal(...)` noise");
}

template <class Statement>
std::vector<Statement const*> statements_of(ast::Model const& model) {
  std::vector<Statement const*> found;
  for (ast::ModelStatement const& statement : model.statements)
    if (auto const* each = std::get_if<Statement>(&statement)) found.push_back(each);
  return found;
}

/// "q[2]" of q[2]''.
std::string undifferentiated(ast::Reference reference) {
  reference.primes = 0;
  return unparse(ast::Expression{{}, std::move(reference)});
}

/// Of each name the order of its highest derivative in these equations.
template <class NameOf>
std::map<std::string, int> orders(std::vector<ast::Equation const*> const& equations, NameOf const& name_of) {
  std::map<std::string, int> order;
  for (ast::Equation const* equation : equations)
    each_reference(*equation, [&](ast::Reference const& reference) {
      int& known = order[name_of(reference)];
      known = std::max(known, reference.primes);
    });
  return order;
}

/// y' = v: no force acts there.
bool names_a_velocity(ast::Equation const& equation) {
  auto const* left = std::get_if<ast::Reference>(&equation.left.node);
  auto const* right = std::get_if<ast::Reference>(&equation.right.node);
  return left != nullptr && right != nullptr && left->primes + right->primes > 0;
}

/// Places of the equations that get a disturbance, in the order of the flat tree, each once.
std::vector<Span> chosen_places(ast::Model const& flat, bool discrete) {
  auto const equations = statements_of<ast::Equation>(flat);
  auto const order = orders(equations, undifferentiated);
  std::vector<std::pair<Span, int>> found;  // with the order of the equation
  int highest = 0;
  for (ast::Equation const* equation : equations) {
    if (names_a_velocity(*equation)) continue;
    int own = 0;
    each_reference(*equation, [&](ast::Reference const& reference) {
      if (reference.primes == order.at(undifferentiated(reference))) own = std::max(own, reference.primes);
    });
    highest = std::max(highest, own);
    found.emplace_back(equation->span, own);
  }
  std::vector<Span> places;
  for (auto const& [place, own] : found) {
    bool const moves = discrete || own >= std::min(2, std::max(1, highest));
    if (moves && std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
  }
  return places;
}

/// All names that a model declares, with those before a dot.
std::set<std::string> names_of(std::string_view text) {
  std::set<std::string> names;
  std::string word;
  for (char const each : std::string(text) + " ") {
    if (std::isalnum(static_cast<unsigned char>(each)) != 0 || each == '_') {
      word += each;
    } else if (!word.empty()) {
      names.insert(std::exchange(word, {}));
    }
  }
  return names;
}

class EquationReader {
 public:
  EquationReader(Source const& source, ast::Model const& model, bool discrete)
      : source_(source), model_(model), discrete_(discrete), taken_(names_of(source.text(model.span))) {
    order_ = orders(statements_of<ast::Equation>(model), [](ast::Reference const& reference) { return reference.name.text; });
  }

  /// alone: no other equation of the model has a disturbance.
  DisturbedEquation read(ast::Equation const& equation, bool alone) {
    DisturbedEquation read;
    read.place = equation.span;
    read.discrete = discrete_;
    std::string state;
    bool whole = false;  // a vector is named without an index
    each_reference(equation, [&](ast::Reference const& reference) {
      if (!is_highest(reference)) return;
      if (state.empty()) state = reference.name.text;
      if (reference.index.empty() && !sizes(reference.name.text).empty() && read.sizes.empty()) {
        whole = true;
        read.sizes = sizes(reference.name.text);
      }
    });
    std::replace(state.begin(), state.end(), '.', '_');
    read.name = free_name(alone || state.empty() ? "unmeasured" : "unmeasured_" + state);
    std::uint32_t const equals = equals_sign(equation);
    Side const left = side({equation.span.begin, equals}, equation.left),
               right = side({equals + 1, equation.span.end}, equation.right);
    read.left = std::string(trimmed_text({equation.span.begin, equals}));
    read.right = right.text;
    read.right_closed = right.closed;
    // What is determined is named on the left, with its unit.
    bool const named = std::holds_alternative<ast::Reference>(equation.left.node);
    read.inertia = discrete_ ? fmt::format("({})", named ? left.text : right.text)
                             : fmt::format("{} - {}", difference(left.text, right.text), difference(left.at_rest, right.at_rest));
    return read;
  }

 private:
  struct Side {
    std::string text, at_rest;  // as written, and with 0 times the highest derivatives; empty: the side is 0
    bool closed = false;
  };

  static std::string difference(std::string const& left, std::string const& right) {
    if (left.empty()) return fmt::format("(-({}))", right);
    return right.empty() ? fmt::format("({})", left) : fmt::format("(({}) - ({}))", left, right);
  }

  /// In discrete time the quantity that an equation determines, which has no prime.
  bool is_highest(ast::Reference const& reference) const {
    auto const order = order_.find(reference.name.text);
    return order != order_.end() && reference.primes == order->second && (discrete_ || reference.primes > 0);
  }

  std::string sizes(std::string const& state) const {
    for (ast::StateDeclaration const* declaration : statements_of<ast::StateDeclaration>(model_))
      for (ast::Declared const& declared : declaration->names)
        if (declared.name.text == state && !declared.sizes.empty()) {
          std::string text;
          for (ast::Expression const& size : declared.sizes) text += (text.empty() ? "" : ", ") + unparse(size);
          return fmt::format("({})", text);
        }
    return {};
  }

  std::string free_name(std::string const& wanted) {
    std::string name = wanted;
    for (int number = 2; taken_.contains(name) || taken_.contains(name + "_intensity") || taken_.contains(name + "_sd"); ++number)
      name = fmt::format("{}_{}", wanted, number);
    taken_.insert(name);
    return name;
  }

  /// Where the equation has it: parentheses about a side belong to neither tree.
  std::uint32_t equals_sign(ast::Equation const& equation) const {
    std::string_view const between = source_.text(Span{equation.left.span.end, equation.right.span.begin});
    return equation.left.span.end + static_cast<std::uint32_t>(between.find('='));
  }

  Side side(Span place, ast::Expression const& tree) const {
    if (auto const* number = std::get_if<ast::Number>(&tree.node); number != nullptr && number->value == 0 && !number->unit)
      return {};
    auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
    bool const sum = binary == nullptr || std::string_view("+-*/^").find((*binary)->symbol) != std::string_view::npos;
    Side side{std::string(trimmed_text(place)), {}, sum && !std::holds_alternative<ast::Box<ast::Conditional>>(tree.node)};
    std::vector<Span> highest;
    each_reference(tree, [&](ast::Reference const& reference) {
      if (is_highest(reference)) highest.push_back(reference.span);
    });
    std::sort(highest.begin(), highest.end(), [](Span a, Span b) { return a.begin < b.begin; });
    std::uint32_t done = place.begin;
    for (Span const each : highest) {
      side.at_rest += fmt::format("{}(0*{})", source_.text(Span{done, each.begin}), source_.text(each));
      done = each.end;
    }
    side.at_rest += source_.text(Span{done, place.end});
    return side;
  }

  std::string_view trimmed_text(Span place) const {
    std::string_view text = source_.text(place);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front())) != 0) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.remove_suffix(1);
    return text;
  }

  Source const& source_;
  ast::Model const& model_;
  bool discrete_;
  std::set<std::string> taken_;
  std::map<std::string, int> order_;
};

}  // namespace

std::vector<DisturbedEquation> disturbed_equations(Source const& source, CheckedFile const& file, Task const& fit) {
  Model const& model = file.models[static_cast<std::size_t>(std::get<FitTask>(fit.what).model)];
  require_open(model, fit);
  ast::Model const* const flat = find_model(file.tree, model.name);
  if (flat == nullptr) throw InternalError("a fitted model is not in the tree");
  bool const discrete = model.dynamics == Dynamics::discrete;
  std::vector<Span> const places = chosen_places(*flat, discrete);
  if (places.empty())
    throw refused(fit.span, fmt::format("`{}` has no equation to which a disturbance can be added", model.name),
                  discrete ? "a model that predicts each sample from measured samples already treats every error as a disturbance"
                           : "a disturbance can be added only to an equation that contains a derivative");
  Diagnostics ignored;
  auto const tree = parse(source, ignored);
  std::vector<DisturbedEquation> found;
  for (ast::Item const& item : tree ? tree->items : std::vector<ast::Item>()) {
    auto const* written = std::get_if<ast::Model>(&item);
    if (written == nullptr) continue;
    std::vector<ast::Equation const*> here;
    for (ast::Equation const* equation : statements_of<ast::Equation>(*written))
      if (std::find(places.begin(), places.end(), equation->span) != places.end()) here.push_back(equation);
    EquationReader reader(source, *written, discrete);
    for (ast::Equation const* equation : here) found.push_back(reader.read(*equation, here.size() == 1));
  }
  if (found.empty())
    throw refused(fit.span, fmt::format("the equations of `{}` are in a module, and modules are not changed", model.name),
                  "copy the model into this file under another name and fit that");
  return found;
}

}  // namespace sysid
