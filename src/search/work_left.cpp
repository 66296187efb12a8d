// Guesses.
#include "search/work_left.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sysid {

WorkLeft::WorkLeft(RunContext& context, std::string const& what, std::uint64_t usual)
    : context_(context), before_(context.ledger.solves()), usual_(usual) {
  context_.progress.begin(what, expected());
}

void WorkLeft::part(std::uint64_t usual, std::uint64_t later) {
  begun_ = done();
  usual_ = usual;
  later_ = later;
}

void WorkLeft::next(std::string const& what, std::uint64_t usual, std::uint64_t later) {
  part(usual, later);
  context_.progress.begin(what, expected());
}

std::function<bool()> WorkLeft::stop() {
  return [this] {
    context_.progress.expect(expected());
    context_.progress.advance(done(), "");
    return context_.stop_requested();
  };
}

std::uint64_t WorkLeft::expected() const {
  std::uint64_t const spent = done() - begun_, left = std::max(usual_ - std::min(usual_, spent), spent / 3);
  return done() + std::max<std::uint64_t>(left + later_, 1);
}

SearchBudget::SearchBudget(RunContext& context, std::string const& what, std::uint64_t announced)
    : context_(context), before_(context.ledger.solves()), announced_(announced), expected_(static_cast<double>(announced)) {
  context_.progress.begin(what, announced);
}

void SearchBudget::count(Ledger const* part, double share) {
  part_ = part;
  share_ = share;
}

void SearchBudget::plan(std::string note, double later) {
  note_ = std::move(note);
  expected_ = std::min(static_cast<double>(announced_), spent() + later);
}

double SearchBudget::spent() const {
  double const of_part = part_ == nullptr ? 0 : share_ * static_cast<double>(part_->solves());
  return static_cast<double>(context_.ledger.solves() - before_) + of_part;
}

std::function<bool()> SearchBudget::stop() {
  return [this] {
    auto const done = static_cast<std::uint64_t>(spent());
    context_.progress.expect(std::max(static_cast<std::uint64_t>(std::ceil(expected_)), done + 1));
    context_.progress.advance(done, note_);
    return context_.stop_requested();
  };
}

}  // namespace sysid
