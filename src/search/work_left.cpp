// Guesses.
#include "search/work_left.hpp"

#include <algorithm>

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

}  // namespace sysid
