// Encodes climbers; every size is checked when they come back.
#include "search/search_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "search/stored_values.hpp"

namespace sysid {
namespace {

constexpr std::size_t climber_numbers = 6;

nlohmann::json encode_climbers(std::vector<Climber> const& climbers) {
  nlohmann::json stored = nlohmann::json::array();
  for (Climber const& each : climbers) {
    std::vector<double> values{
        each.log_density, each.damping, each.done ? 1.0 : 0.0, static_cast<double>(each.hits), each.gain, each.stalled ? 1.0 : 0.0};
    append(values, each.theta);
    append(values, each.curvature);
    stored.push_back(checkpoint::encode(std::span<double const>(values)));
  }
  return stored;
}

void decode_climbers(nlohmann::json const& stored, std::vector<Climber>& climbers) {
  if (!stored.is_array() || stored.size() != climbers.size()) throw checkpoint::Mismatch("its searches differ in number");
  for (std::size_t k = 0; k < climbers.size(); ++k) {
    std::vector<double> const values = checkpoint::decode(stored[k]);
    Eigen::Index const n = climbers[k].theta.size();
    auto const least = climber_numbers + static_cast<std::size_t>(n);
    bool const curved = values.size() == least + static_cast<std::size_t>(n * n);
    if (values.size() != least && !curved) throw checkpoint::Mismatch("its searches differ in dimension");
    Climber& each = climbers[k];
    each.log_density = values[0];
    each.damping = values[1];
    each.done = values[2] != 0;
    if (!(values[3] >= 0 && values[3] <= std::numeric_limits<int>::max()))
      throw checkpoint::Mismatch("its searches have no number of hits");
    each.hits = static_cast<int>(values[3]);
    each.gain = values[4];
    each.stalled = values[5] != 0;
    each.theta = Eigen::Map<Eigen::VectorXd const>(values.data() + climber_numbers, n);
    each.curvature = curved ? Eigen::MatrixXd(Eigen::Map<Eigen::MatrixXd const>(values.data() + least, n, n)) : Eigen::MatrixXd();
  }
}

}  // namespace

void append(std::vector<double>& values, Eigen::MatrixXd const& matrix) {
  values.insert(values.end(), matrix.data(), matrix.data() + matrix.size());
}

ClimbingStep::ClimbingStep(Journal* journal, std::string_view kind, std::vector<Climber>& climbers, Ledger& ledger)
    : journal_(journal), climbers_(climbers), ledger_(ledger) {
  nlohmann::json const* const kept = journal == nullptr ? nullptr : journal->begin(kind);
  if (kept == nullptr) return;
  decode_climbers(kept->at("climbers"), climbers_);
  ledger_ = checkpoint::decode_ledger(kept->at("ledger"));
  over_ = journal->finished();
  if (over_) return;
  place_ = {kept->at("round").get<int>(), kept->at("first").get<std::size_t>(), kept->at("active").get<std::vector<std::size_t>>()};
  for (std::size_t const k : place_.active)
    if (k >= climbers_.size()) throw checkpoint::Mismatch("its searches differ in number");
  rest_ = checkpoint::decode(kept->at("rest"));
}

nlohmann::json ClimbingStep::state() const {
  return {{"climbers", encode_climbers(climbers_)}, {"ledger", checkpoint::encode(ledger_)}};
}

void ClimbingStep::reached(LoopPlace const& place, std::function<std::vector<double>()> const& rest) {
  if (journal_ == nullptr || !journal_->wants()) return;
  nlohmann::json held = state();
  held["round"] = place.round;
  held["first"] = place.first;
  held["active"] = place.active;
  std::vector<double> const others = rest ? rest() : std::vector<double>();
  held["rest"] = checkpoint::encode(std::span<double const>(others));
  journal_->reached(std::move(held));
}

void ClimbingStep::finish() {
  if (journal_ != nullptr) journal_->finish(state());
}

std::vector<double> kept_values(Journal* journal, std::string_view kind, int width, int block, Ledger& ledger,
                                std::function<bool()> const& stop,
                                std::function<std::vector<double>(int first, int count)> const& compute) {
  auto const whole = static_cast<std::size_t>(width), part = static_cast<std::size_t>(block);
  std::vector<double> out;
  if (nlohmann::json const* const kept = journal == nullptr ? nullptr : journal->begin(kind)) {
    out = checkpoint::decode(kept->at("values"));
    if (out.size() > whole || (out.size() < whole && (journal->finished() || out.size() % part != 0)))
      throw checkpoint::Mismatch("its densities differ in number");
    ledger = checkpoint::decode_ledger(kept->at("ledger"));
    if (journal->finished()) return out;
  }
  auto const state = [&]() -> nlohmann::json {
    return {{"values", checkpoint::encode(std::span<double const>(out))}, {"ledger", checkpoint::encode(ledger)}};
  };
  while (out.size() < whole) {
    if (stop && stop()) {
      out.resize(whole, -std::numeric_limits<double>::infinity());
      return out;
    }
    if (journal != nullptr && journal->wants()) journal->reached(state());
    int const first = static_cast<int>(out.size());
    std::vector<double> const more = compute(first, std::min(block, width - first));
    out.insert(out.end(), more.begin(), more.end());
  }
  if (journal != nullptr && !(stop && stop())) journal->finish(state());
  return out;
}

Mode kept_mode(Journal* journal, Ledger& ledger, std::function<bool()> const& stop, std::function<Mode()> const& compute) {
  if (journal == nullptr) return compute();
  if (nlohmann::json const* const kept = journal->begin("mode")) {
    if (!journal->finished()) throw checkpoint::Mismatch("its search is damaged");
    ledger = checkpoint::decode_ledger(kept->at("ledger"));
    return checkpoint::decode_mode(kept->at("mode"));
  }
  Mode mode = compute();
  if (!stop || !stop()) journal->finish({{"mode", checkpoint::encode(mode)}, {"ledger", checkpoint::encode(ledger)}});
  return mode;
}

bool kept_answer(Journal* journal, std::function<bool()> const& stop, std::function<bool()> const& ask) {
  if (journal == nullptr) return ask();
  if (nlohmann::json const* const kept = journal->begin("answer")) {
    if (!journal->finished()) throw checkpoint::Mismatch("its search is damaged");
    return kept->get<bool>();
  }
  bool const answer = ask();
  if (!stop || !stop()) journal->finish(answer);
  return answer;
}

}  // namespace sysid
