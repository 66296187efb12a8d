// Whose a checkpoint is.
#include "inference/backend/checkpoint.hpp"

#include <fmt/format.h>

#include <utility>

namespace sysid::checkpoint {

namespace {

nlohmann::json values_of(Settings const& settings) {
  nlohmann::json values = nlohmann::json::object();
  for (auto const& [name, value] : settings.all()) std::visit([&](auto const& v) { values[name] = v; }, value);
  return values;
}

}  // namespace

nlohmann::json identity(std::string_view backend, Settings const& settings, std::uint64_t seed, Target const& target) {
  nlohmann::json parameters = nlohmann::json::array();
  for (ParameterInfo const& parameter : target.parameters()) parameters.push_back({parameter.name, parameter.unit});
  return {{"backend", backend}, {"settings", values_of(settings)}, {"seed", seed}, {"parameters", parameters}};
}

nlohmann::json identity(std::string_view backend, Settings const& settings, std::uint64_t seed, nlohmann::json models) {
  return {{"backend", backend}, {"settings", values_of(settings)}, {"seed", seed}, {"models", std::move(models)}};
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
  return {FindingCode::checkpoint_mismatch,
          Severity::error,
          {},
          fmt::format("the checkpoint cannot be resumed: {}", why),
          "run the task again without --resume, or restore the file and settings of the first run"};
}

std::optional<Finding> read(std::function<void()> const& what) {
  try {
    what();
    return std::nullopt;
  } catch (Mismatch const& mismatch) {
    return unusable(mismatch.what());
  } catch (nlohmann::json::exception const&) {
    return unusable("it is damaged");
  }
}

Saver::Saver(RunContext& context, std::function<nlohmann::json()> store) : context_(context), store_(std::move(store)) {}

void Saver::save_sometimes() {
  if (std::chrono::duration<double>(Clock::now() - saved_).count() >= context_.checkpoint_interval) save();
}

void Saver::save() {
  if (!context_.checkpoint) return;
  context_.checkpoint(store_());
  saved_ = Clock::now();
}

}  // namespace sysid::checkpoint
