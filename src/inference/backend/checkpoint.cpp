// Exact storing of doubles, ledgers, modes and findings.
#include "inference/backend/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace sysid::checkpoint {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little-endian");

constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Base64 without padding: the length of the text says how many bytes end it.
std::string to_base64(std::span<unsigned char const> bytes) {
  std::string text;
  text.reserve((bytes.size() * 4 + 2) / 3);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::size_t const count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k <= count; ++k) text += digits[word >> (18 - 6 * k) & 63U];
  }
  return text;
}

std::vector<unsigned char> from_base64(std::string const& text) {
  std::array<int, 256> value;
  value.fill(-1);
  for (std::size_t i = 0; i < digits.size(); ++i) value[static_cast<unsigned char>(digits[i])] = static_cast<int>(i);
  std::vector<unsigned char> bytes;
  bytes.reserve(text.size() * 3 / 4);
  unsigned word = 0;
  int bits = 0;
  for (char const c : text) {
    int const digit = value[static_cast<unsigned char>(c)];
    if (digit < 0) throw Mismatch("its numbers are damaged");
    word = word << 6 | static_cast<unsigned>(digit);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<unsigned char>(word >> bits & 255U));
    }
  }
  return bytes;
}

}  // namespace

nlohmann::json encode(std::span<double const> values) {
  return to_base64({reinterpret_cast<unsigned char const*>(values.data()), values.size_bytes()});
}

std::vector<double> decode(nlohmann::json const& stored) {
  std::vector<unsigned char> const bytes = from_base64(stored.get<std::string>());
  if (bytes.size() % sizeof(double) != 0) throw Mismatch("it is truncated");
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

nlohmann::json encode(LaneArray const& values) {
  auto const size = static_cast<std::size_t>(values.rows()) * static_cast<std::size_t>(values.width());
  return encode(std::span<double const>{values.view().data(), size});
}

LaneArray decode(nlohmann::json const& stored, int rows, int width) {
  std::vector<double> const values = decode(stored);
  LaneArray array(rows, width);
  if (values.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(width))
    throw Mismatch("its chains differ in number or dimension");
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

Ledger decode_ledger(nlohmann::json const& stored) {
  Ledger ledger;
  ledger.add_solves(stored.at("solves").get<std::uint64_t>());
  for (nlohmann::json const& failure : stored.at("failures"))
    ledger.add_failure(static_cast<FailureClass>(failure.at("kind").get<int>()), failure.at("where").get<std::string>(),
                       decode(failure.at("time")).at(0), decode(failure.at("example")), failure.at("count").get<std::uint64_t>(),
                       failure.value("names", std::vector<std::string>{}));
  return ledger;
}

nlohmann::json encode(Mode const& mode) {
  auto const block = [](std::vector<double> const& v) { return encode(std::span<double const>{v}); };
  return {{"theta", block(mode.theta)},
          {"declared", block(mode.declared)},
          {"sd", block(mode.sd)},
          {"covariance", block(mode.covariance)},
          {"numbers", block({mode.log_density, mode.log_mass, mode.share})},
          {"hits", mode.hits},
          {"flat", block(mode.flat)}};
}

Mode decode_mode(nlohmann::json const& stored) {
  std::vector<double> const numbers = decode(stored.at("numbers"));
  return {decode(stored.at("theta")),
          decode(stored.at("declared")),
          decode(stored.at("sd")),
          decode(stored.at("covariance")),
          numbers.at(0),
          numbers.at(1),
          numbers.at(2),
          stored.at("hits").get<int>(),
          decode(stored.at("flat"))};
}

nlohmann::json encode(Findings const& findings) {
  nlohmann::json stored = nlohmann::json::array();
  for (Finding const& f : findings) stored.push_back({static_cast<int>(f.severity), f.code, f.message, f.help});
  return stored;
}

Findings decode_findings(nlohmann::json const& stored) {
  Findings findings;
  for (auto const& f : stored)
    findings.push_back({static_cast<Severity>(f.at(0).get<int>()), f.at(1).get<std::string>(), f.at(2).get<std::string>(),
                        f.at(3).get<std::string>()});
  return findings;
}

nlohmann::json identity(std::string_view backend, Settings const& settings, std::uint64_t seed, Target const& target) {
  nlohmann::json values = nlohmann::json::object();
  for (auto const& [name, value] : settings.all()) std::visit([&](auto const& v) { values[name] = v; }, value);
  nlohmann::json parameters = nlohmann::json::array();
  for (ParameterInfo const& parameter : target.parameters()) parameters.push_back({parameter.name, parameter.unit});
  return {{"format", 1}, {"backend", backend}, {"settings", values}, {"seed", seed}, {"parameters", parameters}};
}

std::optional<Finding> refuse(nlohmann::json const& stored, nlohmann::json const& expected) {
  if (!stored.is_object() || !stored.contains("identity")) return unusable("it is damaged");
  nlohmann::json const& found = stored["identity"];
  if (found == expected) return std::nullopt;
  for (auto const& [key, value] : expected.items())
    if (!found.contains(key) || found[key] != value) return unusable(fmt::format("its {} differs from this run's", key));
  return unusable("it belongs to another run");
}

Finding unusable(std::string const& why) {
  return {Severity::error, "checkpoint_mismatch", fmt::format("the checkpoint cannot be resumed: {}", why),
          "run the task again without --resume, or restore the file and settings of the first run"};
}

}  // namespace sysid::checkpoint
