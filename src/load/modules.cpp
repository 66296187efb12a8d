// Finds, reads and parses modules, each once.
#include "load/modules.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "check/message/errors_reuse.hpp"
#include "core/system/files.hpp"
#include "syntax/parse.hpp"

namespace sysid {
namespace {

LibraryModule const* in_library(std::string const& name) {
  for (LibraryModule const& each : library_modules())
    if (each.name == name) return &each;
  return nullptr;
}

class Loader {
 public:
  Loader(Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved)
      : source_(source), diagnostics_(diagnostics), unsaved_(unsaved), folder_(std::filesystem::path(source.name()).parent_path()) {
    path_.push_back(std::filesystem::path(source.name()).stem().string());
  }

  void load(ast::File const& file, bool from_library) {
    for (ast::Item const& item : file.items)
      if (auto const* use = std::get_if<ast::Use>(&item)) load(use->module, from_library);
  }
  std::vector<Module> take() { return std::move(modules_); }

 private:
  void load(ast::Name const& name, bool from_library) {
    // A file called damping.sysid that uses damping means the library's.
    bool const own_name = path_.size() == 1 && name.text == path_.front() && in_library(name.text) != nullptr;
    auto const begin = std::find(path_.begin() + (from_library || own_name ? 1 : 0), path_.end(), name.text);
    if (begin != path_.end()) {
      errors::Names loop(begin, path_.end());
      loop.push_back(name.text);
      diagnostics_.add(errors::module_cycle(name.span, loop));
      return;
    }
    if (!seen_.insert(name.text).second) return;
    std::string file = (folder_ / (name.text + ".sysid")).string();
    std::optional<std::string> text;
    if (!from_library && !own_name && unsaved_) text = unsaved_(file);
    if (!from_library && !own_name && !text && std::filesystem::exists(file)) text = read_regular_file(file, most_text_bytes + 1);
    bool const of_library = !text.has_value();
    if (of_library) {
      LibraryModule const* module = in_library(name.text);
      if (module == nullptr) {
        diagnostics_.add(errors::module_not_found(name, folder_.empty() ? "this folder" : "`" + folder_.string() + "`", known()));
        return;
      }
      text = std::string(module->text);
      file = "stdlib/" + name.text + ".sysid";
    }
    // Behind blanks as long as all texts before it, so that the parser's offsets are those in `source`.
    Source const padded(file, std::string(source_.next_begin(), ' ') + *text);
    source_.include(file, *text);
    auto tree = parse(padded, diagnostics_);
    if (!tree) return;
    path_.push_back(name.text);
    load(*tree, of_library);
    path_.pop_back();
    modules_.push_back({name.text, std::move(*tree), of_library});
  }

  errors::Names known() const {
    errors::Names names;
    for (LibraryModule const& module : library_modules()) names.emplace_back(module.name);
    std::error_code nothing_there;
    for (auto const& entry : std::filesystem::directory_iterator(folder_.empty() ? "." : folder_, nothing_there))
      if (entry.path().extension() == ".sysid" && entry.path().stem() != path_.front())
        names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  Source& source_;
  Diagnostics& diagnostics_;
  UnsavedText const& unsaved_;
  std::filesystem::path folder_;
  std::vector<std::string> path_;  // of the files that are open
  std::set<std::string> seen_;
  std::vector<Module> modules_;
};

}  // namespace

std::vector<Module> load_modules(ast::File const& file, Source& source, Diagnostics& diagnostics, UnsavedText const& unsaved) {
  Loader loader(source, diagnostics, unsaved);
  loader.load(file, false);
  return loader.take();
}

}  // namespace sysid
