// Prose for a terminal: long lines go on below, broken between words.
#pragma once
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace sysid {

/// One line (without its end) in lines of at most `columns`, where its words allow; what goes on is four further in. Lines of
/// tables, pictures and marked sources, whose columns have a meaning, are left as they are.
std::string wrapped(std::string_view line, int columns);

/// Columns of the terminal behind a file descriptor; 0 where there is none.
int terminal_columns(int descriptor);

/// Passes on what is written, line by line, wrapped for the terminal behind the descriptor; as it is where there is none.
class WrappedOutput : public std::ostream {
 public:
  WrappedOutput(std::ostream& sink, int descriptor);
  ~WrappedOutput() override;

 private:
  class Lines : public std::streambuf {
   public:
    Lines(std::ostream& sink, int descriptor) : sink_(sink), descriptor_(descriptor) {}
    void end();

   protected:
    int_type overflow(int_type character) override;
    std::streamsize xsputn(char const* text, std::streamsize count) override;
    int sync() override;

   private:
    void put(char character);

    std::ostream& sink_;
    int descriptor_;
    std::string line_;    // what has come of it
    bool begun_ = false;  // part of the line has been passed on
  };

  Lines lines_;
};

}  // namespace sysid
