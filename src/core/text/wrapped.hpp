// Text for a terminal, line by line and page by page: where it is narrower than a line, the line goes on below between words.
#pragma once
#include <functional>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace sysid {

/// What tasks print, each line in lines of at most `columns` where its words allow; what goes on is four further in. Lines of
/// tables, pictures and marked sources, whose columns have a meaning, are left as they are. columns: 0, as in all of these, where
/// there is no terminal: the text as it is.
std::string wrapped(std::string_view text, int columns);

/// A page of prose: its paragraphs, lines that follow one another in column 0, and its list items are joined and filled anew.
/// Headings, tables of Markdown, fenced lines and indented ones are left as they are.
std::string filled(std::string_view page, int columns);

/// Rows whose last column, two spaces behind the others, is prose: it goes on below itself, or below its row where there is too
/// little room beside the others.
std::string wrapped_rows(std::string_view rows, int columns);

/// Columns of the terminal behind a file descriptor; 0 where there is none.
int terminal_columns(int descriptor);

/// Passes on what is written, line by line, as a function makes it of each (without its end). Where a line is flushed before its
/// end, it is passed on as it is.
class LineOutput : public std::ostream {
 public:
  using OfLine = std::function<std::string(std::string const& line)>;
  LineOutput(std::ostream& sink, OfLine of_line);
  ~LineOutput() override;

 private:
  class Lines : public std::streambuf {
   public:
    Lines(std::ostream& sink, OfLine of_line) : sink_(sink), of_line_(std::move(of_line)) {}
    void end();

   protected:
    int_type overflow(int_type character) override;
    std::streamsize xsputn(char const* text, std::streamsize count) override;
    int sync() override;

   private:
    void put(char character);

    std::ostream& sink_;
    OfLine of_line_;
    std::string line_;    // what has come of it
    bool begun_ = false;  // part of the line has been passed on
  };

  Lines lines_;
};

/// `wrapped` for the terminal behind a descriptor, whose window may change its size between two lines.
LineOutput::OfLine wrapped_for(int descriptor);

}  // namespace sysid
