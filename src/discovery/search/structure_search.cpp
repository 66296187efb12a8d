// One linearisation serves all structures near the leading one.
#include "discovery/search/structure_search.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "discovery/search/outside_form.hpp"
#include "likelihood/segments/segment_differences.hpp"
#include "likelihood/segments/segment_noise.hpp"

namespace sysid {
namespace {

constexpr int most_rounds = 8;           // of linearisations at one length of segments
constexpr int batch = 3;                 // structures that are fitted before the leading one is chosen again
constexpr int most_batches = 4;          // about one point, as long as the linearisation finds better ones
constexpr std::size_t most_near = 8;     // that forms with other terms are compared with
constexpr double joinable_growth = 1.5;  // of a residual when segments are joined

class Searcher {
 public:
  Searcher(WholeDictionary& dictionary, std::function<bool()> const& interrupted)
      : dictionary_(dictionary), interrupted_(interrupted), limits_(dictionary) {
    now_.conditions = {dictionary.most_halved(), dictionary.model().solver.substeps, {}};
  }

  /// From the best of the structures that stay finite; from no terms at all where none does.
  bool begin(std::vector<FoundStructure> const& listed) {
    for (FoundStructure const& each : listed) {
      FittedTerms first = dictionary_.fitted(each, now_.conditions);
      if (first.usable() && first.score > now_.lead.score) now_.lead = std::move(first);
      listed_.push_back(dictionary_.terms_of(each));
    }
    if (!now_.lead.usable()) now_.lead = dictionary_.fitted_without_terms(now_.conditions);
    if (!now_.lead.usable()) return false;
    settle_step();
    return true;
  }

  void run() {
    search();
    if (settle_noise()) search();
    while (now_.conditions.halved > 0 && !interrupted_() && climb()) {
    }
    if (settle_noise()) search();
  }

  /// Whatever was fitted or weighed under the last conditions.
  std::vector<SearchedTerms> all() const {
    std::vector<SearchedTerms> all;
    for (auto const& [terms, each] : now_.tried)
      if (each.usable()) all.push_back({terms, each.fit.point.coefficients, each.score, each.fit.covariance});
    for (WeighedTerms const& each : now_.near)
      if (!now_.tried.contains(each.terms)) all.push_back({each.terms, each.coefficients, each.score + now_.near_offset, {}});
    return all;
  }
  /// Whether terms that the dictionary lacks describe the record as well as the leading structure.
  std::optional<OutsideEquation> outside() const {
    if (interrupted_()) return std::nullopt;
    std::vector<double> noise;
    LinearisedParts const parts = linearised(noise);
    std::vector<Terms> near;
    for (WeighedTerms const& each : now_.near)
      if (near.size() < most_near) near.push_back(each.terms);
    return outside_form(dictionary_, now_.lead, now_.conditions, parts, noise, near, interrupted_);
  }
  FitConditions const& conditions() const { return now_.conditions; }
  RecordLimits const& limits() const { return limits_; }

 private:
  /// All that one length of segments leaves to the next, or that is taken back.
  struct Standing {
    FitConditions conditions;
    FittedTerms lead;
    std::map<Terms, FittedTerms> tried;  // under these conditions
    std::vector<WeighedTerms> near;      // about the leading structure
    double near_offset = 0;              // of their scores against those of fits
  };

  // About the leading structure, by every coefficient of the dictionary.
  LinearisedParts linearised(std::vector<double>& noise) const {
    Terms all;
    for (std::size_t j = 0; j < dictionary_.columns().size(); ++j) all.push_back(static_cast<int>(j));
    SegmentSimulation const simulation = dictionary_.simulation(all, now_.conditions);
    ShootingPoint const point{dictionary_.coefficients_of_all(now_.lead), now_.lead.fit.point.starts};
    SegmentDifferences differences(simulation, point);
    std::vector<SegmentSlopes> const slopes = differences.at(point, most_probes);
    noise = noise_of(simulation, squares_of(simulation, slopes), 0);
    LinearisedMotion::Settings settings;
    for (int c = 0; c < simulation.channels(); ++c) {
      double const n = simulation.samples_of_channel(c), ratio = simulation.least_noise(c) / noise[static_cast<std::size_t>(c)];
      settings.samples += n;
      settings.floor += n * ratio * ratio;
    }
    settings.floor /= settings.samples;
    settings.signal = signal_of(simulation, noise);
    for (WholeDictionary::Column const& each : dictionary_.columns()) {
      settings.log_odds.push_back(each.log_odds);
      settings.always.push_back(each.always ? 1 : 0);
    }
    return {weighted(simulation, slopes, noise), point.coefficients, std::move(settings)};
  }
  LinearisedMotion linearised() const {
    std::vector<double> noise;
    LinearisedParts parts = linearised(noise);
    return LinearisedMotion(parts.slopes, parts.at, std::move(parts.settings));
  }

  // Linearise, fit what looks best, lead with what is; until the leading structure stays.
  void search() {
    now_.tried.clear();
    now_.tried.emplace(now_.lead.terms, now_.lead);
    for (int round = 0; round < most_rounds && !interrupted_(); ++round) {
      std::vector<Terms> from = listed_;
      from.push_back(now_.lead.terms);
      LinearisedMotion const motion = linearised();
      if (round == 0) add_built_up(motion, from);
      std::erase_if(from, [&](Terms const& terms) {
        return std::any_of(terms.begin(), terms.end(), [&](int j) { return !motion.usable(j); });
      });
      now_.near = best_terms(motion, from);
      if (now_.near.empty()) return;
      double reference = now_.near.front().score;
      for (WeighedTerms const& each : now_.near)
        if (each.terms == now_.lead.terms) reference = each.score;
      now_.near_offset = now_.lead.score - reference;
      std::optional<FittedTerms> better = better_near(motion, reference);
      if (!better) return;
      now_.lead = std::move(*better);
      settle_step();
    }
  }

  // Each equation without its terms, and again with as many as it has.
  void add_built_up(LinearisedMotion const& motion, std::vector<Terms>& from) const {
    std::vector<WholeDictionary::Column> const& columns = dictionary_.columns();
    for (std::size_t e = 0; e < dictionary_.source().dictionary.equations.size(); ++e) {
      Terms others;
      for (int const j : now_.lead.terms) {
        WholeDictionary::Column const& of = columns[static_cast<std::size_t>(j)];
        if (of.equation != e || of.always) others.push_back(j);
      }
      std::vector<Terms> const sets = built_up(motion, others, now_.lead.terms.size() - others.size());
      from.insert(from.end(), sets.begin(), sets.end());
    }
  }

  bool one_move_away(Terms const& terms) const {
    auto const missing = [](Terms const& a, Terms const& b) {
      return std::count_if(a.begin(), a.end(), [&](int j) { return !std::binary_search(b.begin(), b.end(), j); });
    };
    return missing(terms, now_.lead.terms) <= 1 && missing(now_.lead.terms, terms) <= 1;
  }

  // The best fit among what the linearisation finds better than the leading structure: batch by batch the best ones, and the best
  // that are one move away, which the linearisation foretells where it does not foretell the others.
  std::optional<FittedTerms> better_near(LinearisedMotion const& motion, double reference) {
    std::optional<FittedTerms> better;
    for (int part = 0; part < most_batches && !better && !interrupted_(); ++part) {
      int count = 0, close = 0;
      for (WeighedTerms const& each : now_.near) {
        if (!(each.score > reference) || (count >= batch && close >= batch)) break;
        bool const near = one_move_away(each.terms);
        if (now_.tried.contains(each.terms) || (count >= batch && (!near || close >= batch))) continue;
        ++(count < batch ? count : close);
        FittedTerms trial = fitted(each.terms, {each.coefficients, now_.lead.fit.point.starts + motion.start_moves(each)});
        if (!trial.usable())
          trial = fitted(each.terms, {dictionary_.coefficients_of(each.terms, now_.lead), now_.lead.fit.point.starts});
        if (trial.usable() && trial.score > (better ? better->score : now_.lead.score)) better = trial;
        now_.tried.emplace(each.terms, std::move(trial));
      }
      if (count == 0) break;
    }
    return better;
  }

  // Segments of twice the length: if the structure that is best there follows as well as the leading one did before.
  bool climb() {
    Standing const before = now_;
    RecordLimits::Learnt learnt = limits_.learnt();
    std::vector<Segment> const shorter = dictionary_.segments(now_.conditions.halved);
    std::vector<Segment> const parts = dictionary_.segments(--now_.conditions.halved);
    ShootingPoint const& from = before.lead.fit.point;
    ShootingPoint point{from.coefficients, Eigen::MatrixXd(from.starts.rows(), static_cast<Eigen::Index>(parts.size()))};
    for (std::size_t s = 0; s < parts.size(); ++s)
      for (std::size_t b = 0; b < shorter.size(); ++b)
        if (shorter[b].experiment == parts[s].experiment && shorter[b].first == parts[s].first)
          point.starts.col(static_cast<Eigen::Index>(s)) = from.starts.col(static_cast<Eigen::Index>(b));
    FittedTerms next = fitted(now_.lead.terms, std::move(point));
    bool good = next.usable();
    if (good) {
      now_.lead = std::move(next);
      settle_step();
      search();
    }
    std::vector<double> const& sds = before.lead.fit.noise_sd;
    for (std::size_t c = 0; good && c < sds.size(); ++c)
      good = now_.lead.fit.noise_sd[c] <= joinable_growth * std::max(sds[c], now_.conditions.noise.floor[c]);
    if (!good) {
      now_ = before;
      limits_.take_back(std::move(learnt));
    }
    return good;
  }

  FittedTerms fitted(Terms const& terms, ShootingPoint from) const {
    return dictionary_.fitted(terms, std::move(from), now_.conditions);
  }
  void fit_lead_again() {
    FittedTerms again = fitted(now_.lead.terms, now_.lead.fit.point);
    if (again.usable()) now_.lead = std::move(again);
  }
  void settle_step() {
    bool const anew = limits_.settle_step(now_.lead, now_.conditions);
    fit_lead_again();
    if (anew) now_.tried.clear();
    now_.tried[now_.lead.terms] = now_.lead;
  }
  bool settle_noise() {
    if (!limits_.settle_noise(now_.lead, now_.conditions)) return false;
    fit_lead_again();
    return true;
  }

  WholeDictionary& dictionary_;
  std::function<bool()> const& interrupted_;
  RecordLimits limits_;
  std::vector<Terms> listed_;
  Standing now_;
};

}  // namespace

StructureSearch search_structures(FoundSource const& source, std::vector<FoundStructure> const& listed, int most,
                                  std::function<bool()> const& interrupted) {
  WholeDictionary dictionary(source, interrupted);
  if (!dictionary.can_be_searched()) return {};
  Searcher searcher(dictionary, interrupted);
  if (!searcher.begin(listed)) return {};
  searcher.run();
  StructureSearch out = searched_structures(source, dictionary, searcher.all(), listed, most);
  out.record.outside = searcher.outside();
  describe_record(dictionary, searcher.conditions(), searcher.limits(), source.dictionary.measured.channels.size(), out.record);
  return out;
}

}  // namespace sysid
