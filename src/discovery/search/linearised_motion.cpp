// Moves are compared by closed forms on inner products; what is promising is weighed by QR.
#include "discovery/search/linearised_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/numeric/elementary.hpp"
#include "likelihood/segments/coefficient_prior.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double never = -std::numeric_limits<double>::infinity();
/// Squared length that a column of unit length keeps beside others, for it to be determined: differences give slopes to six digits.
constexpr double independent = 1e-12;
/// Pairs of terms are brought in for pairs as long as there are no more than so many combinations.
constexpr double most_pairs = 3e5;
constexpr int moves_of_a_kind = 4;
constexpr int moves_on_the_way = 6, kept_on_the_way = 4;  // where sets are built up
constexpr int most_expansions = 40, idle_expansions = 8;
/// What is less probable than the best by this, in log, is not looked at further.
constexpr double hopeless = 15;

/// The best few of one kind.
class Best {
 public:
  explicit Best(int most) : most_(static_cast<std::size_t>(most)) {}
  double worst() const { return moves_.size() < most_ ? std::numeric_limits<double>::infinity() : moves_.back().squares; }
  void offer(double squares, std::vector<int> out, std::vector<int> in) {
    auto const place = std::upper_bound(moves_.begin(), moves_.end(), squares,
                                        [](double value, LinearisedMotion::Move const& each) { return value < each.squares; });
    moves_.insert(place, {squares, std::move(out), std::move(in)});
    if (moves_.size() > most_) moves_.pop_back();
  }
  std::vector<LinearisedMotion::Move> const& moves() const { return moves_; }

 private:
  std::size_t most_;
  std::vector<LinearisedMotion::Move> moves_;
};

/// Least squares on some columns, and all others beside it.
struct Beside {
  Eigen::MatrixXd gram;      // [K x K] of the columns without their parts along the terms
  Eigen::VectorXd dots;      // [K] with the residual
  Eigen::MatrixXd along;     // [p x K] of each column along what a term alone explains
  Eigen::VectorXd estimate;  // [p] the residual along it when the term goes
  Eigen::MatrixXd inverse;   // [p x p]
  double squares = 0;
};

/// Directions that come free when terms go, orthonormal: their products with the columns and with the residual.
struct Freed {
  std::vector<Eigen::RowVectorXd> along;
  std::vector<double> residual;
  double rise = 0;

  void add(Beside const& beside, int first, int second = -1) {
    auto const unit = [&](int i) {
      double const norm = std::sqrt(beside.inverse(i, i));
      return std::pair(Eigen::RowVectorXd(beside.along.row(i) / norm), beside.estimate(i) / norm);
    };
    auto [row, part] = unit(first);
    along.push_back(row);
    residual.push_back(part);
    rise += part * part;
    if (second < 0) return;
    auto [other, other_part] = unit(second);
    double const angle = beside.inverse(first, second) / std::sqrt(beside.inverse(first, first) * beside.inverse(second, second));
    double const rest = std::sqrt(std::max(1 - angle * angle, 1e-30));
    along.push_back((other - angle * row) / rest);
    residual.push_back((other_part - angle * part) / rest);
    rise += residual.back() * residual.back();
  }
};

/// columns: all of them, whose products with each other are `products`; terms: those of the least squares.
Beside beside_of(Eigen::MatrixXd const& columns, Eigen::VectorXd const& known, Eigen::MatrixXd const& products,
                 Terms const& terms) {
  auto const p = static_cast<Eigen::Index>(terms.size());
  if (p == 0) return {products, columns.transpose() * known, {}, {}, {}, known.squaredNorm()};
  Beside beside;
  Eigen::MatrixXd chosen(columns.rows(), p);
  for (Eigen::Index i = 0; i < p; ++i) chosen.col(i) = columns.col(terms[static_cast<std::size_t>(i)]);
  OrthogonalTriangular const factored(chosen);
  Eigen::MatrixXd const basis = factored.basis(), triangle = factored.triangle();
  Eigen::MatrixXd const onto = basis.transpose() * columns;
  Eigen::VectorXd const part = basis.transpose() * known;
  Eigen::VectorXd residual = known - basis * part;
  residual -= basis * (basis.transpose() * residual).eval();
  beside.gram = products - onto.transpose() * onto;
  beside.dots = columns.transpose() * residual;
  Eigen::MatrixXd const inverse = solve_upper(triangle, Eigen::MatrixXd::Identity(p, p));
  beside.inverse = inverse * inverse.transpose();
  beside.along = inverse * onto;
  beside.estimate = inverse * part;
  beside.squares = residual.squaredNorm();
  return beside;
}

/// The best of the moves that take up to two terms out and up to two others in: so many of each kind.
class BestMoves {
 public:
  /// others: columns that may come in.
  BestMoves(Beside const& beside, std::vector<int> others, int most)
      : beside_(beside),
        others_(std::move(others)),
        best_{{{Best(most), Best(most), Best(most)}, {Best(most), Best(most), Best(most)}, {Best(most), Best(most), Best(most)}}} {}

  double pairs() const { return static_cast<double>(others_.size()) * static_cast<double>(others_.size()) / 2; }

  /// Where the terms `out` go, with what comes free.
  void consider(Freed const& freed, std::vector<int> const& out, bool with_pairs) {
    double const base = beside_.squares + freed.rise;
    std::array<Best, 3>& kinds = best_[out.size()];
    if (!out.empty() && base < kinds[0].worst()) kinds[0].offer(base, out, {});
    std::vector<double> norms, dots;
    for (int const j : others_) {
      double norm = beside_.gram(j, j), dot = beside_.dots(j);
      for (std::size_t f = 0; f < freed.along.size(); ++f) {
        norm += freed.along[f](j) * freed.along[f](j);
        dot += freed.along[f](j) * freed.residual[f];
      }
      norms.push_back(norm);
      dots.push_back(dot);
      double const squares = base - dot * dot / norm;
      if (squares < kinds[1].worst()) kinds[1].offer(squares, out, {j});
    }
    if (with_pairs) consider_pairs(freed, out, norms, dots);
  }

  std::vector<LinearisedMotion::Move> all() const {
    std::vector<LinearisedMotion::Move> all;
    for (auto const& kinds : best_)
      for (Best const& each : kinds) all.insert(all.end(), each.moves().begin(), each.moves().end());
    return all;
  }

 private:
  void consider_pairs(Freed const& freed, std::vector<int> const& out, std::vector<double> const& norms,
                      std::vector<double> const& dots) {
    double const base = beside_.squares + freed.rise;
    Best& kind = best_[out.size()][2];
    for (std::size_t a = 0; a < others_.size(); ++a)
      for (std::size_t b = a + 1; b < others_.size(); ++b) {
        double cross = beside_.gram(others_[a], others_[b]);
        for (Eigen::RowVectorXd const& row : freed.along) cross += row(others_[a]) * row(others_[b]);
        double const determinant = norms[a] * norms[b] - cross * cross;
        if (!(determinant > independent * norms[a])) continue;
        double const gain =
            (dots[a] * dots[a] * norms[b] - 2 * dots[a] * dots[b] * cross + dots[b] * dots[b] * norms[a]) / determinant;
        if (base - gain < kind.worst()) kind.offer(base - gain, out, {others_[a], others_[b]});
      }
  }

  Beside const& beside_;
  std::vector<int> others_;
  std::array<std::array<Best, 3>, 3> best_;  // by terms that go, and that come
};

}  // namespace

LinearisedMotion::LinearisedMotion(std::vector<SegmentSlopes> const& slopes, Eigen::VectorXd const& at, Settings settings)
    : settings_(std::move(settings)), at_(at) {
  Eigen::Index const k = at.size();
  usable_.assign(static_cast<std::size_t>(k), 1);
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index rows = 0;
  for (SegmentSlopes each : slopes) {
    for (Eigen::Index j = 0; j < k; ++j)
      if (!each.by_coefficient.col(j).allFinite()) {
        usable_[static_cast<std::size_t>(j)] = 0;
        each.by_coefficient.col(j).setZero();
      }
    segments_.push_back(eliminate(each, 0));
    parts.push_back(std::move(segments_.back().left));
    rows += parts.back().rows();
  }
  Eigen::MatrixXd all(rows, k + 1);
  rows = 0;
  for (Eigen::MatrixXd const& part : parts) {
    all.middleRows(rows, part.rows()) = part;
    rows += part.rows();
  }
  if (rows > 2 * (k + 1)) all = OrthogonalTriangular(all).triangle();
  known_ = all.leftCols(k) * at - all.col(k);
  columns_ = all.leftCols(k);
  length_ = columns_.colwise().norm().transpose();
  for (Eigen::Index j = 0; j < k; ++j) {
    if (!(length_(j) > 0)) usable_[static_cast<std::size_t>(j)] = 0;
    if (usable_[static_cast<std::size_t>(j)] == 0) {
      length_(j) = 1;
      columns_.col(j).setZero();
    }
    columns_.col(j) /= length_(j);
  }
  products_ = columns_.transpose() * columns_;
}

double LinearisedMotion::log_prior(Terms const& terms) const {
  double sum = 0;
  for (int const j : terms)
    if (!always(j)) sum += settings_.log_odds[static_cast<std::size_t>(j)];
  return sum;
}

Eigen::MatrixXd LinearisedMotion::start_moves(WeighedTerms const& terms) const {
  Eigen::VectorXd move = -at_;
  for (std::size_t i = 0; i < terms.terms.size(); ++i) move(terms.terms[i]) += terms.coefficients(static_cast<Eigen::Index>(i));
  Eigen::MatrixXd starts(segments_.front().upper.rows(), static_cast<Eigen::Index>(segments_.size()));
  for (std::size_t s = 0; starts.rows() > 0 && s < segments_.size(); ++s)
    starts.col(static_cast<Eigen::Index>(s)) = segments_[s].start(move);
  return starts;
}

WeighedTerms LinearisedMotion::weigh(Terms terms) const {
  WeighedTerms out{std::move(terms), never, never, 0, {}};
  auto const p = static_cast<Eigen::Index>(out.terms.size());
  Eigen::MatrixXd chosen(columns_.rows(), p + 1);
  if (chosen.rows() <= p) return out;
  for (Eigen::Index i = 0; i < p; ++i) chosen.col(i) = columns_.col(out.terms[static_cast<std::size_t>(i)]);
  chosen.col(p) = known_;
  Eigen::MatrixXd const triangle = OrthogonalTriangular(chosen).triangle();
  for (Eigen::Index i = 0; i < p; ++i)
    if (!(triangle(i, i) * triangle(i, i) > independent)) return out;
  double const squares = out.squares = triangle(p, p) * triangle(p, p), n = settings_.samples;
  double const variance = std::max(squares / n, settings_.floor);
  Eigen::VectorXd const scaled = solve_upper(triangle.topLeftCorner(p, p), triangle.topRightCorner(p, 1));
  out.coefficients.resize(p);
  for (Eigen::Index i = 0; i < p; ++i) out.coefficients(i) = scaled(i) / length_(out.terms[static_cast<std::size_t>(i)]);
  out.log_likelihood = -n / 2 * elementary::log(variance) - squares / (2 * variance);
  out.score = out.log_likelihood +
              log_coefficient_weight(scaled, triangle.topLeftCorner(p, p) / std::sqrt(variance), settings_.signal) +
              log_prior(out.terms);
  return out;
}

std::vector<LinearisedMotion::Move> LinearisedMotion::moves(Terms const& terms, int most) const {
  Beside const beside = beside_of(columns_, known_, products_, terms);
  std::vector<int> others, droppable;
  for (int j = 0; j < columns_.cols(); ++j)
    if (usable(j) && !std::binary_search(terms.begin(), terms.end(), j) && beside.gram(j, j) > independent) others.push_back(j);
  for (std::size_t i = 0; i < terms.size(); ++i)
    if (!always(terms[i])) droppable.push_back(static_cast<int>(i));
  BestMoves best(beside, std::move(others), most);
  auto const count = static_cast<double>(droppable.size());
  double const pairs = best.pairs();
  best.consider({}, {}, true);
  for (std::size_t a = 0; a < droppable.size(); ++a) {
    Freed one;
    one.add(beside, droppable[a]);
    best.consider(one, {terms[static_cast<std::size_t>(droppable[a])]}, count * pairs <= most_pairs);
    for (std::size_t b = a + 1; b < droppable.size(); ++b) {
      Freed two;
      two.add(beside, droppable[a], droppable[b]);
      best.consider(two, {terms[static_cast<std::size_t>(droppable[a])], terms[static_cast<std::size_t>(droppable[b])]},
                    count * count / 2 * pairs <= most_pairs);
    }
  }
  return best.all();
}

std::vector<Terms> built_up(LinearisedMotion const& motion, Terms const& others, std::size_t most) {
  std::vector<Terms> all = {others};
  std::set<Terms> seen = {others};
  std::vector<std::vector<std::pair<double, Terms>>> levels(most + 1);  // by the number of terms more
  levels.front().emplace_back(0, others);
  for (std::size_t more = 0; more < most; ++more) {
    auto& level = levels[more];
    std::stable_sort(level.begin(), level.end(), [](auto const& a, auto const& b) { return a.first < b.first; });
    if (level.size() > kept_on_the_way) level.resize(kept_on_the_way);
    for (auto const& [left, from] : level)
      for (LinearisedMotion::Move const& move : motion.moves(from, moves_on_the_way)) {
        std::size_t const size = more + move.in.size();
        if (!move.out.empty() || move.in.empty() || size > most) continue;
        Terms grown = from;
        grown.insert(grown.end(), move.in.begin(), move.in.end());
        std::sort(grown.begin(), grown.end());
        if (!seen.insert(grown).second) continue;
        all.push_back(grown);
        levels[size].emplace_back(move.squares, std::move(grown));
      }
  }
  return all;
}

std::vector<WeighedTerms> best_terms(LinearisedMotion const& motion, std::vector<Terms> const& from) {
  std::map<Terms, WeighedTerms> known;
  std::set<Terms> expanded;
  auto const weigh = [&](Terms terms) {
    if (!known.contains(terms)) {
      WeighedTerms weighed = motion.weigh(terms);
      known.emplace(std::move(terms), std::move(weighed));
    }
  };
  for (Terms const& each : from) weigh(each);
  double best = never;
  for (int count = 0, idle = 0; count < most_expansions && idle < idle_expansions; ++count) {
    WeighedTerms const* next = nullptr;
    for (auto const& [terms, weighed] : known)
      if (!expanded.contains(terms) && (next == nullptr || weighed.score > next->score)) next = &weighed;
    if (next == nullptr || !(next->score > best - hopeless)) break;
    idle = next->score > best ? 0 : idle + 1;
    best = std::max(best, next->score);
    Terms const terms = next->terms;
    expanded.insert(terms);
    for (LinearisedMotion::Move const& move : motion.moves(terms, moves_of_a_kind)) {
      Terms moved;
      for (int const j : terms)
        if (std::find(move.out.begin(), move.out.end(), j) == move.out.end()) moved.push_back(j);
      moved.insert(moved.end(), move.in.begin(), move.in.end());
      std::sort(moved.begin(), moved.end());
      weigh(std::move(moved));
    }
  }
  std::vector<WeighedTerms> all;
  for (auto& [terms, weighed] : known)
    if (weighed.score > never) all.push_back(std::move(weighed));
  std::stable_sort(all.begin(), all.end(), [](WeighedTerms const& a, WeighedTerms const& b) { return a.score > b.score; });
  return all;
}

}  // namespace sysid
