// Declarations first, then every use: models, dictionaries, sets of candidates, tasks, and data blocks by the tasks that join them
// to models.
#include "assist/resolve.hpp"

#include <algorithm>
#include <set>

#include "assist/name_scopes.hpp"
#include "assist/use_resolver.hpp"
#include "check/task/tasks.hpp"
#include "syntax/words.hpp"

namespace sysid::assist {
namespace {

bool is_a(ast::Task const& task, TaskKind kind) { return words::task_kind(task.verb.text) == kind; }

/// One file: what it declares at the top.
struct FileNames {
  ast::File const* tree = nullptr;
  Environment const* home = nullptr;
};

class Resolver {
 public:
  Resolver(ast::File const& file, std::vector<Module> const& modules) : environments_(file, modules, unsaid_), names_(table_) {
    files_.push_back({&file, &environments_.main()});
    for (Module const& module : modules) {
      modules_.emplace(module.name, &module);
      files_.push_back({&module.tree, &environments_.all().at(module.name)});
    }
  }

  SymbolTable run() {
    for (FileNames const& file : files_) declare(file);
    for (FileNames const& file : files_) resolve_models(file);
    ast::File const& main = *files_.front().tree;
    for (ast::Item const& item : main.items) {
      if (auto const* set = std::get_if<ast::Candidates>(&item)) resolve(*set);
      if (auto const* task = std::get_if<ast::Task>(&item)) resolve(*task);
    }
    for (ast::Item const& item : main.items)
      if (auto const* data = std::get_if<ast::Data>(&item)) resolve(*data);
    names_.resolve_open_names();
    return table_.take();
  }

 private:
  using Scopes = std::vector<NameScope const*>;

  void declare(FileNames const& file) {
    for (ast::Item const& item : file.tree->items) {
      if (auto const* model = std::get_if<ast::Model>(&item)) {
        int const symbol = table_.declare(SymbolKind::model, model->name, model->span, -1);
        table_.block(model->span, symbol);
        names_.models[model] = declared(*model, symbol, *file.home, table_);
      } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) {
        names_.functions[function] = table_.declare(SymbolKind::function, function->name, function->span, -1);
      } else if (auto const* use = std::get_if<ast::Use>(&item)) {
        auto const known = modules_.find(use->module.text);
        if (known == modules_.end()) continue;
        auto const [place, fresh] = module_symbols_.emplace(use->module.text, 0);
        if (fresh) {
          Symbol symbol;
          symbol.kind = SymbolKind::module;
          symbol.name = use->module.text;
          place->second = table_.add(std::move(symbol));
        }
        table_.mention(use->module.span, place->second);
      } else if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) {
        int const symbol = table_.declare(SymbolKind::dictionary, dictionary->name, dictionary->span, -1);
        table_.block(dictionary->span, symbol);
        names_.dictionaries[dictionary] = declared(*dictionary, symbol, *file.home, table_);
        dictionaries_.emplace(dictionary->name.text, dictionary);
      } else if (auto const* data = std::get_if<ast::Data>(&item)) {
        int const symbol = table_.declare(SymbolKind::data, data->name, data->span, -1);
        table_.block(data->span, symbol);
        data_.emplace(data->name.text, declared(*data, symbol, table_));
      } else if (auto const* set = std::get_if<ast::Candidates>(&item)) {
        int const symbol = table_.declare(SymbolKind::candidates, set->name, set->span, -1);
        table_.block(set->span, symbol);
        candidates_.emplace(set->name.text, std::pair(set, symbol));
      } else if (auto const* task = std::get_if<ast::Task>(&item)) {
        declare(*task);
      }
    }
  }

  void declare(ast::Task const& task) {
    int symbol = 0;
    if (task.name) {
      symbol = table_.declare(SymbolKind::task, *task.name, task.span, -1);
    } else {
      Symbol unnamed;
      unnamed.kind = SymbolKind::task;
      unnamed.name = task_name(task);
      unnamed.declaration = task.verb.span;
      unnamed.statement = task.span;
      unnamed.named_after_another = true;
      symbol = table_.add(std::move(unnamed));
    }
    tasks_.emplace(task_name(task), std::pair(&task, symbol));
    names_.tasks.emplace(task_name(task), symbol);
  }

  void resolve_models(FileNames const& file) {
    for (ast::Item const& item : file.tree->items) {
      if (auto const* model = std::get_if<ast::Model>(&item)) names_.walk(*model);
      if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) names_.walk(*dictionary);
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) names_.walk(*function, *file.home);
    }
  }

  ast::Model const* model_of(std::string const& name) const {
    auto const found = environments_.main().models.find(name);
    return found == environments_.main().models.end() ? nullptr : found->second.tree;
  }
  void mention_model(ast::Name const& name, std::vector<ast::Argument> const& arguments) {
    ast::Model const* model = model_of(name.text);
    if (model == nullptr) return;
    NameScope const& scope = names_.models.at(model);
    table_.mention(name.span, scope.symbol);
    names_.arguments_of_model(arguments, {&scope});
  }

  void resolve(ast::Candidates const& set) {
    Scopes scopes;
    for (ast::CandidateStatement const& statement : set.statements)
      if (auto const* candidate = std::get_if<ast::Candidate>(&statement)) {
        mention_model(candidate->model, candidate->arguments);
        if (ast::Model const* model = model_of(candidate->model.text)) scopes.push_back(&names_.models.at(model));
        if (candidate->probability) names_.plain(*candidate->probability, environments_.main());
      }
    for (ast::CandidateStatement const& statement : set.statements)
      if (auto const* shared = std::get_if<ast::SharedParameters>(&statement))
        for (ast::Name const& name : shared->names) names_.element(name, scopes);
    scopes_of_candidates_[&set] = std::move(scopes);
  }

  /// The models or the dictionary that a task is about.
  Scopes subject_of(ast::Task const& task, int depth = 0) {
    std::string const& name = task.subject.text;
    if (is_a(task, TaskKind::predict)) {
      Scopes scopes = subject_of_fit(name, task, depth);
      for (ast::Name const& other : task.others)
        for (NameScope const* each : subject_of_fit(other.text, task, depth))
          if (std::find(scopes.begin(), scopes.end(), each) == scopes.end()) scopes.push_back(each);
      return scopes;
    }
    if (is_a(task, TaskKind::discover)) {
      auto const dictionary = dictionaries_.find(name);
      return dictionary == dictionaries_.end() ? Scopes() : Scopes{&names_.dictionaries.at(dictionary->second)};
    }
    if (auto const set = candidates_.find(name); is_a(task, TaskKind::select) && set != candidates_.end())
      return scopes_of_candidates_[set->second.first];
    ast::Model const* model = model_of(name);
    return model == nullptr ? Scopes() : Scopes{&names_.models.at(model)};
  }

  Scopes subject_of_fit(std::string const& name, ast::Task const& task, int depth) {
    auto const fit = tasks_.find(name);
    if (fit == tasks_.end() || fit->second.first == &task || depth > 1) return {};
    return subject_of(*fit->second.first, depth + 1);
  }

  void mention_fit(ast::Name const& name) {
    if (auto const fit = tasks_.find(name.text); fit != tasks_.end()) table_.mention(name.span, fit->second.second);
  }

  void resolve(ast::Task const& task) {
    if (is_a(task, TaskKind::predict)) {
      mention_fit(task.subject);
      for (ast::Name const& other : task.others) mention_fit(other);
    } else if (is_a(task, TaskKind::discover)) {
      if (auto const dictionary = dictionaries_.find(task.subject.text); dictionary != dictionaries_.end())
        table_.mention(task.subject.span, names_.dictionaries.at(dictionary->second).symbol);
    } else if (auto const set = candidates_.find(task.subject.text); is_a(task, TaskKind::select) && set != candidates_.end()) {
      table_.mention(task.subject.span, set->second.second);
    } else {
      mention_model(task.subject, task.arguments);
    }
    Scopes const scopes = subject_of(task);
    for (ast::DataReference const& reference : task.data) {
      auto const block = data_.find(reference.data.text);
      if (block == data_.end()) continue;
      table_.mention(reference.data.span, block->second.symbol);
      joined_[reference.data.text].insert(scopes.begin(), scopes.end());
      if (!reference.part) continue;
      if (auto const part = block->second.parts.find(reference.part->text); part != block->second.parts.end())
        table_.mention(reference.part->span, part->second);
    }
    names_.options(task, scopes, environments_.main());
  }

  void resolve(ast::Data const& data) {
    Scopes scopes;
    if (auto const joined = joined_.find(data.name.text); joined != joined_.end())
      scopes.assign(joined->second.begin(), joined->second.end());
    if (scopes.empty())  // not in use yet: whatever the file declares under these names
      for (FileNames const& file : {files_.front()})
        for (ast::Item const& item : file.tree->items) {
          if (auto const* model = std::get_if<ast::Model>(&item)) scopes.push_back(&names_.models.at(model));
          if (auto const* dictionary = std::get_if<ast::Dictionary>(&item)) scopes.push_back(&names_.dictionaries.at(dictionary));
        }
    std::sort(scopes.begin(), scopes.end(), [](NameScope const* a, NameScope const* b) { return a->symbol < b->symbol; });
    int const owner = data_.at(data.name.text).symbol;
    for (ast::DataStatement const& statement : data.statements) {
      if (auto const* file = std::get_if<ast::DataFile>(&statement)) {
        Symbol symbol;
        symbol.kind = SymbolKind::file;
        symbol.name = file->path.value;
        symbol.owner = owner;
        if (!mention_maker(file->path)) table_.mention(file->path.span, table_.add(std::move(symbol)));
      } else if (auto const* time = std::get_if<ast::DataTime>(&statement)) {
        column(time->column, owner);
      } else if (auto const* rate = std::get_if<ast::DataRate>(&statement)) {
        names_.plain(rate->value, environments_.main());
      } else if (auto const* input = std::get_if<ast::DataInput>(&statement)) {
        names_.element(input->input, scopes);
        column(input->column, owner);
        if (input->error) names_.distribution(*input->error, environments_.main());
      } else if (auto const* measure = std::get_if<ast::DataMeasure>(&statement)) {
        names_.channel(measure->channel, scopes);
        column(measure->column, owner);
      } else if (auto const* constant = std::get_if<ast::DataConstant>(&statement)) {
        names_.element(constant->parameter, scopes);
        names_.plain(constant->value, environments_.main());
      }
    }
  }

  void column(ast::Column const& column, int owner) {
    Symbol symbol;
    symbol.kind = SymbolKind::column;
    symbol.name = column.name;
    symbol.owner = owner;
    symbol.unit = column.unit;
    // The place of the column has its unit with it; a text stands in quotes.
    bool const plain = std::all_of(column.name.begin(), column.name.end(), words::continues_name);
    std::uint32_t const begin = column.span.begin, length = static_cast<std::uint32_t>(column.name.size()) + (plain ? 0 : 2);
    table_.mention({begin, std::min(begin + length, column.span.end)}, table_.add(std::move(symbol)));
  }

  /// `"results/truth/truth.csv"` is what the task truth makes: the folder, and without an option the file, have its name.
  bool mention_maker(ast::Text const& path) {
    std::string const& text = path.value;
    if (path.span.end - path.span.begin != text.size() + 2) return false;  // escapes
    std::size_t const file = text.rfind('/');
    if (file == std::string::npos || file == 0) return false;
    std::size_t const folder = text.rfind('/', file - 1) == std::string::npos ? 0 : text.rfind('/', file - 1) + 1;
    auto const task = tasks_.find(text.substr(folder, file - folder));
    if (task == tasks_.end() || !is_a(*task->second.first, TaskKind::simulate) || !task->second.first->name) return false;
    auto const mention = [&](std::size_t begin, std::size_t length) {
      std::uint32_t const at = path.span.begin + 1 + static_cast<std::uint32_t>(begin);
      table_.mention({at, at + static_cast<std::uint32_t>(length)}, task->second.second);
    };
    mention(folder, file - folder);
    if (text.substr(file + 1) == task->first + ".csv") mention(file + 1, task->first.size());
    return true;
  }

  Diagnostics unsaid_;  // the checker's to report
  Environments environments_;
  TableBuilder table_;
  UseResolver names_;
  std::vector<FileNames> files_;
  std::map<std::string, Module const*> modules_;
  std::map<std::string, int> module_symbols_;
  std::map<std::string, ast::Dictionary const*> dictionaries_;
  std::map<std::string, std::pair<ast::Candidates const*, int>> candidates_;
  std::map<std::string, DataScope> data_;
  std::map<std::string, std::pair<ast::Task const*, int>> tasks_;
  std::map<ast::Candidates const*, Scopes> scopes_of_candidates_;
  std::map<std::string, std::set<NameScope const*>> joined_;  // by data block: what its tasks bring it together with
};

}  // namespace

SymbolTable resolve(ast::File const& file, std::vector<Module> const& modules) { return Resolver(file, modules).run(); }

}  // namespace sysid::assist
