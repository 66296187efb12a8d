// The CSV reader: what it accepts, and that everything else is an error with its row and column.
#include "data/table/table.hpp"

#include <doctest/doctest.h>

#include <clocale>
#include <cmath>
#include <filesystem>

#include "core/numeric/random.hpp"
#include "core/text/diagnostic.hpp"
#include "data/temporary_file.hpp"

using namespace sysid;

namespace {

Table parse(std::string bytes) { return Table::parse("run.csv", std::move(bytes)); }

/// The diagnostic that `action` throws.
template <class Action>
Diagnostic thrown(Action action) {
  try {
    action();
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  FAIL("nothing was thrown");
  return {};
}

Diagnostic error_of(std::string bytes) {
  return thrown([&] { parse(std::move(bytes)); });
}
Diagnostic error_of(std::string bytes, std::string const& column) {
  return thrown([&] { parse(std::move(bytes)).numbers(column); });
}

using Numbers = std::vector<double>;

}  // namespace

TEST_CASE("a plain file gives its columns by name") {
  Table const table = parse("t,force,y\n0,1.5,-2e-3\n0.001,.5,3.\n");
  CHECK(table.rows() == 2);
  CHECK(table.columns() == std::vector<std::string>{"t", "force", "y"});
  CHECK(table.numbers("t") == Numbers{0, 0.001});
  CHECK(table.numbers("force") == Numbers{1.5, 0.5});
  CHECK(table.numbers("y") == Numbers{-2e-3, 3});
}

TEST_CASE("semicolons and tabs separate as well as commas") {
  CHECK(parse("a;b\n1;2\n").numbers("b") == Numbers{2});
  CHECK(parse("a\tb\n1\t2\n").numbers("b") == Numbers{2});
  CHECK(parse("a [m, SI];b;c\n1;2;3\n").numbers("c") == Numbers{3});  // the more frequent one
  CHECK(parse("\"a;b;c\",d\n1,2\n").numbers("d") == Numbers{2});      // those in quotes do not count
}

TEST_CASE("line ends of every system read the same") {
  for (char const* text :
       {"a,b\n1,2\n3,4\n", "a,b\r\n1,2\r\n3,4\r\n", "a,b\r1,2\r3,4\r", "a,b\n1,2\n3,4", "a,b\n1,2\n3,4\n\n \n"}) {
    CAPTURE(text);
    Table const table = parse(text);
    CHECK(table.columns() == std::vector<std::string>{"a", "b"});
    CHECK(table.numbers("b") == Numbers{2, 4});
  }
}

TEST_CASE("a byte order mark and comments at the head are skipped, and lines counted all the same") {
  Table const table = parse("\xef\xbb\xbf# measured in the lab\n\n # twice\na,b\n1,2\n");
  CHECK(table.columns() == std::vector<std::string>{"a", "b"});
  CHECK(table.numbers("a") == Numbers{1});
  CHECK(table.line(1) == 5);
}

TEST_CASE("quoted names and cells may hold separators and quotes") {
  Table const table = parse("\"force, [N]\",\"say \"\"y\"\"\",note\n\"1\",\" 2 \",\"up, then \"\"down\"\"\"\n");
  CHECK(table.columns() == std::vector<std::string>{"force, [N]", "say \"y\"", "note"});
  CHECK(table.numbers("force, [N]") == Numbers{1});
  CHECK(table.numbers("say \"y\"") == Numbers{2});
}

TEST_CASE("blanks around names and numbers and a leading plus are allowed") {
  Table const table = parse(" a , b \n +1.5 ,\t2e+1 \n");
  CHECK(table.numbers("a") == Numbers{1.5});
  CHECK(table.numbers("b") == Numbers{20});
}

TEST_CASE("an empty cell and NA are missing") {
  Numbers const values = parse("a,b\n1,\n2,NA\n3, \n4,\"\"\n5,6\n").numbers("b");
  for (std::size_t i = 0; i < 4; ++i) CHECK(std::isnan(values[i]));
  CHECK(values[4] == 6);
}

TEST_CASE("an empty line inside a file of one column is a missing value") {
  Numbers const values = parse("y\n1\n\n3\n\n").numbers("y");
  REQUIRE(values.size() == 3);
  CHECK(std::isnan(values[1]));
  CHECK(values[2] == 3);
}

TEST_CASE("numbers are read to the last bit") {
  CHECK(parse("a\n0.1\n1e23\n2.2250738585072011e-308\n4.9e-324\n").numbers("a") ==
        Numbers{0.1, 1e23, 2.2250738585072011e-308, 4.9e-324});
  CHECK(parse("a\n1e-400\n").numbers("a") == Numbers{0});
}

TEST_CASE("the decimal point is a point under a locale that writes a comma") {
  std::string const before = std::setlocale(LC_ALL, nullptr);
  for (char const* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) {
    if (std::setlocale(LC_ALL, name) == nullptr) continue;
    CHECK(parse("a\n1.5\n").numbers("a") == Numbers{1.5});
    CHECK(error_of("a;b\n1,5;2\n", "a").code == "E4010");
  }
  std::setlocale(LC_ALL, before.c_str());
}

TEST_CASE("a column that nobody asks for may hold anything") {
  Table const table = parse("a,note,c\n1,started late,2\n2,nan,3\n");
  CHECK(table.numbers("c") == Numbers{2, 3});
}

TEST_CASE("text in a column of numbers is an error that names file, row, line and column") {
  Diagnostic const error = error_of("# head\na,b\n1,2\n3,4 N\n", "b");
  CHECK(error.code == "E4010");
  CHECK(error.message == "`run.csv` row 2 (line 4), column `b`: `4 N` is not a number");
  for (char const* cell : {"1.2.3", "0x10", "+-1", "--1", "1e", "-", "+", "NaNa", "n/a", "1 2", "null", "1d3"}) {
    CAPTURE(cell);
    CHECK(error_of(std::string("a\n") + cell + "\n", "a").code == "E4010");
  }
}

TEST_CASE("a decimal comma is an error that says so") {
  Diagnostic const error = error_of("a;b\n1,5;2\n", "a");
  CHECK(error.code == "E4010");
  CHECK(error.help == "write a decimal point instead of the comma");  // one row shows no notation
  CHECK(error_of("a;b\n1,5;2\n2,25;3\n", "a").help == "add this line to the data block: `read decimal = \",\"`");
}

TEST_CASE("what spreadsheets and Fortran write is named, with the number as it is to be written") {
  struct Cell {
    char const* text;
    char const* said;
  };
  for (Cell const& each : {Cell{"1,234.5", "`read thousands = \",\"`"},
                           {"1.234,5", "`read decimal = \",\", thousands = \".\"`"},
                           {"-12'345", "`read thousands = \"'\"`"},
                           {"1 234 567", "`read thousands = blank`"},
                           {"1,234", "may be 1.234 or 1234: choose"},
                           {"15D-3", "`15e-3`"},
                           {"2024-05-01 12:00:00", "the cells above it are numbers"},
                           {"12:00:01.5", "the cells above it are numbers"},
                           {"01.05.2024", "the cells above it are numbers"},
                           {"5/1/2024", "the cells above it are numbers"}}) {
    CAPTURE(each.text);
    CHECK(error_of(std::string("a;b\n1;2\n") + each.text + ";3\n", "a").help.find(each.said) != std::string::npos);
  }
  for (char const* text : {"1.2.3", "--1", "12 34", "x", "1e"}) {
    CAPTURE(text);
    CHECK(error_of(std::string("a;b\n1;2\n") + text + ";3\n", "a").help.starts_with("a missing sample"));
  }
}

TEST_CASE("a number with its unit is answered with the number, or with the unit in the data block where all are so") {
  CHECK(error_of("a;b\n1;2\n4 N;3\n", "a").help == "write the number without its unit: `4`");
  CHECK(error_of("a;b\n4.5 kN/m;2\n4 N;3\n", "a").help ==
        "save the numbers without their units, and write the unit in the data block: `a [kN/m]`");
}

TEST_CASE("the minus sign of word processors and the exponent of Fortran are read") {
  CHECK(parse("t,x\n0,−2.5\n1,1.25D+01\n2,−1.5d-02\n3,1e−3\n").numbers("x") == Numbers{-2.5, 12.5, -0.015, 1e-3});
  ReadingRules comma;
  comma.decimal = ',';
  CHECK(Table::parse("run.csv", "t;x\n0;−2,5\n1;1,25D+01\n", std::nullopt, 0, comma).numbers("x") == Numbers{-2.5, 12.5});
  // Without a point it may be a code.
  for (char const* const code : {"12D3", "1D", "D3", "1.5D", "1.5D+", "1.5DD3"}) {
    CAPTURE(code);
    CHECK(error_of(std::string("a\n") + code + "\n", "a").code == "E4010");
  }
}

TEST_CASE("a row of units under the header is named, words elsewhere are not taken for one") {
  Diagnostic const units = error_of("t,y\ns,mm\n0,1\n1,2\n", "y");
  CHECK(units.code == "E4010");
  CHECK(units.message.find("a row of units") != std::string::npos);
  CHECK(units.help == "add this line to the data block: `read units = 2`");
  CHECK(error_of("t,y\n0,mm\n0,1\n", "y").message.find("units") == std::string::npos);
  CHECK(error_of("t,y\na,mm\nb,km\n", "y").message.find("units") == std::string::npos);
}

TEST_CASE("of a row of words under a header only a unit is repeated") {
  for (char const* cell : {"N", "[N/mm]", "(m s^-2)", "kg m^2"}) {
    CAPTURE(cell);
    std::string const text = std::string("t,y\ns,") + cell + "\n0,1\n1,2\n";
    CHECK(error_of(text, "y").help == "add this line to the data block: `read units = 2`");
    ReadingRules rules;
    rules.units = UnitsPlace::line;
    rules.units_line = 2;
    CHECK(Table::parse("run.csv", text, std::nullopt, 0, rules).unit("y") == cell);
  }
  for (char const* cell :
       {"hunter2", "[hunter2]", "root:x:0", "s3cret m", "4111111111 m", "N m password", "a-key-of-32-characters-aaaaaaaaa"}) {
    CAPTURE(cell);
    Diagnostic const error = error_of(std::string("t,y\ns,") + cell + "\n0,1\n1,2\n", "y");
    CHECK(error.message.find("a row of units") != std::string::npos);
    CHECK((error.message + error.help).find(cell) == std::string::npos);
  }
}

TEST_CASE("a line that states the separator is read, and is a name where it stands below") {
  CHECK(parse("sep=;\na;b\n1;2\n").numbers("b") == Numbers{2});
  CHECK(parse("sep=\t\na\tb\n1\t2\n").numbers("b") == Numbers{2});
  CHECK(parse("sep=;\na,x;b\n1;2\n").columns() == std::vector<std::string>{"a,x", "b"});
  CHECK(error_of("sep=|\na|b\n1|2\n", "b").code == "E4002");
  CHECK(parse("# head\nsep=;,b\n1,2\n").numbers("b") == Numbers{2});
}

TEST_CASE("a bare NaN or an infinity is an error, not a missing value") {
  for (char const* cell : {"NaN", "nan", "NAN", "-nan", "+nan", "inf", "-inf", "Inf", "+Infinity", "\"NaN\""}) {
    CAPTURE(cell);
    Diagnostic const error = error_of(std::string("a,b\n1,2\n3,") + cell + "\n", "b");
    CHECK(error.code == "E4011");
    CHECK(error.message.find("row 2 (line 3), column `b`") != std::string::npos);
  }
}

TEST_CASE("a number beyond the doubles is an error") { CHECK(error_of("a\n1e400\n", "a").code == "E4012"); }

TEST_CASE("a ragged row is an error") {
  Diagnostic const few = error_of("a,b,c\n1,2,3\n1,2\n");
  CHECK(few.code == "E4005");
  CHECK(few.message == "`run.csv` row 2 (line 3) has 2 cells, but the header names 3 columns");
  CHECK(error_of("a,b\n1,2,3\n").code == "E4005");
  CHECK(error_of("a,b\n1,2,\n").code == "E4005");
  Diagnostic const empty = error_of("a,b\n1,2\n\n3,4\n");
  CHECK(empty.code == "E4005");
  CHECK(empty.message.find("row 2 (line 3)") != std::string::npos);
}

TEST_CASE("halves of numbers with a decimal comma get no names of their own") {
  CHECK(error_of("t,P,T\n0,0,21,528\n10,0,21,497\n20,0,21,537\n").help.find("columns") == std::string::npos);
  CHECK(error_of("t,P,T\n0,0,21,528\n10,0,21,497\n20,0,21,537\n").help.find("export the file again with `;`") != std::string::npos);
  CHECK(error_of("t,P,T\n0,0,2.5,5\n10,0,2.1,4\n20,0,2.1,7\n").help.find("columns = ") != std::string::npos);
  CHECK(error_of("a,b,c\n1,2,3\n1,2\n").help.find("decimal") == std::string::npos);
}

TEST_CASE("a comment among the rows is an error") { CHECK(error_of("a,b\n1,2\n# changed the gain\n3,4\n").code == "E4006"); }

TEST_CASE("a missing column lists the columns there are and guesses") {
  Diagnostic const error = error_of("time,force,y\n1,2,3\n", "forse");
  CHECK(error.code == "E4008");
  CHECK(error.message == "`run.csv` has no column `forse`");
  CHECK(error.help == "did you mean `force`? its columns are `time`, `force`, `y`");
  CHECK(error_of("a b c\n1 2 3\n", "b").help.find("separated by commas, semicolons or tabs") != std::string::npos);
}

TEST_CASE("a column that is there twice cannot be asked for, the others can") {
  CHECK(error_of("a,a,b\n1,2,3\n", "a").code == "E4009");
  CHECK(parse("a,a,b\n1,2,3\n").numbers("b") == Numbers{3});
}

TEST_CASE("unnamed columns are kept but cannot be asked for") {
  CHECK(parse(",t\n1,2\n").numbers("t") == Numbers{2});
  CHECK(error_of(",t\n1,2\n", "").code == "E4008");
}

TEST_CASE("a file without a header is an error") {
  CHECK(error_of("").code == "E4001");
  CHECK(error_of("# only\n# comments\n").code == "E4001");
  Diagnostic const bare = error_of("0,1.5\n1,2.5\n");
  CHECK(bare.code == "E4002");
  Diagnostic const commented = error_of("# t y\n0,1.5\n1,2.5\n");
  CHECK(commented.code == "E4002");
  CHECK(commented.help.find("columns = (\"column_1\", \"column_2\")`") != std::string::npos);
  CHECK(parse("t,1,2\n0,1,2\n").numbers("2") == Numbers{2});  // names that are numbers beside one that is not
}

TEST_CASE("bytes that are no UTF-8 text are an error") {
  CHECK(error_of(std::string("a,b\n1,\0\n", 8)).code == "E4003");
  CHECK(error_of("\xff\xfe"
                 "a")
            .code == "E4003");                           // UTF-16
  CHECK(error_of("Weg_\xb5m\n1\n").code == "E4003");     // Latin-1
  CHECK(error_of("a\n\xed\xa0\x80\n").code == "E4003");  // a surrogate
  CHECK(error_of("a\n\xc0\xaf\n").code == "E4003");      // an overlong slash
  CHECK(parse("Weg_µm,\xf0\x9f\x98\x80\n1,2\n").numbers("Weg_µm") == Numbers{1});
}

TEST_CASE("zeros among text are named with their line") {
  Diagnostic const zeros = error_of(std::string("a,b\n1,2\n3,4\n\0\0\0", 15));
  CHECK(zeros.code == "E4003");
  CHECK(zeros.message == "`run.csv` has 3 NUL bytes among its text, the first in line 4");
  CHECK(error_of(std::string("\1\2\0a\n", 5)).message == "`run.csv` is not UTF-8 text");
}

TEST_CASE("a file that ends within a line is answered with this line") {
  Diagnostic const cut = error_of("a,b,c\n1,2,3\n4,5,6\n7,8");
  CHECK(cut.code == "E4005");
  CHECK(cut.message == "`run.csv` row 3 (line 4) has 2 cells, but the header names 3 columns: the file ends within this line");
  CHECK(cut.help ==
        "delete this line; or add this line to the data block: `read values = 2..3`; 1 line below line 3 is then left out");
  // Other lines lack cells, too: this is how the file is written.
  CHECK(error_of("a,b,c\n1,2,3\n1,2,3\n1,2,3\n4,5\n7,8").help.ends_with("`read ragged = yes`"));
  CHECK(error_of("a,b,c\n1,2,3\n4,5,6\n7,8\n").help.ends_with("`read ragged = yes`"));
}

TEST_CASE("a quote that does not end is an error on its line") {
  CHECK(error_of("a,\"b\n1,2\n").code == "E4004");
  Diagnostic const error = error_of("a,b\n1,2\n\"3,4\n");
  CHECK(error.code == "E4004");
  CHECK(error.message.find("line 3") != std::string::npos);
  CHECK(error_of("a,b\n\"1\"2,3\n").code == "E4004");
}

TEST_CASE("an error carries the place of the mention when there is one") {
  Diagnostic const error = thrown([] { parse("a\nx\n").numbers("a", Span{3, 7}); });
  REQUIRE(error.primary);
  CHECK(error.primary->span == Span{3, 7});
  CHECK_FALSE(error_of("a\nx\n", "a").primary);
}

TEST_CASE("long and strange cells are shown short and clean") {
  Diagnostic const error = error_of("a\n1\n" + std::string(500, 'x') + "\n", "a");
  CHECK(error.message.size() < 150);
  std::string const umlauts = "aäöüäöüäöüäöüäöüäöüäöüäöüäöü";  // 40 bytes end inside a character
  CHECK(error_of("a\n1\n" + umlauts + "\n", "a").message.find("ä...`") != std::string::npos);
  CHECK(error_of("a\nx\x1b[31m\n", "a").message.find('\x1b') == std::string::npos);
}

TEST_CASE("a table knows the digest of its file") {
  TemporaryFile const file("abc");
  CHECK(Table::read(file.path()).digest() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("a file that cannot be read is an I/O error with path and reason") {
  try {
    Table::read("/nonexistent/run.csv");
    FAIL("nothing was thrown");
  } catch (IoError const& error) {
    CHECK(std::string(error.what()) == "cannot read `/nonexistent/run.csv`: no such file or directory");
  }
  CHECK_THROWS_AS(Table::read(std::filesystem::temp_directory_path().string()), IoError);
}

TEST_CASE("any bytes give a table or an error, and every number of a table is finite or missing") {
  constexpr std::string_view alphabet = "01.-+eE,;\t \r\n\n\"#aNAn\xc3\xa4";
  int tables = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Stream stream({.seed = 1, .index = i});
    std::string bytes = i % 2 == 0 ? "a,b\n" : "";
    for (std::uint64_t length = stream.below(30); length > 0; --length) bytes += alphabet[stream.below(alphabet.size())];
    try {
      Table const table = parse(bytes);
      ++tables;
      for (std::string const& column : table.columns()) {
        std::vector<double> const values = table.numbers(column);
        CHECK(values.size() == static_cast<std::size_t>(table.rows()));
        for (double const value : values) CHECK_FALSE(std::isinf(value));
      }
    } catch (UserError const& error) {
      CHECK(error.diagnostic().code.starts_with("E40"));
    }
  }
  CHECK(tables > 100);
}

TEST_CASE("nothing of a file that is no record is quoted, and the names and cells of a record are") {
  // A model of somebody else may name any file of the system.
  Diagnostic const passwords = error_of("root:x:0:0:secret:/root:/bin/bash\ndaemon:x:1:1:hidden:/:/bin/sh\n", "y");
  CHECK(passwords.code == "E4008");
  CHECK((passwords.message + passwords.help).find("secret") == std::string::npos);
  Diagnostic const key = error_of("KEY=secret\n", "y");
  CHECK((key.message + key.help).find("secret") == std::string::npos);
  Diagnostic const number = error_of("123456\n", "y");
  CHECK(number.code == "E4002");
  CHECK((number.message + number.help).find("123456") == std::string::npos);
  Diagnostic const cell = error_of("user,password\nann,hunter22\n", "password");
  CHECK(cell.code == "E4010");
  CHECK((cell.message + cell.help).find("hunter22") == std::string::npos);
  for (std::string const word : {"pw", "abc", "x7!", "s3cr", "hello"}) {
    CAPTURE(word);
    Diagnostic const of_a_word = error_of("user,password\nann," + word + "\n", "password");
    CHECK(of_a_word.code == "E4010");
    CHECK((of_a_word.message + of_a_word.help).find("`" + word + "`") == std::string::npos);
  }

  CHECK(error_of("time,force\n0,1\n", "forse").help.find("`force`") != std::string::npos);
  CHECK(error_of("time,force\n0,1\n1,overload\n", "force").message.find("`overload`") != std::string::npos);
  CHECK(error_of("time,force\n0,12.5 kN\n", "force").message.find("`12.5 kN`") != std::string::npos);
  CHECK(error_of("time,force\n0,n/a\n", "force").message.find("`n/a`") != std::string::npos);
  CHECK(error_of("force\n3 V\n", "force").message.find("`3 V`") != std::string::npos);
}
