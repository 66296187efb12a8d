// Text by statement, expressions from the trees of the dictionary; laid out by the formatter.
#include "app/found_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "check/elaborate/tree.hpp"
#include "check/scope.hpp"
#include "check/walk.hpp"
#include "core/elementary.hpp"
#include "syntax/format.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

/// Sds of the regression that a prior is wide: the record speaks again in the fit, with a hundredth of its weight in the prior.
constexpr double prior_width = 10;
/// And never narrower than this part of the coefficient: what the form of derivatives may be wrong by.
constexpr double least_width = 0.1;
/// Either way from the noise that the regression took.
constexpr double noise_factor = 10;
/// Rows from which the state of a record that was not fitted is estimated.
constexpr int start_rows = 50;

// "4.979e9".
std::string plain(std::string text) {
  if (auto const at = text.find("e+"); at != std::string::npos) text.erase(at + 1, text.find_first_not_of('0', at + 2) - at - 1);
  return text;
}
std::string number(double value) { return plain(fmt::format("{:.6g}", value)); }
std::string rounded(double value) { return plain(fmt::format("{:.2g}", value)); }

/// coefficient*term, as first factor of a product.
ast::Expression times(ast::Expression coefficient, ast::Expression const& term) {
  if (tree::is_number(term, 1)) return coefficient;
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&term.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/"))
    return tree::binary("*", std::move(coefficient), term, {});
  return tree::binary((*binary)->symbol, times(std::move(coefficient), *(*binary)->left), *(*binary)->right, {});
}

std::string in_brackets(std::string const& unit) { return unit.empty() ? "" : fmt::format(" [{}]", unit); }
double from_si(std::optional<Unit> const& unit, double value) { return unit ? value / unit->scale : value; }

std::string identifier(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '[' || c == ']' || c == ',' || c == '.' || c == ' '; }, '_');
  while (text.ends_with('_')) text.pop_back();
  return text;
}

std::set<std::string> declared_in(CheckedDictionary const& dictionary) {
  std::set<std::string> names;
  for (Quantity const& state : dictionary.states) names.insert(state.name);
  for (ast::DictionaryStatement const& statement : dictionary.tree.statements) {
    if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) names.insert(time->time.name.text);
    if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement))
      for (ast::Declared const& input : inputs->names) names.insert(input.name.text);
    if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement)) names.insert(parameter->name.name.text);
    if (auto const* definition = std::get_if<ast::Definition>(&statement)) names.insert(definition->name.name.text);
  }
  return names;
}

std::string fresh(std::string name, std::set<std::string>& taken) {
  while (!taken.insert(name).second) name += "_";
  return name;
}

/// First row that was measured and the sizes of differences in time of one channel over all experiments.
struct Motion {
  double first = 0;
  std::vector<double> size;  // [order]: root mean square of the k-th difference quotient, of the values themselves about their mean
};

Motion motion_of(std::vector<ExperimentData> const& data, std::size_t channel, int orders) {
  Motion motion;
  motion.size.assign(static_cast<std::size_t>(orders) + 1, 0);
  double mean_first = 0;
  for (ExperimentData const& each : data) {
    std::vector<double> const& time = each.experiment.time;
    std::vector<double> values, times;
    for (std::size_t i = 0; i < time.size(); ++i)
      if (!std::isnan(each.experiment.measured[channel][i])) {
        values.push_back(each.experiment.measured[channel][i]);
        times.push_back(time[i]);
      }
    if (values.empty()) continue;
    mean_first += values.front() / static_cast<double>(data.size());
    double mean = 0;
    for (double const v : values) mean += v / static_cast<double>(values.size());
    for (int k = 0; k <= orders && values.size() > 1; ++k) {
      double square = 0;
      for (double const v : values) square += (v - (k == 0 ? mean : 0)) * (v - (k == 0 ? mean : 0));
      double& size = motion.size[static_cast<std::size_t>(k)];
      size = std::max(size, std::sqrt(square / static_cast<double>(values.size())));
      for (std::size_t i = 0; i + 1 < values.size(); ++i) values[i] = (values[i + 1] - values[i]) / (times[i + 1] - times[i]);
      values.pop_back();
      times.pop_back();
    }
  }
  motion.first = mean_first;
  return motion;
}

/// One model of the file.
class ModelText {
 public:
  ModelText(FoundSource const& source, FoundStructure const& structure) : source_(source), structure_(structure) {
    taken_ = declared_in(source.dictionary);
    for (std::size_t e = 0; e < structure.equations.size(); ++e) {
      names_.push_back(coefficient_names(source.dictionary, static_cast<int>(e)));
      taken_.insert(names_.back().begin(), names_.back().end());
    }
    look();
  }

  std::string text(std::string const& name, std::string const& title) {
    std::string out = fmt::format("model {} \"{}\" {{\n", name, title);
    out += declarations() + initial_values() + "\n" + definitions() + coefficients() + "\n" + equations() + "\n" + observations();
    return out + "}\n";
  }

  /// Leaves of the dictionary that the model reads.
  std::set<std::size_t> const& inputs() const { return inputs_; }

 private:
  CheckedDictionary const& dictionary() const { return source_.dictionary; }

  std::vector<NodeId> roots() const {
    std::vector<NodeId> all;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      regression::Equation const& equation = dictionary().numbers.equations[e];
      all.push_back(equation.known);
      for (int const term : structure_.equations[e]->terms)
        all.push_back(equation.terms[static_cast<std::size_t>(term)].expression);
    }
    return all;
  }

  void look() {
    Graph const& graph = dictionary().numbers.graph;
    std::vector<NodeId> const reached = graph.reachable(roots());
    std::set<NodeId> const read(reached.begin(), reached.end());
    orders_.assign(dictionary().states.size(), 0);
    for (regression::Symbol const& symbol : dictionary().numbers.symbols) {
      if (!read.contains(symbol.leaf)) continue;
      auto const index = static_cast<std::size_t>(symbol.index);
      if (symbol.kind == regression::Symbol::Kind::state) orders_[index] = std::max(orders_[index], symbol.order);
      if (symbol.kind == regression::Symbol::Kind::input) inputs_.insert(index);
      if (symbol.kind == regression::Symbol::Kind::time) reads_time_ = true;
    }
    std::vector<ast::Expression const*> trees;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      DictionaryEquation const& equation = dictionary().equations[e];
      trees.push_back(&equation.tree);
      for (int const term : structure_.equations[e]->terms) trees.push_back(&equation.terms[static_cast<std::size_t>(term)].tree);
    }
    for (ast::Expression const* tree : trees) use(*tree);
  }

  // Names and functions that an expression reads, through definitions.
  void use(ast::Expression const& tree) {
    each_expression(tree, [&](ast::Expression const& part) {
      if (auto const* reference = std::get_if<ast::Reference>(&part.node)) use_name(reference->name.text);
      if (auto const* call = std::get_if<ast::Box<ast::Call>>(&part.node)) use_function((*call)->function.text);
    });
  }
  void use_name(std::string const& name) {
    if (!used_.insert(name).second) return;
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements)
      if (auto const* definition = std::get_if<ast::Definition>(&statement);
          definition != nullptr && definition->name.name.text == name)
        use(definition->value);
  }
  void use_function(std::string const& name) {
    if (!functions_.insert(name).second) return;
    for (ast::FunctionDefinition const* function : all_functions())
      if (function->name.text == name) use(function->value);
  }
  std::vector<ast::FunctionDefinition const*> all_functions() const {
    std::vector<ast::FunctionDefinition const*> all;
    for (ast::FunctionDefinition const& function : dictionary().functions) all.push_back(&function);
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements)
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) all.push_back(function);
    return all;
  }

  std::string declarations() const {
    std::string out;
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements)
      if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement); time != nullptr && reads_time_)
        out += fmt::format("time {}{}\n", time->time.name.text,
                           time->time.unit ? fmt::format(" [{}]", unparse(*time->time.unit)) : "");
    for (std::size_t const i : inputs_) {
      Quantity const& input = dictionary().measured.inputs[i];
      out += fmt::format("input {}{}\n", input.name, in_brackets(input.unit_text()));
    }
    for (Quantity const& state : dictionary().states)
      out += fmt::format("state {}{}\n", state.name, in_brackets(state.unit_text()));
    return out;
  }

  // From the first rows; wide enough that the record decides.
  std::string initial_values() {
    std::string parameters, initial;
    for (std::size_t s = 0; s < orders_.size(); ++s) {
      Quantity const& state = dictionary().states[s];
      for (int k = 0; k < orders_[s]; ++k) {
        std::string const name = fresh(fmt::format("{}{}_0", std::string(static_cast<std::size_t>(k), 'd'), state.name), taken_);
        auto const [mean, sd] = start_of(s, k);
        auto const unit = rate_unit(state.unit, k);
        parameters +=
            fmt::format("parameter {}{}{} ~ normal({}, sd = {})\n", name, source_.data.size() > 1 ? " per experiment" : "",
                        in_brackets(unit ? unit->text : ""), number(from_si(state.unit, mean)), rounded(from_si(state.unit, sd)));
        initial += fmt::format("{}{} = {}", initial.empty() ? "initial " : ", ", primed_name(state.name, k), name);
      }
    }
    return parameters + initial + "\n";
  }

  std::pair<double, double> start_of(std::size_t state, int order) const {
    std::vector<regression::Channel> const& channels = dictionary().numbers.channels;
    // The channel of the nearest order at or below; else the size is that of the highest above, over the record.
    for (int own = order; own >= 0; --own)
      for (std::size_t c = 0; c < channels.size(); ++c)
        if (channels[c].state == static_cast<int>(state) && channels[c].order == own) {
          Motion const motion = motion_of(source_.data, c, order - own);
          return {own == order ? motion.first : 0, motion.size[static_cast<std::size_t>(order - own)]};
        }
    double length = 0;
    for (ExperimentData const& each : source_.data)
      length = std::max(length, each.experiment.time.back() - each.experiment.time.front());
    for (std::size_t c = 0; c < channels.size(); ++c)
      if (channels[c].state == static_cast<int>(state))
        return {0, motion_of(source_.data, c, 0).size[0] * std::pow(length, channels[c].order - order)};
    return {0, 1};
  }

  std::string definitions() const {
    std::string out;
    for (ast::DictionaryStatement const& statement : dictionary().tree.statements) {
      if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement);
          parameter != nullptr && parameter->value && used_.contains(parameter->name.name.text))
        out += fmt::format("parameter {}{} = {}\n", parameter->name.name.text,
                           parameter->name.unit ? fmt::format(" [{}]", unparse(*parameter->name.unit)) : "",
                           unparse(*parameter->value));
      if (auto const* definition = std::get_if<ast::Definition>(&statement);
          definition != nullptr && used_.contains(definition->name.name.text))
        out += fmt::format(
            "{} {}{} = {}\n", definition->kind == ast::DefinitionKind::constant ? "constant" : "let", definition->name.name.text,
            definition->name.unit ? fmt::format(" [{}]", unparse(*definition->name.unit)) : "", unparse(definition->value));
    }
    for (ast::FunctionDefinition const* function : all_functions())
      if (functions_.contains(function->name.text)) out += unparse(ast::File{{*function}});
    return out;
  }

  std::string coefficients() const {
    std::string out;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      regression::Support const& support = *structure_.equations[e];
      for (std::size_t k = 0; k < support.terms.size(); ++k) {
        auto const j = static_cast<std::size_t>(support.terms[k]);
        auto const i = static_cast<Eigen::Index>(k);
        DictionaryTerm const& term = dictionary().equations[e].terms[j];
        double const value = support.coefficient(i), sd = std::sqrt(support.covariance(i, i));
        double const width = std::max(prior_width * sd, least_width * std::fabs(value));
        out += fmt::format("parameter {}{} ~ normal({}, sd = {})  # {}\n", names_[e][j],
                           in_brackets(term.unit ? term.unit->text : ""), number(from_si(term.unit, value)),
                           rounded(from_si(term.unit, width)), term.in_target ? "in the target" : term.text);
      }
    }
    return out;
  }

  std::string equations() const {
    std::string out;
    for (std::size_t e = 0; e < structure_.equations.size(); ++e) {
      DictionaryEquation const& equation = dictionary().equations[e];
      std::optional<ast::Expression> sum;
      for (int const index : structure_.equations[e]->terms) {
        auto const j = static_cast<std::size_t>(index);
        if (equation.terms[j].in_target) continue;
        ast::Expression term = times(tree::reference(names_[e][j], 0, {}), equation.terms[j].tree);
        sum = sum ? tree::binary("+", std::move(*sum), std::move(term), {}) : std::move(term);
      }
      std::string const left = unparse(equation.tree), right = unparse(sum ? *sum : tree::number(0, {}));
      bool const turned = left.starts_with('-');  // no statement begins so
      out += fmt::format("{} = {}\n", turned ? right : left, turned ? left : right);
    }
    return out;
  }

  std::string observations() {
    std::string parameters, observed;
    for (std::size_t c = 0; c < dictionary().measured.channels.size(); ++c) {
      Channel const& channel = dictionary().measured.channels[c];
      regression::Channel const& measured = dictionary().numbers.channels[c];
      auto const s = static_cast<std::size_t>(measured.state);
      if (measured.order > orders_[s]) continue;  // of nothing in the model
      std::string const name = fresh("noise_" + identifier(channel.name), taken_);
      double sd = source_.discovery.noise_sd.size() > c ? source_.discovery.noise_sd[c] : 0;
      double const size = motion_of(source_.data, c, 0).size[0];
      double low = sd / noise_factor, high = sd * noise_factor;
      if (!(sd > 1e-9 * size)) low = 1e-9 * size, high = size;
      parameters += fmt::format("parameter {}{} ~ log_uniform({}, {})\n", name, in_brackets(channel.unit_text()),
                                rounded(from_si(channel.unit, low)), rounded(from_si(channel.unit, high)));
      observed += fmt::format("observe {} ~ normal({}, sd = {})\n", channel.name,
                              primed_name(dictionary().states[s].name, measured.order), name);
    }
    return parameters + observed;
  }

  FoundSource const& source_;
  FoundStructure const& structure_;
  std::set<std::string> taken_;
  std::vector<std::vector<std::string>> names_;  // [equation][term]
  std::vector<int> orders_;                      // per state: its highest derivative
  std::set<std::size_t> inputs_;
  bool reads_time_ = false;
  std::set<std::string> used_, functions_;
};

}  // namespace

std::vector<FoundStructure> best_structures(regression::Discovery const& discovery, int most) {
  std::vector<FoundStructure> all = {{}};
  for (regression::FoundEquation const& equation : discovery.equations) {
    if (!equation.found) return {};
    std::vector<regression::Support const*> supports = {&equation.chosen};
    for (regression::Support const& each : equation.supports)
      if (each.terms != equation.chosen.terms) supports.push_back(&each);
    bool const probable = equation.chosen.probability > 0 && equation.chosen.probability < 1;
    auto const score = [&](regression::Support const& support) {
      return probable ? elementary::log(support.probability) : support.log_evidence;
    };
    std::vector<FoundStructure> more;
    for (FoundStructure const& before : all)
      for (regression::Support const* support : supports) {
        more.push_back(before);
        more.back().equations.push_back(support);
        more.back().score += score(*support);
      }
    // What was chosen stays first, whatever scores higher.
    std::stable_sort(more.begin() + 1, more.end(), [](auto const& a, auto const& b) { return a.score > b.score; });
    if (more.size() > static_cast<std::size_t>(most)) more.resize(static_cast<std::size_t>(most));
    all = std::move(more);
  }
  return all;
}

std::vector<std::string> coefficient_names(CheckedDictionary const& dictionary, int equation) {
  std::set<std::string> const declared = declared_in(dictionary);
  std::vector<DictionaryTerm> const& terms = dictionary.equations[static_cast<std::size_t>(equation)].terms;
  std::map<std::string, int> before;  // how many terms a parameter stands before, in all equations
  for (DictionaryEquation const& each : dictionary.equations)
    for (DictionaryTerm const& term : each.terms) ++before[term.coefficient];
  std::vector<std::string> names;
  int index = 0;
  for (DictionaryTerm const& term : terms) {
    if (!term.in_target) ++index;
    if (!term.coefficient.empty() && before[term.coefficient] == 1) {
      names.push_back(term.coefficient);
      continue;
    }
    std::string const letter(1, static_cast<char>('a' + equation % 26));
    std::string name = fmt::format("{}{}{}", letter, equation < 26 ? "" : fmt::format("{}_", equation / 26), index);
    while (declared.contains(name)) name += "_";
    names.push_back(std::move(name));
  }
  return names;
}

namespace {

/// A data block with what the models read, its file as seen from `folder`.
std::string data_text(ast::Data data, DataBlock const& block, Session const& session, std::filesystem::path const& folder,
                      std::set<std::string> const& inputs, std::set<std::string> const& channels) {
  std::erase_if(data.statements, [&](ast::DataStatement const& statement) {
    if (auto const* input = std::get_if<ast::DataInput>(&statement)) return !inputs.contains(input->input.text);
    if (auto const* measured = std::get_if<ast::DataMeasure>(&statement)) return !channels.contains(measured->channel.text);
    return std::holds_alternative<ast::DataConstant>(statement);
  });
  auto const place = [](std::filesystem::path const& path) { return std::filesystem::absolute(path).lexically_normal(); };
  std::filesystem::path const file = place(session.folder() / block.path);
  std::filesystem::path const seen = file.lexically_relative(place(folder));
  for (ast::DataStatement& statement : data.statements)
    if (auto* path = std::get_if<ast::DataFile>(&statement)) path->path.value = (seen.empty() ? file : seen).string();
  return unparse(ast::File{{std::move(data)}});
}

}  // namespace

std::string FoundSource::text(std::vector<FoundStructure> const& structures) const {
  CheckedFile const& file = session.file;
  std::string const title = dictionary.title.empty() ? "of the dictionary " + dictionary.name : dictionary.title;
  std::string out = fmt::format("# found by `discover {} from {}` with {}, seed {}\n", dictionary.name,
                                data_names(file, what.experiments), what.selector, seed);
  out +=
      "# priors: ten sds of the regression and a tenth of the coefficient at least, since the record speaks again in the fit\n\n";
  std::vector<std::string> models;
  std::set<std::string> inputs, channels;
  for (Channel const& channel : dictionary.measured.channels) channels.insert(channel.name);
  for (std::size_t k = 0; k < structures.size(); ++k) {
    models.push_back(k == 0 ? task.name : fmt::format("{}_{}", task.name, k + 1));
    ModelText model(*this, structures[k]);
    out += model.text(models.back(), k == 0 ? title : fmt::format("{}, structure {}", title, k + 1)) + "\n";
    for (std::size_t const i : model.inputs()) inputs.insert(dictionary.measured.inputs[i].name);
  }
  std::string uses;
  bool later = false;  // some rows lie before those that are scored
  std::set<int> blocks;
  std::string unseen;
  for (ExperimentUse const& use : what.experiments) {
    DataBlock const& block = file.data[static_cast<std::size_t>(use.data)];
    uses += (uses.empty() ? "" : ", ") + data_name(block, use.part);
    later = later || (use.part >= 0 && block.parts[static_cast<std::size_t>(use.part)].first > 1);
    if (!blocks.insert(use.data).second) continue;
    for (ast::Item const& item : file.tree.items)
      if (auto const* data = std::get_if<ast::Data>(&item); data != nullptr && data->name.text == block.name)
        out += data_text(*data, block, session, session.result_folder(task), inputs, channels) + "\n";
    for (std::size_t p = 0; p < block.parts.size() && use.part >= 0; ++p) {
      DataPart const& part = block.parts[p];
      bool const used = std::any_of(what.experiments.begin(), what.experiments.end(), [&](ExperimentUse const& other) {
        if (other.data != use.data || other.part < 0) return other.data == use.data;
        DataPart const& theirs = block.parts[static_cast<std::size_t>(other.part)];
        return part.first <= theirs.last && theirs.first <= part.last;
      });
      if (!used && part.last - part.first > 4 * start_rows)
        unseen += (unseen.empty() ? "" : ", ") + data_name(block, static_cast<int>(p));
    }
  }
  std::string const start = later ? ", start = rest" : "";
  if (structures.size() > 1) {
    out += fmt::format("candidates structures {{\n{}\n}}\n\n", fmt::join(models, "\n"));
    out += fmt::format("selection = select structures to {} with abc_smc(particles = 1000){}, seed = {}\n", uses, start, seed);
  }
  out += fmt::format("posterior = fit {} to {} with mh{}, seed = {}\n", task.name, uses, start, seed);
  out += fmt::format("fitted = predict posterior on {} with draws(200){}, seed = {}\n", uses, start, seed);
  if (!unseen.empty())
    out += fmt::format("forecast = predict posterior on {} with draws(200), start = estimated(rows = {}), seed = {}\n", unseen,
                       start_rows, seed);
  Diagnostics diagnostics;
  auto laid_out = formatted(Source("found.sysid", out), diagnostics);
  if (!laid_out) throw InternalError("the source of a discovery does not parse: " + diagnostics.all().front().message);
  return *laid_out;
}

}  // namespace sysid
