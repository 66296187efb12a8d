// `discover`: the dictionary, the selector with its settings, the form of derivatives, what is reported.
#include <fmt/format.h>

#include <algorithm>

#include "check/message/errors.hpp"
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"

namespace sysid {

void TaskChecker::derivatives(ast::Expression const& tree, DiscoverTask& task) {
  ast::Call const* call = as_call(tree);
  std::string const name = call != nullptr ? call->function.text : as_word(tree).value_or("");
  auto const row = std::find_if(backends_.derivatives.begin(), backends_.derivatives.end(),
                                [&](BackendSettings const& each) { return each.name == name; });
  if (row == backends_.derivatives.end()) {
    diagnostics_.add(errors::option_choice(head_span(tree), "derivatives", name, names_of(backends_.derivatives)));
    return;
  }
  task.form = name;
  task.form_settings = Settings(row->settings);
  if (call != nullptr) options_.settings(*call, row->settings, task.form_settings);
}

// Settings of the noise stand among those of the selector.
void TaskChecker::take_settings_of_samples(ast::Call& selector, DiscoverTask& task) {
  auto const of_samples = [&](ast::Argument const& each) {
    return each.name && find_setting(backends_.samples.settings, each.name->text) != nullptr;
  };
  ast::Call own = selector;
  std::erase_if(own.arguments, [&](ast::Argument const& each) { return !of_samples(each); });
  if (!own.arguments.empty()) options_.settings(own, backends_.samples.settings, task.form_settings);
  std::erase_if(selector.arguments, of_samples);
}

void TaskChecker::discover_method(ast::Option const& option, std::string const& key, CheckedDictionary const* dictionary,
                                  DiscoverTask& task) {
  bool const discrete = dictionary != nullptr && dictionary->numbers.discrete;
  ast::Option selector = option;
  if (auto* call = std::get_if<ast::Box<ast::Call>>(&selector.value.node)) {
    if (discrete) take_settings_of_samples(**call, task);
    std::vector<ast::Argument>& arguments = (*call)->arguments;
    std::optional<Span> first;
    for (ast::Argument const& argument : arguments) {
      if (!argument.name || argument.name->text != "derivatives") continue;
      if (discrete)
        diagnostics_.add(errors::not_in_discrete_time(argument.span, "derivatives", dictionary->name));
      else if (first)
        diagnostics_.add(errors::stated_twice(argument.span, *first, errors::named("derivatives")));
      else
        derivatives(argument.value, task);
      first = argument.span;
    }
    std::erase_if(arguments, [](ast::Argument const& each) { return each.name && each.name->text == "derivatives"; });
  }
  if (!backend_option(selector, key, backends_.discovering, task.selector, task.selector_settings))
    options_.unknown(option, task_option_names("discover"));
}

void TaskChecker::noise(ast::Call const& call, CheckedDictionary const& dictionary, DiscoverTask& task) {
  std::vector<std::string> known;
  for (Channel const& channel : dictionary.measured.channels) known.push_back(channel.name);
  task.noise.resize(known.size());
  each_named(call, errors::named("dictionary", dictionary.name), "channel", known,
             [&](ast::Argument const& argument, std::size_t index) {
               std::optional<Unit> const& unit = dictionary.measured.channels[index].unit;
               if (auto const value = options_.width(argument.value, argument.name->text, unit, 1e-300)) task.noise[index] = *value;
             });
}

// `noise = 1 [percent]`, as `simulate` has it.
void TaskChecker::noise_of_all(ast::Option const& option, CheckedDictionary const* dictionary) {
  if (dictionary != nullptr && dictionary->numbers.discrete) {
    diagnostics_.add(errors::not_in_discrete_time(option.span, "noise", dictionary->name));
    return;
  }
  bool const known = dictionary != nullptr && !dictionary->measured.channels.empty();
  Channel const* const channel = known ? &dictionary->measured.channels.front() : nullptr;
  std::string const unit = channel != nullptr && channel->unit ? fmt::format(" [{}]", channel->unit->text) : std::string();
  diagnostics_.add(
      errors::option_kind(option.span, "noise", {"the standard deviation of a channel"},
                          fmt::format("noise({} = 0.1{})", channel == nullptr ? "displacement" : channel->name, unit)));
}

void TaskChecker::require_channels(CheckedDictionary const& dictionary, DiscoverTask const& task) {
  for (std::size_t i = 0; i < task.experiments.size(); ++i) {
    DataBlock const& block = file_.data[static_cast<std::size_t>(task.experiments[i].data)];
    std::vector<std::string> measured;
    for (DataMeasureUse const& use : block.measured) measured.push_back(use.channel);
    for (std::size_t c = 0; c < dictionary.measured.channels.size(); ++c) {
      std::string const& channel = dictionary.measured.channels[c].name;
      if (std::find(measured.begin(), measured.end(), channel) == measured.end())
        diagnostics_.add(
            errors::channel_not_measured(tree_.data[i].span, block.name, dictionary.channel_spans[c], channel, measured));
    }
  }
}

DiscoverTask TaskChecker::discover() {
  DiscoverTask task;
  task.selector = backends_.discovering.front().name;
  task.selector_settings = Settings(backends_.discovering.front().settings);
  auto const found = item(tree_.subject, names_.dictionaries, "dictionary");
  CheckedDictionary const* dictionary = found ? &file_.dictionaries[static_cast<std::size_t>(*found)] : nullptr;
  if (found) task.dictionary = *found;
  bool const discrete = dictionary != nullptr && dictionary->numbers.discrete;
  BackendSettings const& form = discrete ? backends_.samples : backends_.derivatives.front();
  task.form = form.name;
  task.form_settings = Settings(form.settings);
  task.experiments = experiments(dictionary == nullptr ? nullptr : &dictionary->measured, "from");
  if (dictionary != nullptr && !diagnostics_.has_errors(before_)) require_channels(*dictionary, task);
  if (!diagnostics_.has_errors(before_)) refuse_input_errors(task.experiments);
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (!option.input && option.key && (key == "top" || key == "candidates" || key == "refit" || key == "seed")) {
      if (!options_.fresh(option, key)) continue;
      if (key == "top")
        options_.whole(option, key, 1, 1000, task.top);
      else if (key == "seed")
        options_.seed(option, task.seed);
      else
        options_.flag(option, key, key == "refit" ? task.refit : task.candidates);
    } else if (option.key && key == "noise") {
      if (options_.fresh(option, key)) noise_of_all(option, dictionary);
    } else if (key == "noise" && as_call(option.value) != nullptr) {
      if (discrete) diagnostics_.add(errors::not_in_discrete_time(option.span, "noise", dictionary->name));
      if (options_.fresh(option, key) && dictionary != nullptr && !discrete) noise(*as_call(option.value), *dictionary, task);
    } else {
      discover_method(option, key, dictionary, task);
    }
  }
  return task;
}

}  // namespace sysid
