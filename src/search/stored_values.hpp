// Values as JSON that CBOR brings back bit for bit: a block of doubles is one byte string of their little-endian bytes, so
// infinities, NaN and last digits survive.
#pragma once
#include <exception>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "result/finding.hpp"
#include "result/mode.hpp"

namespace sysid::checkpoint {

/// A stored state that is not what it should be: damaged, or of another run.
class Mismatch : public std::exception {
 public:
  explicit Mismatch(std::string what) : what_(std::move(what)) {}
  char const* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

/// A byte string, which CBOR has and JSON as text has not.
nlohmann::json encode(std::span<double const> values);
/// Throws Mismatch for anything else, the text of an older format included.
std::vector<double> decode(nlohmann::json const& stored);
/// Throws Mismatch unless there are `count`.
std::vector<double> decode(nlohmann::json const& stored, std::size_t count);
nlohmann::json encode(LaneArray const& values);
/// Throws Mismatch unless the stored block is rows x width.
LaneArray decode(nlohmann::json const& stored, int rows, int width);
nlohmann::json encode(Ledger const& ledger);
Ledger decode_ledger(nlohmann::json const& stored);
nlohmann::json encode(Mode const& mode);
/// Throws Mismatch where its parts are of different dimensions.
Mode decode_mode(nlohmann::json const& stored);
nlohmann::json encode(Findings const& findings);
Findings decode_findings(nlohmann::json const& stored);

}  // namespace sysid::checkpoint
