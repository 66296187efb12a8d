// Every support weighed by depth-first orthogonalisation, or Gibbs chains over supports; then the same summary of what was weighed.
#include "regression/choice/spike_slab.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/numeric/elementary.hpp"
#include "core/numeric/random.hpp"
#include "regression/choice/triangle.hpp"
#include "regression/choice/weighed_supports.hpp"

namespace sysid::regression::spike_slab {
namespace {

constexpr SettingRow rows[] = {
    {"prior", SettingKind::word, "beta_prime", 0, 0, "beta_prime unit_information zellner",
     "prior of the coefficients; zellner: normal about zero; unit_information: normal about the estimate of the coefficients "
     "(variance "
     "of both: see g); beta_prime: as zellner, with an unknown g"},
    {"g", SettingKind::real, "0", 0, 1e300, "",
     "for unit_information and zellner: prior variance divided by that of the estimate; 0: the number of rows"},
    {"sizes", SettingKind::word, "beta_binomial", 0, 0, "beta_binomial uniform",
     "prior of the number of terms; beta_binomial: every number of terms is equally probable; uniform: every set of terms is "
     "equally probable"},
    {"keep", SettingKind::real, "0.5", 0, 1, "", "inclusion probability above which a term is kept"},
    {"enumerate", SettingKind::integer, "16", 0, 24, "",
     "largest number of selectable terms for which all sets of terms are evaluated"},
    {"sweeps", SettingKind::integer, "200", 1, 1e7, "", "iterations of each Gibbs chain over all terms"},
    {"chains", SettingKind::integer, "4", 1, 1000, "", "Gibbs chains"},
    {"supports", SettingKind::integer, "10", 1, 10000, "", "number of sets of terms that are reported, best first"},
};

/// Depth first: each selectable term is either left out or made orthogonal to what follows, so a support costs J operations.
class Enumeration {
 public:
  Enumeration(Triangle const& triangle, Scale const& scale) : scale_(scale), support_(scale.selectable.size(), false) {
    std::vector<int> order = scale.always;
    order.insert(order.end(), scale.selectable.begin(), scale.selectable.end());
    Eigen::MatrixXd columns(triangle.r.rows(), static_cast<Eigen::Index>(order.size()) + 1);
    for (std::size_t k = 0; k < order.size(); ++k) columns.col(static_cast<Eigen::Index>(k)) = triangle.r.col(order[k]);
    columns.rightCols(1) = triangle.known;
    for (std::size_t k = 0; k < scale.always.size(); ++k) columns = without_first(columns);
    rest_ = triangle.rest;
    visit(columns, 0);
  }
  std::vector<Weighed> weighed;

 private:
  /// Columns after the first, made orthogonal to it (twice: once leaves what rounding made of it).
  static Eigen::MatrixXd without_first(Eigen::MatrixXd const& columns) {
    Eigen::VectorXd const direction = columns.col(0).normalized();
    Eigen::MatrixXd left = columns.rightCols(columns.cols() - 1);
    for (int pass = 0; pass < 2; ++pass) left -= direction * (direction.transpose() * left).eval();
    return left;
  }
  void visit(Eigen::MatrixXd const& columns, std::size_t term) {
    if (term == support_.size()) {
      weighed.push_back(scale_.weigh(support_, rest_ + columns.rightCols(1).squaredNorm()));
      return;
    }
    visit(columns.rightCols(columns.cols() - 1), term + 1);
    support_[term] = true;
    visit(without_first(columns), term + 1);
    support_[term] = false;
  }

  Scale const& scale_;
  Bits support_;
  double rest_ = 0;
};

/// Chains that remember what they have weighed.
class Gibbs {
 public:
  explicit Gibbs(Scale const& scale) : scale_(scale) {}

  void chain(Bits state, int sweeps, StreamKey key, std::function<bool()> const& interrupted) {
    auto const count = state.size();
    double weight = log_weight(state);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      if (interrupted && interrupted()) return;
      Stream stream(key.with_step(static_cast<std::uint64_t>(sweep)));
      for (std::size_t i = 0; i < count; ++i) {
        state[i].flip();
        double const change = log_weight(state) - weight;
        if (stream.uniform() < 1 / (1 + elementary::exp(-change)))
          weight += change;
        else
          state[i].flip();
      }
      // Terms that stand for each other change places in one move; one by one each would have to be bad first.
      for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t const a = stream.below(count), b = stream.below(count);
        double const level = stream.uniform();
        if (state[a] == state[b]) continue;
        state[a].flip(), state[b].flip();
        double const change = log_weight(state) - weight;
        if (change >= 0 || elementary::log(level) < change)
          weight += change;
        else
          state[a].flip(), state[b].flip();
      }
    }
  }

  /// In the order of their bits, so that sums over them have one order.
  std::vector<Weighed> weighed() const {
    std::vector<Weighed> all;
    all.reserve(known_.size());
    for (auto const& [support, entry] : known_) all.push_back(entry);
    std::sort(all.begin(), all.end(), [](Weighed const& a, Weighed const& b) { return a.support < b.support; });
    return all;
  }
  Bits best() const {
    std::vector<Weighed> const all = weighed();
    auto const by_weight = [](Weighed const& a, Weighed const& b) { return a.log_weight < b.log_weight; };
    return std::max_element(all.begin(), all.end(), by_weight)->support;
  }
  double log_weight(Bits const& support) {
    auto place = known_.find(support);
    if (place == known_.end()) place = known_.emplace(support, scale_.weigh(support)).first;
    return place->second.log_weight;
  }

 private:
  Scale const& scale_;
  std::unordered_map<Bits, Weighed> known_;  // hashed: a sweep asks for two sets a term, and sets of bits compare bit by bit
};

std::vector<Weighed> sample(LinearProblem const& problem, Triangle const& triangle, Scale const& scale, Settings const& settings,
                            SelectorContext const& context) {
  Gibbs gibbs(scale);
  auto const count = scale.selectable.size();
  // Starts: every support of backward elimination is weighed, the first chain begins at the best of them; the second begins without
  // any term, the others with one in five at random.
  for (Elimination const& step : eliminate(triangle, problem.always)) {
    Bits support(count, false);
    for (std::size_t i = 0; i < count; ++i)
      support[i] = std::binary_search(step.terms.begin(), step.terms.end(), scale.selectable[i]);
    gibbs.log_weight(support);
  }
  Bits const best = gibbs.best();
  for (int chain = 0; chain < static_cast<int>(settings.integer("chains")); ++chain) {
    StreamKey const key{context.seed, Purpose::supports, (context.equation << 32) + static_cast<std::uint64_t>(chain), 0};
    Bits start(count, false);
    if (chain == 0) start = best;
    if (chain >= 2) {
      Stream stream(key.with_step(~std::uint64_t{0}));
      for (std::size_t i = 0; i < count; ++i) start[i] = stream.uniform() < 0.2;
    }
    gibbs.chain(std::move(start), static_cast<int>(settings.integer("sweeps")), key, context.interrupted);
  }
  return gibbs.weighed();
}

}  // namespace

std::span<SettingRow const> settings() { return rows; }

Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context) {
  Triangle const triangle = reduce(problem);
  Scale const scale(problem, triangle, settings);
  Choice choice;
  choice.exact = static_cast<std::int64_t>(scale.selectable.size()) <= settings.integer("enumerate");
  std::vector<Weighed> weighed =
      choice.exact ? Enumeration(triangle, scale).weighed : sample(problem, triangle, scale, settings, context);
  choice.iterations = static_cast<int>(weighed.size());
  std::stable_sort(weighed.begin(), weighed.end(), [](Weighed const& a, Weighed const& b) { return a.log_weight > b.log_weight; });
  double sum = 0;
  for (Weighed& entry : weighed) sum += entry.probability = elementary::exp(entry.log_weight - weighed.front().log_weight);
  for (Weighed& entry : weighed) entry.probability /= sum;
  summarise(problem, triangle, scale, std::move(weighed), settings, choice);
  return choice;
}

}  // namespace sysid::regression::spike_slab
