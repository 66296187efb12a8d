// The steps of a search as a journal keeps them: climbers on their way, densities, modes.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string_view>
#include <vector>

#include "search/descent.hpp"
#include "search/journal.hpp"
#include "search/run_context.hpp"

namespace sysid {

/// Where a loop over rounds of blocks is.
struct LoopPlace {
  int round = 0;
  std::size_t first = 0;            // of `active`, that the next block begins with
  std::vector<std::size_t> active;  // those of this round; empty: it has not begun
};

/// A loop over climbers. Without a journal it does nothing.
class ClimbingStep {
 public:
  /// Takes climbers and ledger from what is kept.
  ClimbingStep(Journal* journal, std::string_view kind, std::vector<Climber>& climbers, Ledger& ledger);

  /// Nothing is left to do.
  bool over() const { return over_; }
  LoopPlace const& place() const { return place_; }
  /// What the loop holds beside its climbers, as it was given to `reached`; empty at the beginning.
  std::vector<double> const& rest() const { return rest_; }
  void reached(LoopPlace const& place, std::function<std::vector<double>()> const& rest = {});
  void finish();

 private:
  nlohmann::json state() const;

  Journal* journal_;
  std::vector<Climber>& climbers_;
  Ledger& ledger_;
  LoopPlace place_;
  std::vector<double> rest_;
  bool over_ = false;
};

/// Appends a matrix or vector of known size.
void append(std::vector<double>& values, Eigen::MatrixXd const& matrix);

/// The numbers of so many columns, which `compute(first, count)` makes in blocks. `stop` is asked before each block; what it leaves
/// out is -infinity.
std::vector<double> kept_values(Journal* journal, std::string_view kind, int width, int block, Ledger& ledger,
                                std::function<bool()> const& stop,
                                std::function<std::vector<double>(int first, int count)> const& compute);

/// The mode that `compute` makes, or what is kept of it. Of no worth where `stop` says so afterwards.
Mode kept_mode(Journal* journal, Ledger& ledger, std::function<bool()> const& stop, std::function<Mode()> const& compute);

/// As `kept_mode`, of a question that simulations answer and no ledger counts.
bool kept_answer(Journal* journal, std::function<bool()> const& stop, std::function<bool()> const& ask);

}  // namespace sysid
