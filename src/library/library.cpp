// The C interface: arrays of rows to the engine's lanes and back, and errors as texts. No exception leaves it.
#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "core/numeric/instruction_set.hpp"
#include "core/numeric/random.hpp"
#include "core/system/interrupt.hpp"
#include "embed/density_values.hpp"
#include "embed/open_file.hpp"
#include "library/sysid.h"

struct sysid_model {
  std::shared_ptr<sysid::embed::OpenFile const> file;
  mutable sysid::embed::OpenDensity density;  // whose ledger of failures grows with every call, under a lock of its own

  sysid::Target const& target() const { return density.target(); }
};

namespace {

using namespace sysid;
using embed::Raised;

thread_local std::string last_error;
constexpr std::size_t most_vectors = 1'000'000'000;  // lanes are counted as int
constexpr int most_threads = 4096;                   // as of the Python module: more than any machine has is a mistake

/// 0, or 1 with the error kept. source: what places in messages mean; null: nothing has places.
template <class Work>
int kept(Source const* source, Work&& work) {
  static Source const nothing("sysid", "");
  last_error.clear();
  try {
    embed::guarded(source != nullptr ? *source : nothing, std::forward<Work>(work));
    return 0;
  } catch (std::exception const& error) {
    last_error = error.what();
  } catch (Interrupted const&) {
    last_error = "interrupted";
  }
  return 1;
}

[[noreturn]] void refuse(std::string message, std::string help) {
  throw UserError({Severity::error, {}, std::move(message), std::nullopt, {}, std::move(help)});
}

/// name: of the argument in sysid.h.
void require(void const* given, char const* name) {
  if (given == nullptr) refuse(std::string("`") + name + "` is NULL", "see sysid.h for what each function takes");
}

template <class Work>
int kept(sysid_model const* model, Work&& work) {
  return kept(model != nullptr ? &model->file->source() : nullptr, [&] {
    require(model, "model");
    work();
  });
}

LaneArray lanes_of(sysid_model const* model, std::size_t count, double const* rows) {
  int const size = model->target().dimension(), width = static_cast<int>(count);
  LaneArray lanes(size, width);
  for (int w = 0; w < width; ++w)
    for (int p = 0; p < size; ++p) lanes(p, w) = *rows++;
  return lanes;
}

void write(ConstLanes lanes, double* rows) {
  for (int w = 0; w < lanes.width(); ++w)
    for (int p = 0; p < lanes.rows(); ++p) *rows++ = lanes(p, w);
}

/// text: that of the file at path; null: it is read.
sysid_model* opened(char const* path, char const* text, char const* task, int threads) {
  std::unique_ptr<sysid_model> model;
  kept(static_cast<Source const*>(nullptr), [&] {
    require(path, "path");
    if (threads < 0 || threads > most_threads)
      refuse("`threads` is " + std::to_string(threads),
             "give 0 for one thread per processor, or a number up to " + std::to_string(most_threads));
    if (!supported_instruction_set())
      refuse("this processor lacks AVX2 and FMA (x86-64-v3)", "run it on a processor of 2013 or later");
    auto const given = text != nullptr ? std::optional<std::string>(text) : std::nullopt;
    auto file = std::make_shared<embed::OpenFile const>(path, given, std::map<std::string, std::string>());
    model.reset(new sysid_model{file, {file, task != nullptr ? task : "", threads}});
  });
  return model.release();
}

/// To be asked before the arrays: of an experiment that is not there they have no elements, and may be NULL for that.
void require_experiment(sysid_model const* model, std::size_t experiment) {
  int const known = model->density.density().experiments();
  if (experiment >= static_cast<std::size_t>(known))
    refuse("there is no experiment " + std::to_string(experiment), "the fit has " + std::to_string(known) + ", counted from 0");
}

/// Adds what failed to the model's ledger.
template <class Work>
int counted(sysid_model const* model, std::size_t count, Work&& work) {
  return kept(model, [&] {
    if (count == 0) return;
    if (count > most_vectors) refuse("too many parameter vectors in one call", "give at most a billion");
    Ledger ledger;
    work(ledger);
    model->density.add(ledger);
  });
}

}  // namespace

char const* sysid_version(void) { return SYSID_VERSION; }
char const* sysid_error(void) { return last_error.c_str(); }

sysid_model* sysid_load(char const* path, char const* task, int threads) { return opened(path, nullptr, task, threads); }
sysid_model* sysid_load_text(char const* text, char const* path, char const* task, int threads) {
  if (kept(static_cast<Source const*>(nullptr), [&] { require(text, "text"); }) != 0) return nullptr;
  return opened(path, text, task, threads);
}
void sysid_free(sysid_model* model) { delete model; }

size_t sysid_dimension(sysid_model const* model) {
  return model != nullptr ? static_cast<std::size_t>(model->target().dimension()) : 0;
}
char const* sysid_name(sysid_model const* model, size_t parameter) {
  return parameter < sysid_dimension(model) ? model->target().parameters()[parameter].name.c_str() : nullptr;
}
char const* sysid_unit(sysid_model const* model, size_t parameter) {
  return parameter < sysid_dimension(model) ? model->target().parameters()[parameter].unit.c_str() : nullptr;
}

int sysid_prepare(sysid_model* model, uint64_t seed) {
  return kept(model, [&] {
    if (!model->density.density().prepare(seed)) throw Interrupted();
  });
}

int sysid_constrain(sysid_model const* model, size_t count, double const* theta, double* values) {
  return counted(model, count, [&](Ledger&) {
    require(theta, "theta");
    require(values, "values");
    LaneArray declared(model->target().dimension(), static_cast<int>(count));
    model->target().constrain(lanes_of(model, count, theta), declared);
    write(declared, values);
  });
}

int sysid_unconstrain(sysid_model const* model, size_t count, double const* values, double* theta) {
  return counted(model, count, [&](Ledger&) {
    require(values, "values");
    require(theta, "theta");
    LaneArray coordinates(model->target().dimension(), static_cast<int>(count));
    model->target().unconstrain(lanes_of(model, count, values), coordinates);
    write(coordinates, theta);
  });
}

int sysid_sample_prior(sysid_model const* model, size_t count, uint64_t seed, double* theta) {
  return counted(model, count, [&](Ledger&) {
    require(theta, "theta");
    LaneArray drawn(model->target().dimension(), static_cast<int>(count));
    model->target().sample_prior({seed, Purpose::prior, 0, 0}, drawn);
    write(drawn, theta);
  });
}

int sysid_log_density(sysid_model const* model, size_t count, double const* theta, double* density) {
  return counted(model, count, [&](Ledger& ledger) {
    require(theta, "theta");
    require(density, "density");
    std::vector<double> const found = embed::log_density(model->target(), lanes_of(model, count, theta), embed::Part::both, ledger);
    std::copy(found.begin(), found.end(), density);
  });
}

int sysid_log_density_gradient(sysid_model const* model, size_t count, double const* theta, double* density, double* gradient) {
  return counted(model, count, [&](Ledger& ledger) {
    require(theta, "theta");
    require(density, "density");
    require(gradient, "gradient");
    embed::ValueAndGradient const found = embed::log_density_with_gradient(model->target(), lanes_of(model, count, theta), ledger);
    std::copy(found.value.begin(), found.value.end(), density);
    write(found.gradient, gradient);
  });
}

size_t sysid_experiments(sysid_model const* model) {
  return model != nullptr ? static_cast<std::size_t>(model->density.density().experiments()) : 0;
}

size_t sysid_rows(sysid_model const* model, size_t experiment) {
  return experiment < sysid_experiments(model) ? model->density.density().time(static_cast<int>(experiment)).size() : 0;
}

int sysid_time(sysid_model const* model, size_t experiment, double* time) {
  return kept(model, [&] {
    require_experiment(model, experiment);
    require(time, "time");
    std::vector<double> const& rows = model->density.density().time(static_cast<int>(experiment));
    std::copy(rows.begin(), rows.end(), time);
  });
}

int sysid_simulate(sysid_model const* model, size_t experiment, char const* quantity, size_t count, double const* values,
                   double* out) {
  return counted(model, count, [&](Ledger&) {
    require_experiment(model, experiment);
    require(quantity, "quantity");
    require(values, "values");
    require(out, "out");
    FitDensity::Simulated const made =
        model->density.density().simulate(static_cast<int>(experiment), lanes_of(model, count, values), 0);
    std::string known;
    for (std::size_t q = 0; q < made.quantities.size(); ++q) {
      known += (known.empty() ? "" : ", ") + made.quantities[q].name;
      if (made.quantities[q].name != quantity) continue;
      for (std::vector<double> const& drawn : made.result.drawn(q)) out = std::copy(drawn.begin(), drawn.end(), out);
      return;
    }
    refuse("there is no quantity `" + std::string(quantity) + "`", "it has " + known);
  });
}
