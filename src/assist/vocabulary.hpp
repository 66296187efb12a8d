// The words that the language brings: functions, distributions, kernels, signals, back ends, solvers and their settings, options of
// tasks. From the tables that the compiler reads.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid::assist {

enum class WordKind {
  function,
  distribution,
  kernel,
  law,     // of a disturbance
  family,  // of terms of a dictionary
  signal,
  fitting,      // a back end of `fit`
  selecting,    // of `select`
  discovering,  // a selector of terms
  derivative,   // a form of derivatives
  solver,
  option,   // of a task; owner: its verb
  setting,  // an argument by name; owner: of what
  choice,   // a value that stands for itself
  keyword,
};

struct Word {
  WordKind kind = WordKind::keyword;
  std::string name;
  std::string signature;  // "normal(mean, sd|variance|precision)"; empty: the name says it
  std::string summary;    // one line; may be empty
};

/// All words of a kind that has no owner, in the order in which `sysid list` prints them.
std::vector<Word> const& words_of(WordKind kind);
/// Names for the arguments of a distribution, kernel, signal, family, back end, selector, form or solver.
std::vector<Word> settings_of(std::string_view owner);
/// What may stand behind `with` in a task, but for back ends.
std::vector<Word> options_of(std::string_view verb);
/// The back ends that a task of this verb may name.
WordKind backends_of(std::string_view verb);
/// The settings of `read` in a data block.
std::vector<Word> reading_settings();
/// Values of an option or setting that are words: of `start`, `prediction`, `hold`, of a setting with choices or flags.
std::vector<Word> choices_of(std::string_view owner, std::string_view setting);

/// The word of that name and kind; nullptr where there is none.
Word const* find_word(WordKind kind, std::string_view name);

}  // namespace sysid::assist
