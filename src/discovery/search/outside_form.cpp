// The terms of one equation are taken out and built up again, with the functions among those that are offered.
#include "discovery/search/outside_form.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "discovery/search/outside_functions.hpp"
#include "discovery/search/sample_steps.hpp"
#include "discovery/structure_prior.hpp"

namespace sysid {
namespace {

constexpr std::size_t most_columns = 400;
/// Residuals far below the bound of what simulations and files are trusted to: what another term takes from them is no motion.
constexpr double within_bounds = 0.5;

/// The state of the model whose rate an equation sets: the only derivative in it, with these terms, that is one order above a
/// state. -1: none, or several, or one whose factor moves with the record, so that what a function does to the rate moves, too.
int driven_state(WholeDictionary const& dictionary, Terms const& terms, std::size_t equation) {
  regression::Dictionary const& numbers = dictionary.source().dictionary.numbers;
  std::vector<regression::Term> const& own = numbers.equations[equation].terms;
  std::vector<NodeId> roots = {numbers.equations[equation].known};
  for (regression::Term const& term : own)
    if (term.always) roots.push_back(term.expression);
  for (int const j : terms) {
    WholeDictionary::Column const& column = dictionary.columns()[static_cast<std::size_t>(j)];
    if (column.equation == equation && !column.always) roots.push_back(own[column.term].expression);
  }
  std::vector<NodeId> const reached = numbers.graph.reachable(roots);
  std::vector<std::pair<int, int>> const& states = dictionary.model().states;
  int found = -1;
  for (regression::Symbol const& symbol : numbers.symbols) {
    if (symbol.kind != regression::Symbol::Kind::state || std::find(reached.begin(), reached.end(), symbol.leaf) == reached.end())
      continue;
    if (std::find(states.begin(), states.end(), std::pair(symbol.index, symbol.order)) != states.end()) continue;
    auto const state = std::find(states.begin(), states.end(), std::pair(symbol.index, symbol.order - 1));
    if (state == states.end() || found >= 0) return -1;
    found = static_cast<int>(state - states.begin());
    Graph graph = numbers.graph;
    std::vector<NodeId> factors;
    for (NodeId const root : roots) factors.push_back(graph.differentiate(root, symbol.leaf));
    for (NodeId const node : graph.reachable(factors))
      if (std::any_of(numbers.symbols.begin(), numbers.symbols.end(), [&](auto const& each) { return each.leaf == node; }))
        return -1;
  }
  return found;
}

/// All rows of all records below each other.
StateValues values_of(WholeDictionary const& dictionary, std::vector<SampleSteps> const& steps) {
  StateValues out;
  std::vector<Quantity> const& states = dictionary.source().dictionary.states;
  for (auto const& [state, order] : dictionary.model().states) {
    Quantity const& of = states[static_cast<std::size_t>(state)];
    out.names.push_back(of.name + std::string(static_cast<std::size_t>(order), '\''));
    out.plain.push_back(!of.unit || of.unit->dimensionless() ? 1 : 0);
  }
  Eigen::Index rows = 0;
  for (SampleSteps const& each : steps) rows += static_cast<Eigen::Index>(each.states.size());
  out.values.resize(rows, static_cast<Eigen::Index>(out.names.size()));
  rows = 0;
  for (SampleSteps const& each : steps)
    for (Eigen::VectorXd const& state : each.states) out.values.row(rows++) = state.transpose();
  return out;
}

/// [rows x terms] of an equation, where they are functions of the states; the others 0.
Eigen::MatrixXd terms_of_states(WholeDictionary const& dictionary, std::size_t equation, StateValues const& states) {
  regression::Dictionary const& numbers = dictionary.source().dictionary.numbers;
  std::vector<NodeId> roots;
  for (regression::Term const& term : numbers.equations[equation].terms) roots.push_back(term.expression);
  std::vector<std::pair<int, int>> const& own = dictionary.model().states;
  Eigen::MatrixXd all(states.values.rows(), static_cast<Eigen::Index>(roots.size()));
  for (Eigen::Index row = 0; row < all.rows(); ++row) {
    std::vector<double> const values = numbers.graph.evaluate(roots, [&](NodeId leaf) {
      for (regression::Symbol const& symbol : numbers.symbols) {
        if (symbol.leaf != leaf || symbol.kind != regression::Symbol::Kind::state) continue;
        auto const place = std::find(own.begin(), own.end(), std::pair(symbol.index, symbol.order));
        if (place != own.end()) return states.values(row, place - own.begin());
      }
      return std::nan("");
    });
    for (std::size_t j = 0; j < values.size(); ++j)
      all(row, static_cast<Eigen::Index>(j)) = std::isfinite(values[j]) ? values[j] : 0;
  }
  return all;
}

/// What one function in the equation that drives state `driven` does to the rows of each segment, in the units of the slopes.
class Drive {
 public:
  Drive(WholeDictionary const& dictionary, FitConditions const& conditions, std::vector<SampleSteps> const& steps,
        std::vector<double> const& noise_sd)
      : dictionary_(dictionary),
        steps_(steps),
        noise_sd_(noise_sd),
        parts_(dictionary.segments(conditions.halved)),
        simulation_(dictionary.simulation(Terms{}, conditions)),
        states_(*dictionary.states_of_channels()) {}

  std::vector<Eigen::MatrixXd> columns(std::vector<OutsideFunction> const& functions, int driven) const {
    auto const count = static_cast<Eigen::Index>(functions.size());
    auto const d = static_cast<Eigen::Index>(dictionary_.model().states.size());
    std::vector<Eigen::Index> first = {0};
    for (SampleSteps const& each : steps_) first.push_back(first.back() + static_cast<Eigen::Index>(each.states.size()));
    std::vector<Eigen::MatrixXd> out;
    for (std::size_t s = 0; s < parts_.size(); ++s) {
      auto const e = static_cast<std::size_t>(parts_[s].experiment);
      std::vector<double> const& time = dictionary_.records()[e].time;
      Eigen::Index const rows = parts_[s].count;
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows * simulation_.channels(), count);
      Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(d, count);
      for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index c = 0; c < simulation_.channels(); ++c)
          columns.row(c * rows + i) = moved.row(states_[static_cast<std::size_t>(c)]);
        if (i + 1 == rows) break;
        auto const n = static_cast<std::size_t>(parts_[s].first + i);
        double const half = (time[n + 1] - time[n]) / 2;
        Eigen::Index const at = first[e] + static_cast<Eigen::Index>(n);
        for (Eigen::Index j = 0; j < count; ++j) moved(driven, j) += half * functions[static_cast<std::size_t>(j)].values(at);
        moved = (steps_[e].ahead[n] * moved).eval();
        for (Eigen::Index j = 0; j < count; ++j) moved(driven, j) += half * functions[static_cast<std::size_t>(j)].values(at + 1);
      }
      simulation_.in_relative_noise(static_cast<int>(s), columns);
      for (int c = 0; c < simulation_.channels(); ++c) columns.middleRows(c * rows, rows) /= noise_sd_[static_cast<std::size_t>(c)];
      out.push_back(std::move(columns));
    }
    return out;
  }

 private:
  WholeDictionary const& dictionary_;
  std::vector<SampleSteps> const& steps_;
  std::vector<double> const& noise_sd_;
  std::vector<Segment> parts_;
  SegmentSimulation simulation_;
  std::vector<int> states_;  // per channel
};

LinearisedMotion extended(LinearisedParts const& parts, std::vector<Eigen::MatrixXd> const& columns,
                          std::vector<double> const& log_odds) {
  std::vector<SegmentSlopes> slopes = parts.slopes;
  Eigen::Index const before = parts.at.size(), more = columns.front().cols();
  for (std::size_t s = 0; s < slopes.size(); ++s) {
    slopes[s].by_coefficient.conservativeResize(Eigen::NoChange, before + more);
    slopes[s].by_coefficient.rightCols(more) = columns[s];
  }
  Eigen::VectorXd at = Eigen::VectorXd::Zero(before + more);
  at.head(before) = parts.at;
  LinearisedMotion::Settings settings = parts.settings;
  settings.log_odds = log_odds;
  settings.always.resize(static_cast<std::size_t>(before + more), 0);
  return LinearisedMotion(slopes, at, std::move(settings));
}

/// Of all columns: those of the equation share its expected number of terms with the functions.
std::vector<double> shared_odds(WholeDictionary const& dictionary, std::size_t equation,
                                std::vector<OutsideFunction> const& functions) {
  std::vector<double> weights, odds;
  for (WholeDictionary::Column const& each : dictionary.columns()) {
    odds.push_back(each.log_odds);
    bool const shares = each.equation == equation && !each.always;
    weights.push_back(shares ? simplicity(dictionary.source().dictionary.equations[equation].terms[each.term].tree) : 0.0);
  }
  for (OutsideFunction const& each : functions) weights.push_back(each.simplicity), odds.push_back(0);
  std::vector<double> const shared = log_odds_of(weights);
  for (std::size_t j = 0; j < odds.size(); ++j)
    if (weights[j] > 0) odds[j] = shared[j];
  return odds;
}

}  // namespace

std::optional<OutsideEquation> outside_form(WholeDictionary const& dictionary, FittedTerms const& lead,
                                            FitConditions const& conditions, LinearisedParts const& parts,
                                            std::vector<double> const& noise_sd, std::vector<Terms> const& near,
                                            std::function<bool()> const& interrupted) {
  if (!dictionary.states_of_channels()) return std::nullopt;
  auto const steps = sample_steps(dictionary, lead, conditions, false);
  if (!steps) return std::nullopt;
  StateValues const states = values_of(dictionary, *steps);
  Drive const drive(dictionary, conditions, *steps, noise_sd);
  std::vector<DictionaryEquation> const& equations = dictionary.source().dictionary.equations;
  std::vector<WholeDictionary::Column> const& own = dictionary.columns();
  std::optional<OutsideEquation> best;
  for (std::size_t e = 0; e < equations.size() && !interrupted(); ++e) {
    int const driven = driven_state(dictionary, lead.terms, e);
    if (driven < 0) continue;
    std::vector<OutsideFunction> const functions = outside_functions(states, terms_of_states(dictionary, e, states));
    if (functions.empty() || own.size() + functions.size() > most_columns) continue;
    LinearisedMotion const motion = extended(parts, drive.columns(functions, driven), shared_odds(dictionary, e, functions));
    Terms others;
    for (int const j : lead.terms)
      if (own[static_cast<std::size_t>(j)].equation != e || own[static_cast<std::size_t>(j)].always) others.push_back(j);
    std::size_t const most = std::max<std::size_t>(lead.terms.size() - others.size(), 2);
    std::vector<Terms> from = built_up(motion, others, most);
    from.insert(from.end(), near.begin(), near.end());
    from.push_back(lead.terms);
    std::erase_if(from, [&](Terms const& terms) {
      return std::any_of(terms.begin(), terms.end(), [&](int j) { return !motion.usable(j); });
    });
    WeighedTerms const* outside = nullptr;
    WeighedTerms const* inside = nullptr;
    std::vector<WeighedTerms> const weighed = best_terms(motion, from);
    auto const is_outside = [&](int j) { return j >= static_cast<int>(own.size()); };
    for (WeighedTerms const& each : weighed) {
      WeighedTerms const*& place = std::any_of(each.terms.begin(), each.terms.end(), is_outside) ? outside : inside;
      if (place == nullptr) place = &each;
    }
    if (outside == nullptr || inside == nullptr) continue;
    if (inside->squares < within_bounds * parts.settings.samples * parts.settings.floor) continue;
    double const log_odds = outside->score - inside->score;
    if (best && best->log_odds >= log_odds) continue;
    OutsideEquation form{.text = "",
                         .log_odds = log_odds,
                         .log_likelihood = outside->log_likelihood - inside->log_likelihood,
                         .coefficients = static_cast<int>(std::ssize(outside->terms) - std::ssize(inside->terms)),
                         .samples = parts.settings.samples};
    for (int const j : outside->terms) {
      auto const column = static_cast<std::size_t>(j);
      if (!is_outside(j) && own[column].equation != e) continue;
      form.text += (form.text.empty() ? equations[e].text + ": " : ", ") +
                   (is_outside(j) ? functions[column - own.size()].text : equations[e].terms[own[column].term].text);
    }
    best = std::move(form);
  }
  return best;
}

}  // namespace sysid
