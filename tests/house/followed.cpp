// Pages that have their reader save files (`saved as NAME`, `added to NAME`) are followed word for word in an empty folder, by the
// program itself: every file is saved, every command of a ```sh block run, and what a ```text printed block quotes is what the
// block of commands before it printed, standard output first. ```sh exits 1 says how its last command ends.
//
// ```python blocks are programs by themselves. Where the Python module is not built, pages that import it are left out.
//
// With SYSID_BLESS set in the environment, quoted blocks that leave nothing out are written anew.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "house/markdown.hpp"
#include "sanitized.hpp"
#include "temporary_folder.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

#ifdef SYSID_PYTHON
constexpr bool has_module = true;
std::string const python = "PYTHONPATH='" SYSID_PYTHON_PATH "' '" SYSID_PYTHON "'";
#else
constexpr bool has_module = false;
std::string const python = "command -v python3 > found.txt || exit 0\npython3";
#endif

bool imports_module(Page const& page) {
  return std::any_of(page.blocks.begin(), page.blocks.end(), [](Fence const& block) {
    return block.info == "python" && block.joined().find("import sysid\n") != std::string::npos;
  });
}

// The folder in which a page is followed: the program, the shipped models, and nothing else.
class Desk {
 public:
  Desk() {
    fs::create_symlink(SYSID_PROGRAM, folder_.path() / "sysid");
    fs::create_directory_symlink(root / "models", folder_.path() / "models");
  }

  void save(SavedText const& saved, std::string const& text) const {
    fs::path const place = folder_.path() / saved.name;
    fs::create_directories(place.parent_path());
    std::ofstream(place, saved.behind ? std::ios::app : std::ios::trunc) << text;
  }

  int run(std::string const& commands) {
    write_file(folder_.path() / "commands.sh", commands);
    int const status = std::system(("cd '" + folder_.path().string() + "' && timeout " + std::to_string(60 * slower) +
                                    " bash -e commands.sh > printed.txt 2> messages.txt")
                                       .c_str());
    fs::remove(folder_.path() / "commands.sh");
    printed_ = read_file(folder_.path() / "printed.txt") + read_file(folder_.path() / "messages.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string const& printed() const { return printed_; }

 private:
  TemporaryFolder folder_;
  std::string printed_;
};

void follow(Page const& page) {
  Desk desk;
  std::vector<std::pair<Fence const*, std::string>> anew;
  for (Fence const& block : page.blocks) {
    if (auto const saved = saved_text(block)) {
      desk.save(*saved, block.joined());
    } else if (block.info.starts_with("sh")) {
      int const expected = block.info.starts_with("sh exits ") ? std::stoi(block.info.substr(9)) : 0;
      int const exit = desk.run(block.joined());
      CHECK_MESSAGE(exit == expected, page.name << ":" << block.line << ": ends with " << exit << "\n" << desk.printed());
    } else if (block.info == "python") {
      int const exit = desk.run(python + " - << 'END_OF_BLOCK'\n" + block.joined() + "END_OF_BLOCK\n");
      CHECK_MESSAGE(exit == 0, page.name << ":" << block.line << ": ends with " << exit << "\n" << desk.printed());
    } else if (block.info == "text printed") {
      if (std::getenv("SYSID_BLESS") != nullptr && is_whole(block)) {
        anew.emplace_back(&block, desk.printed());
        continue;
      }
      std::string const missing = not_printed(block.text, lines_of(desk.printed()));
      CHECK_MESSAGE(missing.empty(), page.name << ":" << block.line << ": not printed here: " << missing << "\nprinted:\n"
                                               << desk.printed());
    }
  }
  for (auto each = anew.rbegin(); each != anew.rend(); ++each) bless(page, *each->first, each->second);
}

}  // namespace

TEST_CASE("pages that have their reader save files can be followed word for word") {
  int count = 0;
  for (fs::path const& path : pages()) {
    Page const page = read_page(path);
    if (!is_followed(page) || (!has_module && imports_module(page))) continue;
    CAPTURE(page.name);
    follow(page);
    ++count;
  }
  CHECK(count > 1);
}
