// Steps by their numbers.
#include "search/journal.hpp"

#include <algorithm>
#include <utility>

#include "search/stored_values.hpp"

namespace sysid {
namespace {

constexpr double tolerable_loss = 0.1;  // s

double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

void require_step(nlohmann::json const& stored) {
  if (!stored.is_array() || stored.size() != 2 || !stored[0].is_string()) throw checkpoint::Mismatch("its search is damaged");
}

}  // namespace

Journal::Journal(Save save, double interval, nlohmann::json const* stored)
    : save_(std::move(save)), interval_(interval), saved_(Clock::now()), held_(saved_) {
  if (stored == nullptr) return;
  if (!stored->is_object() || !stored->contains("finished") || !stored->contains("part") || !stored->at("finished").is_array())
    throw checkpoint::Mismatch("its search is damaged");
  for (nlohmann::json const& step : stored->at("finished")) {
    require_step(step);
    finished_.push_back(step);
  }
  part_ = stored->at("part");
  if (!part_.is_null()) require_step(part_);
}

nlohmann::json const* Journal::begin(std::string_view kind) {
  given_up_ = given_up_ || open_;
  was_finished_ = !given_up_ && next_ < finished_.size();
  open_ = !was_finished_;
  if (given_up_) return nullptr;
  nlohmann::json const* const kept = was_finished_ ? &finished_[next_] : part_.is_null() ? nullptr : &part_;
  if (kept != nullptr && kept->at(0).get<std::string>() != kind) throw checkpoint::Mismatch("its search took other steps");
  kind_ = kind;
  if (was_finished_) ++next_;
  return kept == nullptr ? nullptr : &kept->at(1);
}

bool Journal::wants() const { return !given_up_ && seconds_since(held_) >= std::min(tolerable_loss, interval_); }

void Journal::reached(nlohmann::json state) {
  if (given_up_) return;
  part_ = nlohmann::json::array();
  part_.push_back(kind_);
  part_.push_back(std::move(state));
  held_ = Clock::now();
  if (seconds_since(saved_) >= interval_) save();
}

void Journal::finish(nlohmann::json end) {
  if (given_up_) return;
  nlohmann::json step = nlohmann::json::array();
  step.push_back(kind_);
  step.push_back(std::move(end));
  finished_.push_back(std::move(step));
  part_ = nullptr;
  open_ = false;
  ++next_;
  if (seconds_since(saved_) >= interval_) save();
}

void Journal::save() {
  save_({{"finished", finished_}, {"part", part_}});
  saved_ = Clock::now();
}

}  // namespace sysid
