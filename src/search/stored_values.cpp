// Exact storing of doubles, ledgers, modes and findings.
#include "search/stored_values.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace sysid::checkpoint {

static_assert(std::endian::native == std::endian::little, "checkpoints are little-endian");

nlohmann::json encode(std::span<double const> values) {
  auto const* const bytes = reinterpret_cast<std::uint8_t const*>(values.data());
  return nlohmann::json::binary({bytes, bytes + values.size_bytes()});
}

std::vector<double> decode(nlohmann::json const& stored) {
  if (!stored.is_binary()) throw Mismatch("its numbers are damaged");
  nlohmann::json::binary_t const& bytes = stored.get_binary();
  if (bytes.size() % sizeof(double) != 0) throw Mismatch("it is truncated");
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::vector<double> decode(nlohmann::json const& stored, std::size_t count) {
  std::vector<double> values = decode(stored);
  if (values.size() != count) throw Mismatch("it is damaged");
  return values;
}

nlohmann::json encode(LaneArray const& values) {
  auto const size = static_cast<std::size_t>(values.rows()) * static_cast<std::size_t>(values.width());
  return encode(std::span<double const>{values.view().data(), size});
}

LaneArray decode(nlohmann::json const& stored, int rows, int width) {
  std::vector<double> const values = decode(stored);
  if (rows < 0 || width < 0 || values.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(width))
    throw Mismatch("its chains differ in number or dimension");
  LaneArray array(rows, width);
  std::copy(values.begin(), values.end(), array.view().data());
  return array;
}

nlohmann::json encode(Ledger const& ledger) {
  nlohmann::json failures = nlohmann::json::array();
  for (Failure const& failure : ledger.failures())
    failures.push_back({{"kind", static_cast<int>(failure.kind)},
                        {"where", failure.where},
                        {"count", failure.count},
                        {"time", encode(std::span<double const>{&failure.time, 1})},
                        {"example", encode(std::span<double const>{failure.example})},
                        {"names", failure.names}});
  return {{"solves", ledger.solves()}, {"failures", failures}};
}

namespace {

FailureClass failure_class(nlohmann::json const& stored) {
  int const number = stored.get<int>();
  if (number < 0 || number > static_cast<int>(FailureClass::inconsistent)) throw Mismatch("it is damaged");
  return static_cast<FailureClass>(number);
}

Severity severity(nlohmann::json const& stored) {
  int const number = stored.get<int>();
  if (number < 0 || number > static_cast<int>(Severity::note)) throw Mismatch("it is damaged");
  return static_cast<Severity>(number);
}

}  // namespace

Ledger decode_ledger(nlohmann::json const& stored) {
  Ledger ledger;
  ledger.add_solves(stored.at("solves").get<std::uint64_t>());
  for (nlohmann::json const& failure : stored.at("failures"))
    ledger.add_failure(failure_class(failure.at("kind")), failure.at("where").get<std::string>(),
                       decode(failure.at("time"), 1).front(), decode(failure.at("example")),
                       failure.at("count").get<std::uint64_t>(), failure.value("names", std::vector<std::string>{}));
  return ledger;
}

nlohmann::json encode(Mode const& mode) {
  auto const block = [](std::vector<double> const& v) { return encode(std::span<double const>{v}); };
  return {{"theta", block(mode.theta)},
          {"declared", block(mode.declared)},
          {"sd", block(mode.sd)},
          {"covariance", block(mode.covariance)},
          {"numbers", block({mode.log_density, mode.log_mass, mode.share, mode.gain, mode.stalled ? 1.0 : 0.0})},
          {"hits", mode.hits},
          {"flat", block(mode.flat)}};
}

Mode decode_mode(nlohmann::json const& stored) {
  std::vector<double> theta = decode(stored.at("theta")), flat = decode(stored.at("flat"));
  std::size_t const n = theta.size();
  if (n == 0 || flat.size() % n != 0) throw Mismatch("it is damaged");
  std::vector<double> const numbers = decode(stored.at("numbers"), 5);
  return {std::move(theta),
          decode(stored.at("declared"), n),
          decode(stored.at("sd"), n),
          decode(stored.at("covariance"), n * n),
          numbers.at(0),
          numbers.at(1),
          numbers.at(2),
          stored.at("hits").get<int>(),
          std::move(flat),
          numbers.at(3),
          numbers.at(4) != 0};
}

nlohmann::json encode(Findings const& findings) {
  nlohmann::json stored = nlohmann::json::array();
  for (Finding const& f : findings) stored.push_back({word(f.code), static_cast<int>(f.severity), f.names, f.message, f.help});
  return stored;
}

Findings decode_findings(nlohmann::json const& stored) {
  Findings findings;
  for (auto const& f : stored) {
    auto const code = finding_code(f.at(0).get<std::string>());
    if (!code) throw Mismatch("it has a finding that is not known");
    findings.push_back({*code, severity(f.at(1)), f.at(2).get<std::vector<std::string>>(), f.at(3).get<std::string>(),
                        f.at(4).get<std::string>()});
  }
  return findings;
}

}  // namespace sysid::checkpoint
