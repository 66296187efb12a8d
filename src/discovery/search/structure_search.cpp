// One linearisation serves all structures near the leading one.
#include "discovery/search/structure_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "discovery/search/linearised_motion.hpp"
#include "discovery/search/record_noise.hpp"
#include "discovery/simulated_structure.hpp"
#include "discovery/validation_rows.hpp"
#include "likelihood/segments/segment_differences.hpp"
#include "likelihood/segments/segment_noise.hpp"
#include "likelihood/segments/segment_starts.hpp"
#include "likelihood/segments/shooting.hpp"
#include "simulate/thread_pool.hpp"

namespace sysid {
namespace {

constexpr int most_rounds = 8;   // of linearisations at one length of segments
constexpr int batch = 3;         // structures that are fitted before the leading one is chosen again
constexpr int most_batches = 4;  // about one point, as long as the linearisation finds better ones
constexpr double enough = 1e-2;  // gain of log likelihood in fits
constexpr int most_fit_rounds = 30;
constexpr double joinable_growth = 1.5;  // of a residual when segments are joined
constexpr double least_accuracy = 1e-8;  // of a channel's size: what simulations are trusted to
constexpr double step_error = 0.1;       // of the noise, that the integrator may be off by
constexpr int most_substeps = 16;
constexpr double most_work = 2e7;  // simulated rows of a linearisation
constexpr int least_segment = 8;   // rows, where every state is measured
constexpr int most_segments = 64;  // of each experiment then

/// A structure fitted by multiple shooting.
struct Fitted {
  Terms terms;
  ShootingFit fit;
  double score = -std::numeric_limits<double>::infinity();
  bool usable() const { return fit.finite && fit.determined; }
};

/// Terms of all equations in one row.
struct Column {
  std::size_t equation, term;
  int parameter;
  bool always;
};

/// The rounding of samples as a part of their root mean square.
double relative_rounding(std::vector<double> const& samples) {
  double squares = 0;
  for (double const y : samples) squares += y * y;
  return squares > 0 ? rounding_sd(samples) / std::sqrt(squares / static_cast<double>(samples.size())) : 0;
}

class Searcher {
 public:
  Searcher(FoundSource const& source, std::function<bool()> const& interrupted)
      : source_(source),
        interrupted_(interrupted),
        pool_(make_pool(source.execution)),
        whole_(whole_model()),
        rows_(validation_rows(source.data, {}, std::max(1, static_cast<int>(whole_.states.size())), source.discovery.half_width)),
        guess_(source.dictionary.numbers, rows_.records, source.discovery.noise_sd) {
    if (!whole_.failure.empty()) return;
    for (std::size_t c = 0; c < whole_.channels.size(); ++c) {
      std::vector<double> all;
      for (Experiment const& each : records()) all.insert(all.end(), each.measured[c].begin(), each.measured[c].end());
      rounding_.push_back(rounding_sd(all));
    }
    for (std::size_t i = 0; i < whole_.inputs.size(); ++i) {
      std::vector<double> all;
      for (Experiment const& each : records())
        for (std::size_t row = 0; row < each.time.size(); ++row) all.push_back(each.inputs[i].sample(static_cast<int>(row)));
      input_rounding_ = std::max(input_rounding_, relative_rounding(all));
    }
    growth_.assign(whole_.channels.size(), 0);
    least_ = rows_.least;
    if (every_state_measured()) {
      least_ = std::max(least_segment, 2 * static_cast<int>(whole_.states.size() + 1));
      for (Experiment const& each : rows_.records) least_ = std::max(least_, static_cast<int>(each.time.size()) / most_segments);
      least_ = std::min(least_, rows_.least);
    }
    for (Experiment const& each : rows_.records) halved_ = std::max(halved_, halvings(static_cast<int>(each.time.size()), least_));
    substeps_ = whole_.solver.substeps;
  }

  bool possible() const {
    if (!whole_.failure.empty() || !whole_.solver.row().in_program || !whole_.solver.fixed_step()) return false;
    double count = 0;
    for (Experiment const& each : rows_.records) count += static_cast<double>(each.time.size());
    return count * static_cast<double>(1 + columns_.size() + whole_.states.size()) < most_work;
  }

  /// From the best of the structures that stay finite.
  bool begin(std::vector<FoundStructure> const& listed) {
    for (FoundStructure const& each : listed) {
      Terms const terms = terms_of(each);
      std::vector<Segment> const parts = segments();
      Eigen::VectorXd coefficients(static_cast<Eigen::Index>(terms.size()));
      for (std::size_t i = 0; i < terms.size(); ++i) coefficients(static_cast<Eigen::Index>(i)) = listed_value(each, terms[i]);
      ShootingPoint point{Eigen::VectorXd(), whole_.starts(parts, guess_)};
      std::vector<double> noise;
      for (std::size_t const c : whole_.channels) noise.push_back(source_.discovery.noise_sd[c]);
      fit_starts(simulation({}, &terms, &coefficients), point, noise, interrupted_);
      point.coefficients = coefficients;
      Fitted first = fitted(terms, point);
      if (first.usable() && first.score > lead_.score) lead_ = std::move(first);
    }
    if (!lead_.usable()) return false;
    settle_step();
    return true;
  }

  void run(std::vector<FoundStructure> const& listed) {
    for (FoundStructure const& each : listed) listed_.push_back(terms_of(each));
    search();
    if (settle_noise()) search();
    while (halved_ > 0 && !interrupted_() && climb()) {
    }
    if (settle_noise()) search();
  }

  /// What is better than the regression's list, and the list's own best.
  void report(std::vector<FoundStructure> const& listed, int most, StructureSearch& out) const;

 private:
  ValidatedModel whole_model() {
    CheckedDictionary const& dictionary = source_.dictionary;
    FoundStructure all;
    std::deque<regression::Support> supports;
    for (std::size_t e = 0; e < dictionary.equations.size(); ++e) {
      regression::Support& support = supports.emplace_back();
      std::vector<DictionaryTerm> const& terms = dictionary.equations[e].terms;
      for (std::size_t j = 0; j < terms.size(); ++j)
        if (is_offered(source_.discovery.equations[e], j)) support.terms.push_back(static_cast<int>(j));
      auto const count = static_cast<Eigen::Index>(support.terms.size());
      support.coefficient = Eigen::VectorXd::Ones(count);
      support.covariance = Eigen::MatrixXd::Identity(count, count);
      all.equations.push_back(&support);
    }
    ValidatedModel model = validated_model(source_, all);
    for (ValidatedModel::Coefficient const& each : model.coefficients)
      columns_.push_back(
          {each.equation, each.term, each.parameter, dictionary.equations[each.equation].terms[each.term].in_target});
    return model;
  }

  std::vector<Experiment> records() const {
    std::vector<Experiment> own;
    for (Experiment const& each : rows_.records) own.push_back(whole_.view(each));
    return own;
  }
  std::vector<Segment> segments() const { return cut_into_segments(rows_.records, least_, halved_); }

  Terms terms_of(FoundStructure const& structure) const {
    Terms terms;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      std::vector<int> const& in = structure.equations[columns_[j].equation]->terms;
      if (std::binary_search(in.begin(), in.end(), static_cast<int>(columns_[j].term))) terms.push_back(static_cast<int>(j));
    }
    return terms;
  }
  double listed_value(FoundStructure const& structure, int column) const {
    Column const& of = columns_[static_cast<std::size_t>(column)];
    regression::Support const& support = *structure.equations[of.equation];
    auto const place = std::lower_bound(support.terms.begin(), support.terms.end(), static_cast<int>(of.term));
    return support.coefficient(place - support.terms.begin());
  }

  // Of the terms that are fitted; held: others at these values. All that is neither is out.
  SegmentSimulation simulation(Terms const& terms, Terms const* held = nullptr, Eigen::VectorXd const* values = nullptr,
                               int substeps = 0) const {
    SegmentSimulation::Settings settings{{}, whole_.others, 0, whole_.solver, source_.execution, pool_, whole_.centres, noise_};
    settings.solver.substeps = substeps > 0 ? substeps : substeps_;
    for (Column const& each : columns_) settings.others[static_cast<std::size_t>(each.parameter)] = 0;
    for (std::size_t i = 0; held != nullptr && i < held->size(); ++i)
      settings.others[static_cast<std::size_t>(columns_[static_cast<std::size_t>((*held)[i])].parameter)] =
          (*values)(static_cast<Eigen::Index>(i));
    for (int const j : terms) settings.fitted.push_back(columns_[static_cast<std::size_t>(j)].parameter);
    return SegmentSimulation(whole_.compiled, records(), segments(), std::move(settings));
  }

  double log_prior(Terms const& terms) const {
    std::vector<int> offered(source_.dictionary.equations.size(), 0), taken = offered;
    for (Column const& each : columns_) offered[each.equation] += each.always ? 0 : 1;
    for (int const j : terms) {
      Column const& each = columns_[static_cast<std::size_t>(j)];
      taken[each.equation] += each.always ? 0 : 1;
    }
    double sum = 0;
    for (std::size_t e = 0; e < offered.size(); ++e)
      for (int i = 1; i <= taken[e]; ++i) sum -= elementary::log(static_cast<double>(offered[e] - taken[e] + i) / i);
    return sum;
  }

  Fitted fitted(Terms const& terms, ShootingPoint from) const {
    Fitted out;
    out.terms = terms;
    out.fit = fit_by_shooting(simulation(terms), std::move(from),
                              {.gain = enough, .most_rounds = most_fit_rounds, .interrupted = interrupted_});
    if (out.usable()) out.score = out.fit.log_evidence + log_prior(terms);
    return out;
  }

  Eigen::VectorXd spread(Fitted const& of) const {
    Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(columns_.size()));
    for (std::size_t i = 0; i < of.terms.size(); ++i) all(of.terms[i]) = of.fit.point.coefficients(static_cast<Eigen::Index>(i));
    return all;
  }

  // About the leading structure, by every coefficient of the dictionary.
  LinearisedMotion linearised() {
    Terms all;
    for (std::size_t j = 0; j < columns_.size(); ++j) all.push_back(static_cast<int>(j));
    SegmentSimulation const simulation = this->simulation(all);
    ShootingPoint const point{spread(lead_), lead_.fit.point.starts};
    SegmentDifferences differences(simulation, point);
    std::vector<SegmentSlopes> const slopes = differences.at(point, most_probes);
    std::vector<double> const noise = noise_of(simulation, squares_of(simulation, slopes), 0);
    LinearisedMotion::Settings settings;
    for (int c = 0; c < simulation.channels(); ++c) {
      double const n = simulation.samples_of_channel(c), ratio = simulation.least_noise(c) / noise[static_cast<std::size_t>(c)];
      settings.samples += n;
      settings.floor += n * ratio * ratio;
    }
    settings.floor /= settings.samples;
    settings.signal = signal_of(simulation, noise);
    for (Column const& each : columns_) {
      settings.equations.push_back(static_cast<int>(each.equation));
      settings.always.push_back(each.always ? 1 : 0);
    }
    return LinearisedMotion(weighted(simulation, slopes, noise), point.coefficients, std::move(settings));
  }

  // Linearise, fit what looks best, lead with what is; until the leading structure stays.
  void search() {
    tried_.clear();
    tried_.emplace(lead_.terms, lead_);
    for (int round = 0; round < most_rounds && !interrupted_(); ++round) {
      std::vector<Terms> from = listed_;
      from.push_back(lead_.terms);
      LinearisedMotion const motion = linearised();
      std::erase_if(from, [&](Terms const& terms) {
        return std::any_of(terms.begin(), terms.end(), [&](int j) { return !motion.usable(j); });
      });
      near_ = best_terms(motion, from);
      if (near_.empty()) return;
      double reference = near_.front().score;
      for (WeighedTerms const& each : near_)
        if (each.terms == lead_.terms) reference = each.score;
      near_offset_ = lead_.score - reference;
      std::optional<Fitted> better = better_near(motion, reference);
      if (!better) return;
      lead_ = std::move(*better);
      settle_step();
    }
  }

  bool one_move_away(Terms const& terms) const {
    auto const missing = [](Terms const& a, Terms const& b) {
      return std::count_if(a.begin(), a.end(), [&](int j) { return !std::binary_search(b.begin(), b.end(), j); });
    };
    return missing(terms, lead_.terms) <= 1 && missing(lead_.terms, terms) <= 1;
  }

  // The best fit among what the linearisation finds better than the leading structure: batch by batch the best ones, and the best
  // that are one move away, which the linearisation foretells where it does not foretell the others.
  std::optional<Fitted> better_near(LinearisedMotion const& motion, double reference) {
    std::optional<Fitted> better;
    for (int part = 0; part < most_batches && !better && !interrupted_(); ++part) {
      int count = 0, close = 0;
      for (WeighedTerms const& each : near_) {
        if (!(each.score > reference) || (count >= batch && close >= batch)) break;
        bool const near = one_move_away(each.terms);
        if (tried_.contains(each.terms) || (count >= batch && (!near || close >= batch))) continue;
        ++(count < batch ? count : close);
        Fitted trial = fitted(each.terms, {each.coefficients, lead_.fit.point.starts + motion.start_moves(each)});
        if (!trial.usable()) trial = fitted(each.terms, {of_lead(each.terms), lead_.fit.point.starts});
        if (trial.usable() && trial.score > (better ? better->score : lead_.score)) better = trial;
        tried_.emplace(each.terms, std::move(trial));
      }
      if (count == 0) break;
    }
    return better;
  }

  // The leading structure's coefficients of some terms, 0 of those that it lacks.
  Eigen::VectorXd of_lead(Terms const& terms) const {
    Eigen::VectorXd const all = spread(lead_);
    Eigen::VectorXd own(static_cast<Eigen::Index>(terms.size()));
    for (std::size_t i = 0; i < terms.size(); ++i) own(static_cast<Eigen::Index>(i)) = all(terms[i]);
    return own;
  }

  /// All states of the model have a channel of their own.
  bool every_state_measured() const {
    return std::all_of(whole_.states.begin(), whole_.states.end(), [&](std::pair<int, int> const& state) {
      return std::any_of(whole_.channels.begin(), whole_.channels.end(), [&](std::size_t c) {
        regression::Channel const& channel = source_.dictionary.numbers.channels[c];
        return channel.state == state.first && channel.order == state.second;
      });
    });
  }

  // Segments of twice the length: if the structure that is best there follows as well as the leading one did before.
  bool climb() {
    std::vector<Segment> const before = segments();
    Fitted const lead = lead_;
    auto const tried = tried_;
    auto const near = near_;
    double const offset = near_offset_;
    int const substeps = substeps_;
    NoiseShape const noise = noise_;
    --halved_;
    std::vector<Segment> const parts = segments();
    ShootingPoint point{lead_.fit.point.coefficients,
                        Eigen::MatrixXd(lead_.fit.point.starts.rows(), static_cast<Eigen::Index>(parts.size()))};
    for (std::size_t s = 0; s < parts.size(); ++s)
      for (std::size_t b = 0; b < before.size(); ++b)
        if (before[b].experiment == parts[s].experiment && before[b].first == parts[s].first)
          point.starts.col(static_cast<Eigen::Index>(s)) = lead_.fit.point.starts.col(static_cast<Eigen::Index>(b));
    Fitted next = fitted(lead_.terms, point);
    bool good = next.usable();
    if (good) {
      lead_ = std::move(next);
      settle_step();
      search();
    }
    for (std::size_t c = 0; good && c < lead.fit.noise_sd.size(); ++c)
      good = lead_.fit.noise_sd[c] <= joinable_growth * std::max(lead.fit.noise_sd[c], noise_.floor[c]);
    if (good) return true;
    ++halved_;
    lead_ = lead;
    tried_ = tried;
    near_ = near;
    near_offset_ = offset;
    substeps_ = substeps;
    noise_ = noise;
    return false;
  }

  /// Smaller steps of the integrator until it is off by less than a tenth of the noise, and the noise that it bounds from below.
  void settle_step() {
    int const before = substeps_;
    std::vector<double> error(whole_.channels.size(), 0);
    for (substeps_ = whole_.solver.substeps;; substeps_ *= 2) {
      std::vector<SegmentSlopes> const coarse = residuals(substeps_), fine = residuals(2 * substeps_);
      SegmentSimulation const sizes = simulation(lead_.terms);
      double worst = 0;
      for (int c = 0; c < sizes.channels(); ++c) {
        double squares = 0, count = 0;
        for (std::size_t s = 0; s < coarse.size(); ++s) {
          Eigen::Index const rows = sizes.rows_of_channel(static_cast<int>(s));
          squares += (coarse[s].residual - fine[s].residual).segment(c * rows, rows).squaredNorm();
          count += static_cast<double>(rows);
        }
        auto const i = static_cast<std::size_t>(c);
        error[i] = std::sqrt(squares / count);
        double const allowed =
            std::max({step_error * lead_.fit.noise_sd[i], least_accuracy * sizes.size(c), step_error * rounding_[i]});
        worst = std::isfinite(error[i]) ? std::max(worst, error[i] / allowed) : std::numeric_limits<double>::infinity();
      }
      if (!(worst > 1) || 2 * substeps_ > most_substeps) break;
    }
    SegmentSimulation const sizes = simulation(lead_.terms);
    noise_.floor.clear();
    for (std::size_t c = 0; c < error.size(); ++c)
      noise_.floor.push_back(
          std::max({rounding_[c], error[c], std::max(least_accuracy, input_rounding_) * sizes.size(static_cast<int>(c))}));
    fit_lead_again();
    if (substeps_ != before) tried_.clear();
    tried_[lead_.terms] = lead_;
  }
  void fit_lead_again() {
    Fitted again = fitted(lead_.terms, lead_.fit.point);
    if (again.usable()) lead_ = std::move(again);
  }
  std::vector<SegmentSlopes> residuals(int substeps) const {
    return simulation({}, &lead_.terms, &lead_.fit.point.coefficients, substeps)
        .residuals({Eigen::VectorXd(), lead_.fit.point.starts});
  }

  /// Whether the noise of a channel is found to grow with the signal otherwise than before; the leading structure is fitted anew
  /// then.
  bool settle_noise();

  FoundSource const& source_;
  std::function<bool()> const& interrupted_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<Column> columns_;
  ValidatedModel whole_;
  ValidationRows rows_;
  StartGuess guess_;
  std::vector<double> rounding_, growth_;
  double input_rounding_ = 0;  // of the inputs, as a part of their size
  NoiseShape noise_;
  int least_ = 2, halved_ = 0, substeps_ = 1;
  std::vector<Terms> listed_;
  Fitted lead_;
  std::map<Terms, Fitted> tried_;   // at this length of segments, with this noise
  std::vector<WeighedTerms> near_;  // about the leading structure
  double near_offset_ = 0;          // of their scores against those of fits
};

bool Searcher::settle_noise() {
  std::vector<Experiment> const own = records();
  std::vector<Segment> const parts = segments();
  NoiseShape const kept = noise_;
  noise_.relative.clear();
  std::vector<SegmentSlopes> const runs = residuals(substeps_);
  noise_ = kept;
  std::vector<std::vector<std::vector<double>>> relative;
  for (Experiment const& each : own) relative.emplace_back(own.front().measured.size(), std::vector<double>(each.time.size(), 1.0));
  std::vector<double> growth(growth_.size(), 0);
  for (std::size_t c = 0; c < growth.size(); ++c) {
    std::vector<double> signal, residual;
    std::vector<double*> places;
    for (std::size_t s = 0; s < parts.size(); ++s) {
      auto const e = static_cast<std::size_t>(parts[s].experiment);
      if (own[e].measured[c].empty()) continue;
      for (int i = 0; i < parts[s].count; ++i) {
        auto const row = static_cast<std::size_t>(parts[s].first + i);
        double const left = runs[s].residual(static_cast<Eigen::Index>(c) * parts[s].count + i);
        if (!std::isfinite(own[e].measured[c][row]) || own[e].scored[row] == 0) continue;
        signal.push_back(own[e].measured[c][row] + left);
        residual.push_back(left);
        places.push_back(&relative[e][c][row]);
      }
    }
    auto const grows = growing_noise(signal, residual);
    if (!grows) continue;
    growth[c] = grows->offset;
    for (std::size_t i = 0; i < places.size(); ++i) *places[i] = grows->relative[i];
  }
  bool const any = std::any_of(growth.begin(), growth.end(), [](double each) { return each > 0; });
  if (growth == growth_) return false;
  growth_ = growth;
  noise_.relative = any ? relative : std::vector<std::vector<std::vector<double>>>{};
  fit_lead_again();
  return true;
}

void Searcher::report(std::vector<FoundStructure> const& listed, int most, StructureSearch& out) const {
  struct Candidate {
    Terms terms;
    Eigen::VectorXd coefficients;
    double score;
    Eigen::MatrixXd covariance;
  };
  std::vector<Candidate> all;
  for (auto const& [terms, each] : tried_)
    if (each.usable()) all.push_back({terms, each.fit.point.coefficients, each.score, each.fit.covariance});
  for (WeighedTerms const& each : near_)
    if (!tried_.contains(each.terms)) all.push_back({each.terms, each.coefficients, each.score + near_offset_, {}});
  std::stable_sort(all.begin(), all.end(), [](Candidate const& a, Candidate const& b) { return a.score > b.score; });
  auto const structure_of = [&](Candidate const& each) {
    FoundStructure structure;
    for (std::size_t e = 0; e < source_.dictionary.equations.size(); ++e) {
      regression::Support support;
      std::vector<Eigen::Index> rows;
      for (std::size_t i = 0; i < each.terms.size(); ++i) {
        Column const& column = columns_[static_cast<std::size_t>(each.terms[i])];
        if (column.equation != e) continue;
        support.terms.push_back(static_cast<int>(column.term));
        rows.push_back(static_cast<Eigen::Index>(i));
      }
      auto const count = static_cast<Eigen::Index>(rows.size());
      support.coefficient.resize(count);
      support.covariance = Eigen::MatrixXd::Zero(count, count);
      for (Eigen::Index i = 0; i < count; ++i) {
        support.coefficient(i) = each.coefficients(rows[static_cast<std::size_t>(i)]);
        for (Eigen::Index j = 0; j < count && each.covariance.size() > 0; ++j)
          support.covariance(i, j) = each.covariance(rows[static_cast<std::size_t>(i)], rows[static_cast<std::size_t>(j)]);
      }
      structure.refined.push_back(support.coefficient);
      regression::Support const* known = nullptr;
      auto const look = [&](regression::Support const& other) {
        if (known == nullptr && other.terms == support.terms) known = &other;
      };
      look(source_.discovery.equations[e].chosen);
      for (regression::Support const& other : source_.discovery.equations[e].supports) look(other);
      if (known == nullptr) known = &out.supports.emplace_back(std::move(support));
      structure.equations.push_back(known);
    }
    for (std::size_t m = 0; m < listed.size(); ++m)
      if (terms_of(listed[m]) == each.terms) structure.of_regression = static_cast<int>(m) + 1;
    structure.score = each.score;
    return structure;
  };
  bool chosen = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (out.structures.size() < static_cast<std::size_t>(most)) {
      out.structures.push_back(structure_of(all[i]));
      chosen = chosen || out.structures.back().of_regression == 1;
    } else {
      out.record.others += elementary::exp(all[i].score - all.front().score);
    }
  }
  if (!chosen) {
    out.structures.push_back(listed.front());
    out.structures.back().of_regression = 1;
  }
  NoiseShape& noise = out.record.noise;
  std::size_t const channels = source_.dictionary.measured.channels.size();
  noise.floor.assign(channels, 0);
  out.record.growth.assign(channels, 0);
  if (!noise_.relative.empty())
    for (std::size_t e = 0; e < rows_.records.size(); ++e)
      noise.relative.emplace_back(channels, std::vector<double>(rows_.records[e].time.size(), 1.0));
  for (std::size_t c = 0; c < whole_.channels.size(); ++c) {
    noise.floor[whole_.channels[c]] = noise_.floor[c];
    out.record.growth[whole_.channels[c]] = growth_[c];
    for (std::size_t e = 0; e < noise.relative.size(); ++e) noise.relative[e][whole_.channels[c]] = noise_.relative[e][c];
  }
  out.record.substeps = substeps_;
}

}  // namespace

StructureSearch search_structures(FoundSource const& source, std::vector<FoundStructure> const& listed, int most,
                                  std::function<bool()> const& interrupted) {
  StructureSearch out;
  Searcher searcher(source, interrupted);
  if (!searcher.possible() || !searcher.begin(listed)) return out;
  searcher.run(listed);
  searcher.report(listed, most, out);
  out.searched = true;
  return out;
}

}  // namespace sysid
