#include "result/criteria.hpp"

#include "core/numeric/elementary.hpp"

namespace sysid {

double ScoreAtMode::bic() const { return -2 * log_likelihood + parameters * elementary::log(samples); }

}  // namespace sysid
