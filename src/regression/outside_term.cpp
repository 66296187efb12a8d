// By least squares on the rows of the dictionary, freed of the moving average that was found.
#include "regression/outside_term.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/text/number.hpp"
#include "linear_algebra/decompositions.hpp"
#include "regression/column/signals.hpp"

namespace sysid::regression {
namespace {

constexpr double clearly_better = 10;    // nats
constexpr double rounding_alone = 1e-8;  // of the known side
constexpr double same_column = 1e-6;     // squared sine of the angle to a term of the dictionary

/// A sample that terms read, and what it is called.
struct Sample {
  NodeId leaf;
  std::string name;
};

std::vector<Sample> samples_read(Dictionary const& dictionary, Equation const& stated, std::vector<NodeId> const& roots) {
  std::vector<Sample> samples;
  for (Symbol const& symbol : symbols_below(dictionary, roots)) {
    auto const alone =
        std::find_if(stated.terms.begin(), stated.terms.end(), [&](Term const& each) { return each.expression == symbol.leaf; });
    if (alone != stated.terms.end())
      samples.push_back({symbol.leaf, alone->name});
    else if (symbol.kind == Symbol::Kind::state)
      samples.push_back(
          {symbol.leaf, fmt::format("lag({}, {})", dictionary.states[static_cast<std::size_t>(symbol.index)], symbol.lag)});
  }
  return samples;
}

/// What is offered beside a dictionary, as expressions of its graph.
class OutsideTerms {
 public:
  explicit OutsideTerms(Graph& graph) : graph_(graph) {}

  void of_one(Sample const& a) {
    for (int power = 1; power <= 5; ++power) add(powered(a.name, power), power_of(a.leaf, power));
    NodeId const size = graph_.unary(Operation::absolute, a.leaf);
    add(fmt::format("abs({})", a.name), size);
    add(fmt::format("abs({0})*{0}", a.name), graph_.multiply(size, a.leaf));
  }
  void of_two(Sample const& a, Sample const& b) {
    for (int first = 1; first <= 3; ++first)
      for (int second = 1; first + second <= 4; ++second)
        add(powered(a.name, first) + "*" + powered(b.name, second),
            graph_.multiply(power_of(a.leaf, first), power_of(b.leaf, second)));
    add(fmt::format("abs({})*{}", a.name, b.name), graph_.multiply(graph_.unary(Operation::absolute, a.leaf), b.leaf));
    add(fmt::format("abs({})*{}", b.name, a.name), graph_.multiply(graph_.unary(Operation::absolute, b.leaf), a.leaf));
  }
  std::vector<Term> const& terms() const { return terms_; }

 private:
  static std::string powered(std::string const& name, int power) { return power == 1 ? name : fmt::format("{}^{}", name, power); }
  NodeId power_of(NodeId leaf, int power) { return power == 1 ? leaf : graph_.power(leaf, graph_.constant(power)); }
  void add(std::string name, NodeId expression) { terms_.push_back({std::move(name), expression}); }

  Graph& graph_;
  std::vector<Term> terms_;
};

/// As many as `most` columns: of single samples, and of pairs of those that the chosen terms read, if all of these fit.
std::vector<Term> offered_terms(Dictionary& wider, Equation const& stated, FoundEquation const& found, double most) {
  std::vector<NodeId> all, kept;
  for (Term const& term : stated.terms) all.push_back(term.expression);
  for (int const j : found.chosen.terms) kept.push_back(stated.terms[static_cast<std::size_t>(j)].expression);
  OutsideTerms outside(wider.graph);
  for (Sample const& each : samples_read(wider, stated, all)) outside.of_one(each);
  std::vector<Sample> const chosen = samples_read(wider, stated, kept);
  double const ones = static_cast<double>(outside.terms().size()), read = static_cast<double>(chosen.size());
  if (ones > most) return {};
  if (ones + 8 * read * (read - 1) / 2 <= most)
    for (std::size_t a = 0; a < chosen.size(); ++a)
      for (std::size_t b = a + 1; b < chosen.size(); ++b) outside.of_two(chosen[a], chosen[b]);
  return outside.terms();
}

/// Half of what the squares of the rows fall by, in nats, with one column more; columns without what the kept ones explain.
double gain_of(Eigen::VectorXd const& rest, Eigen::VectorXd const& column) {
  double const along = rest.dot(column), share = along * along / (rest.squaredNorm() * column.squaredNorm());
  return -0.5 * static_cast<double>(rest.size()) * elementary::log1p(-std::min(share, 1 - 1e-12));
}

}  // namespace

std::optional<Concern> outside_term(Dictionary const& dictionary, std::span<Experiment const> experiments, Method const& method,
                                    int equation, FoundEquation const& found, double most_numbers) {
  Equation const& stated = dictionary.equations[static_cast<std::size_t>(equation)];
  if (found.chosen.terms.empty()) return std::nullopt;
  auto const interrupted = [&] { return method.interrupted && method.interrupted(); };
  Dictionary wider = dictionary;
  Equation offered{stated.name, stated.known, {}};
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(stated.terms.size()));
  for (std::size_t k = 0; k < found.chosen.terms.size(); ++k) {
    offered.terms.push_back(stated.terms[static_cast<std::size_t>(found.chosen.terms[k])]);
    coefficients(static_cast<Eigen::Index>(k)) = found.chosen.coefficient(static_cast<Eigen::Index>(k));
  }
  auto const kept = static_cast<Eigen::Index>(offered.terms.size());
  for (std::size_t j = 0; j < stated.terms.size(); ++j)
    if (!found.terms[j].kept && !found.terms[j].excluded) offered.terms.push_back(stated.terms[j]);
  auto const inside = static_cast<Eigen::Index>(offered.terms.size());
  double const most = most_numbers / std::max(1.0, static_cast<double>(found.rows)) - static_cast<double>(inside);
  std::vector<Term> const outside = offered_terms(wider, stated, found, most);
  if (outside.empty()) return std::nullopt;
  offered.terms.insert(offered.terms.end(), outside.begin(), outside.end());
  coefficients.conservativeResizeLike(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(offered.terms.size())));
  wider.equations = {offered};
  std::unique_ptr<Projection> const projection = method.form->project(wider, experiments, method.form_settings);
  NoiseOfEquation const* const noise = projection->noise_of_equation();
  if (noise == nullptr || any_fatal(projection->concerns(0)) || interrupted()) return std::nullopt;
  Columns const rows = noise->whitened(0, coefficients, static_cast<int>(found.moving_average.size()));
  Eigen::Index const left = rows.known.size() - kept;
  if (left < 4 * kept || !rows.terms.leftCols(kept).allFinite() || interrupted()) return std::nullopt;
  OrthogonalTriangular const decomposed(rows.terms.leftCols(kept));
  Eigen::VectorXd const rest = decomposed.turned(rows.known).bottomRows(left);
  Eigen::MatrixXd const turned = decomposed.turned(rows.terms);
  auto const others = turned.bottomRightCorner(left, rows.terms.cols() - kept);  // a view: there are many numbers
  if (!(rest.norm() > rounding_alone * rows.known.norm())) return std::nullopt;

  auto const explained = [&](Eigen::Index j) {  // by the kept terms: nothing but rounding would be left of the column
    double const own = others.col(j).norm();
    return !std::isfinite(own) || own < 1e-6 * rows.terms.col(kept + j).norm();
  };
  double of_dictionary = 0, best = 0;
  Eigen::Index which = -1;
  for (Eigen::Index j = 0; j < others.cols(); ++j) {
    if (explained(j)) continue;
    Eigen::VectorXd const column = others.col(j);
    double const gain = gain_of(rest, column);
    if (j < inside - kept) {
      of_dictionary = std::max(of_dictionary, gain);
      continue;
    }
    if (!(gain > best)) continue;
    bool offered_already = false;
    for (Eigen::Index i = 0; i < inside - kept && !offered_already; ++i) {
      double const along = others.col(i).dot(column);
      offered_already = along * along > (1 - same_column) * others.col(i).squaredNorm() * column.squaredNorm();
    }
    if (!offered_already) best = gain, which = j;
  }
  double const tried = elementary::log(static_cast<double>(outside.size())),
               counted = 0.5 * elementary::log(static_cast<double>(left));
  if (which < 0 || best - counted - tried < clearly_better || best - of_dictionary < clearly_better) return std::nullopt;
  Concern concern{.kind = Concern::Kind::outside_better, .value = best};
  concern.clause = fmt::format(
      "with `{}`, which is not in the dictionary, the equation describes the record far better: its log likelihood is {} "
      "higher, with 1 coefficient more",
      offered.terms[static_cast<std::size_t>(kept + which)].name, significant(best, 2));
  return concern;
}

}  // namespace sysid::regression
