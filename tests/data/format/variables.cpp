// Records in MATLAB, NetCDF and HDF5 files, made here by the libraries that read them; and what becomes of damaged ones.
#include "data/format/variables.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <matio.h>
#include <netcdf.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "core/numeric/random.hpp"
#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "data/format/hdf5_links.hpp"
#include "data/format/open_record.hpp"
#include "data/format/own_process.hpp"
#include "data/look/record_look.hpp"
#include "data/record.hpp"
#include "data/temporary_file.hpp"
#include "relative.hpp"
#include "sanitized.hpp"

using namespace sysid;

namespace {

using Numbers = std::vector<double>;

/// A path of this process that is removed at the end.
struct Scratch {
  std::string path;
  explicit Scratch(std::string const& name)
      : path((std::filesystem::temp_directory_path() / ("sysid_" + std::to_string(::getpid()) + "_" + name)).string()) {}
  ~Scratch() { std::filesystem::remove(path); }
  Scratch(Scratch const&) = delete;
};

matvar_t* doubles(char const* name, std::size_t rows, std::size_t columns, double const* values) {
  std::size_t size[2] = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, const_cast<double*>(values), 0);
}

void put(mat_t* file, matvar_t* variable) {
  Mat_VarWrite(file, variable, MAT_COMPRESSION_ZLIB);
  Mat_VarFree(variable);
}

void write_matlab(std::string const& path, mat_ft version) {
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, version);
  REQUIRE(file != nullptr);
  double const time[] = {0, 0.5, 1}, force[] = {1.5, std::nan(""), 3.5}, matrix[] = {1, 2, 3, 10, 20, 30};
  put(file, doubles("time", 3, 1, time));
  put(file, doubles("short_one", 1, 2, time));
  put(file, doubles("X", 3, 2, matrix));
  std::size_t row[2] = {1, 3}, one[2] = {1, 1};
  std::int16_t counts[] = {-3, 0, 7};
  put(file, Mat_VarCreate("counts", MAT_C_INT16, MAT_T_INT16, 2, row, counts, 0));
  char text[] = "abc";
  put(file, Mat_VarCreate("remark", MAT_C_CHAR, MAT_T_UTF8, 2, row, text, 0));
  double imaginary[] = {1, 1, 1}, real[] = {0, 0, 0};
  mat_complex_split_t parts{real, imaginary};
  put(file, Mat_VarCreate("z", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, row, &parts, MAT_F_COMPLEX));
  matvar_t* cells[2] = {doubles(nullptr, 1, 1, time), nullptr};
  put(file, Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, one, cells, 0));
  char const* fields[] = {"force", "inner"};
  char const* inner_fields[] = {"flow"};
  matvar_t* const inner = Mat_VarCreateStruct("inner", 2, one, inner_fields, 1);
  Mat_VarSetStructFieldByName(inner, "flow", 0, doubles(nullptr, 3, 1, matrix));
  matvar_t* const data = Mat_VarCreateStruct("data", 2, one, fields, 2);
  Mat_VarSetStructFieldByName(data, "force", 0, doubles(nullptr, 1, 3, force));
  Mat_VarSetStructFieldByName(data, "inner", 0, inner);
  put(file, data);
  Mat_Close(file);
}

void write_netcdf(std::string const& path, int mode) {
  int file = -1, rows = -1, columns = -1, group = -1, id = -1;
  REQUIRE(nc_create(path.c_str(), mode, &file) == NC_NOERR);
  nc_def_dim(file, "row", 3, &rows);
  nc_def_dim(file, "column", 2, &columns);
  if (mode & NC_NETCDF4)
    nc_def_grp(file, "run", &group);
  else
    group = file;
  nc_def_var(group, "time", NC_DOUBLE, 1, &rows, &id);
  nc_put_att_text(group, id, "units", 29, "seconds since 2024-05-01 12:00");
  nc_def_var(group, "force", NC_SHORT, 1, &rows, &id);
  double const scale = 0.5, offset = 100;
  short const fill = -1;
  nc_put_att_double(group, id, "scale_factor", NC_DOUBLE, 1, &scale);
  nc_put_att_double(group, id, "add_offset", NC_DOUBLE, 1, &offset);
  nc_put_att_short(group, id, "_FillValue", NC_SHORT, 1, &fill);
  int const both[] = {rows, columns};
  nc_def_var(group, "X", NC_FLOAT, 2, both, &id);
  nc_def_var(group, "label", NC_CHAR, 1, &rows, &id);
  nc_enddef(file);
  double const time[] = {0, 0.5, 1};
  short const force[] = {2, -1, 4};
  float const matrix[] = {1, 10, 2, 20, 3, 30};
  nc_inq_varid(group, "time", &id), nc_put_var_double(group, id, time);
  nc_inq_varid(group, "force", &id), nc_put_var_short(group, id, force);
  nc_inq_varid(group, "X", &id), nc_put_var_float(group, id, matrix);
  nc_inq_varid(group, "label", &id), nc_put_var_text(group, id, "abc");
  nc_close(file);
}

Diagnostic refusal(RecordFile const& record, std::string const& column) {
  try {
    (void)record.numbers(column);
  } catch (UserError const& error) {
    return error.diagnostic();
  }
  return {};
}

/// Of the message; empty where the file opens.
std::string code_of_opening(std::string const& path) {
  try {
    open_record(path, {});
  } catch (UserError const& error) {
    return error.diagnostic().code;
  }
  return {};
}

bool contains(std::string const& text, char const* part) { return text.find(part) != std::string::npos; }

/// Damaged copies are refused or read, and nothing else happens.
void damage(std::string const& path, int trials) {
  std::string const whole = read_file(path);
  int refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Stream stream({.seed = 7, .index = static_cast<std::uint64_t>(trial)});
    std::string bytes = whole;
    if (trial % 4 == 0)
      bytes.resize(stream.below(bytes.size()));
    else
      for (std::uint64_t flips = 1 + stream.below(6); flips > 0; --flips)
        bytes[stream.below(bytes.size())] ^= static_cast<char>(1U << stream.below(8));
    Scratch const file("damaged.bin");
    std::ofstream(file.path, std::ios::binary) << bytes;
    try {
      auto const record = open_record(file.path, {});
      // Each column is read in a process of its own, which takes most of the time: every third of a file, the others of later ones.
      std::vector<std::string> const columns = record->columns();
      for (std::size_t k = static_cast<std::size_t>(trial % 3); k < columns.size(); k += 3) {
        try {
          (void)record->numbers(columns[k]);
        } catch (UserError const&) {
          ++refused;
        }
      }
    } catch (UserError const& error) {
      ++refused;
      CHECK(error.diagnostic().code.starts_with("E"));
    }
  }
  CHECK(refused > 0);
}

}  // namespace

TEST_CASE("vectors, fields of structs and columns of matrices are read from MATLAB files of both kinds") {
  for (mat_ft const version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    CAPTURE(static_cast<int>(version));
    Scratch const file("record.mat");
    write_matlab(file.path, version);
    auto const record = open_record(file.path, {});
    CHECK(record->numbers("time") == Numbers{0, 0.5, 1});
    CHECK(record->numbers("counts") == Numbers{-3, 0, 7});
    CHECK(record->numbers("X[:, 2]") == Numbers{10, 20, 30});
    CHECK(record->numbers("X(3,:)") == Numbers{3, 30});
    CHECK(record->numbers("data.inner.flow") == Numbers{1, 2, 3});
    Numbers const force = record->numbers("data.force");
    CHECK((force[0] == 1.5 && std::isnan(force[1]) && force[2] == 3.5));
    CHECK(contains(refusal(*record, "X").message, "array of 3 x 2"));
    CHECK(refusal(*record, "X[:, 3]").code == "E4027");
    CHECK(contains(refusal(*record, "z").message, "is complex: save its parts as variables of their own, `z_re = real(z)`"));
    auto const left_out = record->left_out();
    CHECK(std::any_of(left_out.begin(), left_out.end(), [](auto const& each) { return each.first == "z"; }));
    CHECK(std::none_of(left_out.begin(), left_out.end(), [](auto const& each) { return each.first == "time"; }));
    CHECK(contains(refusal(*record, "remark").message, "is text"));
    CHECK(contains(refusal(*record, "cells").message, "cell array"));
    Diagnostic const missing = refusal(*record, "data.forse");
    CHECK(missing.code == "E4008");
    CHECK(contains(missing.help, "did you mean `data.force`?"));
    CHECK(contains(missing.help, "`X[:, 1]`"));
  }
}

TEST_CASE("numbers that mark missing samples are missing in a MATLAB file too, and nothing else of `read` goes with it") {
  Scratch const file("marks.mat");
  mat_t* const mat = Mat_CreateVer(file.path.c_str(), nullptr, MAT_FT_MAT5);
  double const marked[] = {1, -9999, 3};
  float const single[] = {99.9F, 2, 99.9F};
  std::size_t size[2] = {3, 1};
  put(mat, doubles("y", 3, 1, marked));
  put(mat, Mat_VarCreate("a", MAT_C_SINGLE, MAT_T_SINGLE, 2, size, const_cast<float*>(single), 0));
  Mat_Close(mat);
  ReadingRules rules;
  rules.missing = {"NaN", "-9999", "99.9"};
  rules.asked_for_missing = true;
  auto const record = open_record(file.path, rules);
  Numbers const y = record->numbers("y"), a = record->numbers("a");
  CHECK((y[0] == 1 && std::isnan(y[1]) && y[2] == 3));
  CHECK((std::isnan(a[0]) && a[1] == 2 && std::isnan(a[2])));
  CHECK(open_record(file.path, {})->numbers("y")[1] == -9999);
  rules.missing = {"-9999", "OVLD"};
  try {
    (void)open_record(file.path, rules, {}, Span{3, 4});
    FAIL("a word was taken");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E4025");
    CHECK(error.diagnostic().primary->span == Span{3, 4});
    CHECK(contains(error.diagnostic().message, "`missing` lists `OVLD`"));
  }
  rules.missing = {"-9999"};
  rules.decimal = ',';
  CHECK_THROWS_AS(open_record(file.path, rules), UserError);
}

TEST_CASE("the data block proposed for a MATLAB file lists the numbers that mark missing samples, and none for a record without") {
  Scratch const file("proposed.mat");
  for (bool const marked : {true, false}) {
    Numbers t, y;
    for (int row = 0; row < 60; ++row) {
      t.push_back(0.01 * row);
      y.push_back(marked && row % 7 == 3 ? -9999 : std::sin(0.3 * row));
    }
    mat_t* const mat = Mat_CreateVer(file.path.c_str(), nullptr, MAT_FT_MAT5);
    put(mat, doubles("t", 60, 1, t.data()));
    put(mat, doubles("y", 60, 1, y.data()));
    Mat_Close(mat);
    RecordLook const look = look_at_record(file.path);
    CHECK(contains(look.block, "read    missing = \"-9999\"") == marked);
    CHECK(contains(look.block, "read") == marked);
    CHECK(look.columns[1].missing == (marked ? 9 : 0));
    CHECK(look.columns[1].smallest > -1.1);
  }
}

TEST_CASE("an array of structs is named with what to do, also by a field of it, and so is what else is no column") {
  for (mat_ft const version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    CAPTURE(static_cast<int>(version));
    Scratch const file("structs.mat");
    mat_t* const mat = Mat_CreateVer(file.path.c_str(), nullptr, version);
    double const values[] = {1, 2, 3};
    char const* fields[] = {"values", "name"};
    matvar_t* const all = Mat_VarCreateStruct("Signal", 2, std::vector<std::size_t>{1, 3}.data(), fields, 2);
    for (std::size_t i = 0; i < 3; ++i) {
      Mat_VarSetStructFieldByName(all, "values", i, doubles("values", 3, 1, values));
      Mat_VarSetStructFieldByName(all, "name", i, doubles("name", 1, 1, values));
    }
    put(mat, all);
    put(mat, doubles("t", 3, 1, values));
    Mat_Close(mat);
    auto const record = open_record(file.path, {});
    CHECK(record->columns() == std::vector<std::string>{"t"});
    for (char const* const asked : {"Signal", "Signal(1).values", "Signal.values"}) {
      CAPTURE(asked);
      Diagnostic const found = refusal(*record, asked);
      CHECK(found.code == "E4027");
      CHECK(contains(found.message, "`Signal` of"));
      CHECK(contains(found.message, "is a 1 x 3 array of structs"));
      CHECK(contains(found.message, "`values_1 = Signal(1).values`"));
    }
    CHECK(refusal(*record, "Signals.values").code == "E4008");
    REQUIRE(record->left_out().size() == 1);
    CHECK(record->left_out()[0].first == "Signal");
  }
}

TEST_CASE("variables of NetCDF files of every kind are read by their paths, scaled, with fill values as missing samples") {
  for (int const mode : {NC_CLOBBER, NC_CLOBBER | NC_64BIT_OFFSET, NC_CLOBBER | NC_NETCDF4}) {
    CAPTURE(mode);
    Scratch const file("record.nc");
    write_netcdf(file.path, mode);
    auto const record = open_record(file.path, {});
    std::string const group = mode & NC_NETCDF4 ? "run/" : "";
    CHECK(record->numbers(group + "time") == Numbers{0, 0.5, 1});
    CHECK(record->unit(group + "time") == "seconds");
    Numbers const force = record->numbers(group + "force");
    CHECK((force[0] == 101 && std::isnan(force[1]) && force[2] == 102));
    CHECK(record->numbers(group + "X[:, 2]") == Numbers{10, 20, 30});
    CHECK(contains(refusal(*record, group + "label").message, "is text"));
  }
}

TEST_CASE("a NetCDF variable with brackets in its name is read in the unit that the file states") {
  Scratch const scratch("brackets.nc");
  char const* const names[] = {"u (top)", "acc[x]", "w (1, :)"};
  double const samples[] = {1, 2, 4};
  int file = -1, rows = -1;
  REQUIRE(nc_create(scratch.path.c_str(), NC_CLOBBER | NC_NETCDF4, &file) == NC_NOERR);
  nc_def_dim(file, "row", 3, &rows);
  for (char const* const name : names) {
    int id = -1;
    REQUIRE(nc_def_var(file, name, NC_DOUBLE, 1, &rows, &id) == NC_NOERR);
    nc_put_att_text(file, id, "units", 2, "mm");
    nc_put_var_double(file, id, samples);
  }
  nc_close(file);
  for (char const* const name : names) {
    CAPTURE(name);
    CHECK(open_record(scratch.path, {})->unit(name) == "mm");
    RecordRequest request;
    request.path = scratch.path;
    request.step = 1;
    request.measured = {ColumnRequest{name, {}, unit_atom("m"), {}}};
    Diagnostics diagnostics;
    auto const record = load(request, diagnostics);
    REQUIRE(record);
    CHECK(record->measured.at(0)[2] == relative(4e-3, 1e-12));
  }
}

TEST_CASE("a unit of the file that cannot be meant gives way to the one of the data block, and to a temperature") {
  Scratch const scratch("wrong_units.nc");
  std::pair<char const*, char const*> const variables[] = {{"T", "C"}, {"x", "1"}, {"y", "mm"}};
  double const samples[] = {1, 2, 4};
  int file = -1, rows = -1;
  REQUIRE(nc_create(scratch.path.c_str(), NC_CLOBBER | NC_NETCDF4, &file) == NC_NOERR);
  nc_def_dim(file, "row", 3, &rows);
  for (auto const& [name, unit] : variables) {
    int id = -1;
    REQUIRE(nc_def_var(file, name, NC_DOUBLE, 1, &rows, &id) == NC_NOERR);
    nc_put_att_text(file, id, "units", std::strlen(unit), unit);
    nc_put_var_double(file, id, samples);
  }
  nc_close(file);
  Diagnostics diagnostics;
  auto const read = [&](char const* name, char const* stated, char const* declared) {
    RecordRequest request;
    request.path = scratch.path;
    request.step = 1;
    request.measured = {ColumnRequest{name, {}, unit_atom(declared), {}}};
    if (*stated != '\0') request.measured[0]->unit = unit_atom(stated);
    diagnostics = Diagnostics();
    return load(request, diagnostics);
  };
  auto const kelvin = read("T", "", "K"), celsius = read("T", "degC", "degC"), length = read("x", "mm", "m");
  REQUIRE((kelvin && celsius && length));
  CHECK(kelvin->measured[0][2] == doctest::Approx(277.15));
  CHECK(celsius->measured[0][2] == 4);
  CHECK(celsius->other_units.empty());
  CHECK(length->measured[0][2] == relative(4e-3, 1e-12));
  REQUIRE(length->other_units.size() == 1);
  CHECK(length->other_units[0].of_file);
  CHECK(length->other_units[0].in_name == "1");
  CHECK_FALSE(read("y", "m", "m"));  // of one kind: one of the two is wrong
  CHECK(diagnostics.all().at(0).code == "E4026");
}

TEST_CASE("a NetCDF variable is read without its sign and within its valid range, and not with a scale that is text") {
  Scratch const path("valid.nc");
  int file = -1, rows = -1, id = -1;
  REQUIRE(nc_create(path.path.c_str(), NC_CLOBBER, &file) == NC_NOERR);
  nc_def_dim(file, "row", 3, &rows);
  nc_def_var(file, "byte", NC_BYTE, 1, &rows, &id);
  nc_put_att_text(file, id, "_Unsigned", 4, "true");
  nc_def_var(file, "ranged", NC_DOUBLE, 1, &rows, &id);
  double const range[] = {-100, 100}, most = 2;
  nc_put_att_double(file, id, "valid_range", NC_DOUBLE, 2, range);
  nc_def_var(file, "limited", NC_DOUBLE, 1, &rows, &id);
  nc_put_att_double(file, id, "valid_max", NC_DOUBLE, 1, &most);
  nc_def_var(file, "scaled", NC_DOUBLE, 1, &rows, &id);
  nc_put_att_text(file, id, "scale_factor", 3, "0.1");
  nc_enddef(file);
  signed char const bytes[] = {0, 100, -36};
  double const values[] = {-100, 2, 1e20};
  nc_put_var_schar(file, 0, bytes);
  for (int variable = 1; variable <= 3; ++variable) nc_put_var_double(file, variable, values);
  nc_close(file);
  auto const record = open_record(path.path, {});
  CHECK(record->numbers("byte") == Numbers{0, 100, 220});
  for (char const* const name : {"ranged", "limited"}) {
    Numbers const read = record->numbers(name);
    CHECK((read[0] == -100 && read[1] == 2 && std::isnan(read[2])));
  }
  CHECK(contains(refusal(*record, "scaled").message, "has a `scale_factor` that is no number"));
}

TEST_CASE("marks and bounds of NetCDF variables are compared as numbers of the variable's type") {
  Scratch const path("types.nc");
  int file = -1, rows = -1, packed = -1, single = -1;
  REQUIRE(nc_create(path.path.c_str(), NC_CLOBBER, &file) == NC_NOERR);
  nc_def_dim(file, "row", 3, &rows);
  nc_def_var(file, "packed", NC_SHORT, 1, &rows, &packed);
  nc_def_var(file, "single", NC_FLOAT, 1, &rows, &single);
  int const range[] = {100, 30000};
  double const scale = 0.001, mark = 1e20, most = 0.1;
  nc_put_att_int(file, packed, "valid_range", NC_INT, 2, range);
  nc_put_att_double(file, packed, "scale_factor", NC_DOUBLE, 1, &scale);
  nc_put_att_double(file, single, "missing_value", NC_DOUBLE, 1, &mark);
  nc_put_att_double(file, single, "valid_max", NC_DOUBLE, 1, &most);
  nc_enddef(file);
  short const shorts[] = {99, 100, 30000};
  float const floats[] = {0.1F, 1e20F, 0};
  nc_put_var_short(file, packed, shorts);
  nc_put_var_float(file, single, floats);
  nc_close(file);
  auto const record = open_record(path.path, {});
  Numbers const scaled = record->numbers("packed"), marked = record->numbers("single");
  CHECK((std::isnan(scaled[0]) && scaled[1] == 100 * 0.001 && scaled[2] == 30000 * 0.001));
  CHECK((marked[0] == static_cast<double>(0.1F) && std::isnan(marked[1]) && marked[2] == 0));
}

TEST_CASE("HDF5 files of other programs have no fill values of NetCDF, and show no other file of the machine") {
  Scratch const path("instrument.h5"), other("other.bin");
  { std::ofstream(other.path) << "secret"; }
  hid_t const file = H5Fcreate(path.path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  hsize_t const count = 3;
  hid_t const space = H5Screate_simple(1, &count, nullptr);
  hid_t const counts = H5Dcreate2(file, "counts", H5T_STD_U16LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  unsigned short const clipped[] = {7, 65535, 65535};
  H5Dwrite(counts, H5T_NATIVE_USHORT, H5S_ALL, H5S_ALL, H5P_DEFAULT, clipped);
  hid_t const external = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(external, other.path.c_str(), 0, 3);
  hid_t const bytes = H5Dcreate2(file, "bytes", H5T_STD_U8LE, space, H5P_DEFAULT, external, H5P_DEFAULT);
  H5Dclose(counts);
  H5Dclose(bytes);
  H5Pclose(external);
  H5Sclose(space);
  H5Fclose(file);
  auto const record = open_record(path.path, {});
  CHECK(record->numbers("counts") == Numbers{7, 65535, 65535});
  if (!testing::sanitized) refusal(*record, "bytes");  // throws where there are numbers; sanitizers need more files
}

TEST_CASE(
    "MATLAB files of version 4 are read as their specification lays them out, in both orders of bytes, and cut ones refused") {
  auto const made = [](bool big) {
    std::string bytes;
    auto const put_bytes = [&](auto value) {
      char raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      if (big) std::reverse(raw, raw + sizeof value);
      bytes.append(raw, sizeof value);
    };
    auto const head = [&](int precision, int rows, int columns, char const* name) {
      for (int const each : {(big ? 1000 : 0) + 10 * precision, rows, columns, 0, static_cast<int>(std::strlen(name)) + 1})
        put_bytes(static_cast<std::int32_t>(each));
      bytes.append(name, std::strlen(name) + 1);
    };
    head(0, 3, 1, "t");
    for (double const each : {0.0, 0.5, 1.0}) put_bytes(each);
    head(3, 3, 2, "X");
    for (int const each : {1, -2, 3, 10, 20, 30}) put_bytes(static_cast<std::int16_t>(each));
    return bytes;
  };
  for (bool const big : {false, true}) {
    CAPTURE(big);
    Scratch const path("four.mat");
    std::string const whole = made(big);
    std::ofstream(path.path, std::ios::binary) << whole;
    auto const record = open_record(path.path, {});
    CHECK(record->columns() == std::vector<std::string>{"t", "X[:, 1]", "X[:, 2]"});
    CHECK(record->numbers("t") == Numbers{0, 0.5, 1});
    CHECK(record->numbers("X[:, 1]") == Numbers{1, -2, 3});
    for (std::size_t const left : {whole.size() - 1, whole.size() - 12, std::size_t{40}}) {
      std::ofstream(path.path, std::ios::binary | std::ios::trunc).write(whole.data(), static_cast<std::streamsize>(left));
      CHECK(code_of_opening(path.path) == "E4023");
    }
  }
}

TEST_CASE("a link of an HDF5 file to another one is named, and a damaged file is not said to have one") {
  for (bool const many : {false, true}) {
    Scratch const path("linked.h5");
    hid_t const file = H5Fcreate(path.path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hsize_t const count = 3;
    hid_t const space = H5Screate_simple(1, &count, nullptr);
    for (int i = 0; i < (many ? 20 : 1); ++i)
      H5Dclose(H5Dcreate2(file, ("y" + std::to_string(i)).c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Lcreate_external("gone.h5", "/force", file, "force", H5P_DEFAULT, H5P_DEFAULT);
    H5Sclose(space);
    H5Fclose(file);
    std::string message;
    try {
      open_record(path.path, {});
    } catch (UserError const& error) {
      message = error.diagnostic().message;
    }
    CHECK_MESSAGE(contains(message, "has a link to another file, `gone.h5`"), message);
  }
  Scratch const whole("whole.nc"), cut("cut.nc");
  write_netcdf(whole.path, NC_CLOBBER | NC_NETCDF4);
  std::string const bytes = read_file(whole.path);
  std::ofstream(cut.path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size() / 2));
  try {
    open_record(cut.path, {});
    FAIL("a cut file was read");
  } catch (UserError const& error) {
    CHECK(contains(error.diagnostic().message, "is damaged"));
  }
}

TEST_CASE("no bytes behind the end are read where a link message is cut") {
  std::string const message(
      "\x01\x0c\x40\0\0\0\0\0\0\0\0\x05"
      "force\x0c\0\0gone.h5\0/f\0",
      31);
  CHECK(external_link_in(message) == "gone.h5");
  // A piece of memory of its own for each: the sanitizers hear of a byte that is read behind it.
  for (std::size_t size = 0; size < message.size(); ++size) {
    CAPTURE(size);
    std::vector<char> const cut(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(size));
    CHECK(external_link_in(std::string_view(cut.data(), cut.size())).empty());
  }
}

TEST_CASE("work in a process of its own that waits is told from work that fails, and from work that is done") {
  OwnWork const waits = in_own_process(1U << 20U, [] { return ::pause(), std::string(); });
  CHECK(waits.end == WorkEnd::waited);
  OwnWork const fails = in_own_process(1U << 20U, []() -> std::string { throw std::runtime_error("no"); });
  CHECK(fails.end == WorkEnd::failed);
  OwnWork const done = in_own_process(1U << 20U, [] { return std::string("read"); });
  CHECK((done.end == WorkEnd::done && done.result == "read"));
}

TEST_CASE("a gzip file that is filled up with zeros is read, and one with other bytes behind it is not") {
  std::string const text = "t,y\n0,1\n1,2\n";
  std::string packed(200, '\0');
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  Scratch const path("padded.csv.gz");
  for (std::size_t const zeros : {0, 1, 500}) {
    std::ofstream(path.path, std::ios::binary | std::ios::trunc) << packed << std::string(zeros, '\0');
    CHECK(open_record(path.path, {})->numbers("y") == Numbers{1, 2});
  }
  for (std::string const& behind : {std::string("\0\0x", 3), std::string("garbage")}) {
    std::ofstream(path.path, std::ios::binary | std::ios::trunc) << packed << behind;
    CHECK(code_of_opening(path.path) == "E4023");
  }
}

TEST_CASE("a MATLAB file that was cut is refused, at whatever place, and a whole one is not") {
  for (matio_compression const how : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    Scratch const path("cut.mat");
    mat_t* const file = Mat_CreateVer(path.path.c_str(), nullptr, MAT_FT_MAT5);
    REQUIRE(file != nullptr);
    Numbers values;
    for (int i = 0; i < 2000; ++i) values.push_back(std::sin(i));
    for (char const* const name : {"t", "y"}) {
      matvar_t* const variable = doubles(name, values.size(), 1, values.data());
      Mat_VarWrite(file, variable, how);
      Mat_VarFree(variable);
    }
    Mat_Close(file);
    std::string const whole = read_file(path.path);
    CHECK(open_record(path.path, {})->numbers("y") == values);
    for (std::size_t const left :
         {whole.size() - 1, whole.size() * 3 / 4, whole.size() / 2 + 8, whole.size() / 3, std::size_t{130}}) {
      CAPTURE(left);
      std::ofstream(path.path, std::ios::binary | std::ios::trunc).write(whole.data(), static_cast<std::streamsize>(left));
      CHECK(code_of_opening(path.path) == "E4023");
    }
  }
}

TEST_CASE("damaged MATLAB and NetCDF files are refused or read, and end no program") {
  Scratch const five("five.mat"), seven("seven.mat"), classic("classic.nc"), four("four.nc");
  write_matlab(five.path, MAT_FT_MAT5);
  write_matlab(seven.path, MAT_FT_MAT73);
  write_netcdf(classic.path, NC_CLOBBER);
  write_netcdf(four.path, NC_CLOBBER | NC_NETCDF4);
  damage(five.path, 40);
  damage(seven.path, 24);
  damage(classic.path, 24);
  damage(four.path, 24);
}

TEST_CASE("structs of version 7.3 that another program than MATLAB wrote are missed, and this is said") {
  Scratch const scratch("foreign.mat");
  hid_t const settings = H5Pcreate(H5P_FILE_CREATE);
  H5Pset_userblock(settings, 512);
  hid_t const file = H5Fcreate(scratch.path.c_str(), H5F_ACC_TRUNC, settings, H5P_DEFAULT);
  REQUIRE(file >= 0);
  hsize_t const count = 3;
  hid_t const space = H5Screate_simple(1, &count, nullptr), one = H5Screate(H5S_SCALAR), word = H5Tcopy(H5T_C_S1);
  H5Tset_size(word, 6);
  hid_t const group = H5Gcreate2(file, "data", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  hid_t const force = H5Dcreate2(group, "force", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  hid_t const stroke = H5Dcreate2(group, "stroke", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  for (auto const& [object, name] : {std::pair{group, "struct"}, {force, "double"}, {stroke, "double"}}) {
    hid_t const attribute = H5Acreate2(object, "MATLAB_class", word, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, word, name);
    H5Aclose(attribute);
  }
  H5Dclose(stroke);
  H5Dclose(force);
  H5Gclose(group);
  H5Tclose(word);
  H5Sclose(one);
  H5Sclose(space);
  H5Fclose(file);
  H5Pclose(settings);
  std::string bytes = read_file(scratch.path), header = "MATLAB 7.3 MAT-file, Platform: GLNXA64";
  header.resize(124, ' ');
  bytes.replace(0, 128, header + std::string("\0\2IM", 4));
  write_file(scratch.path, bytes);
  RecordLook const look = look_at_record(scratch.path);
  REQUIRE(look.left_out.size() == 1);
  CHECK(contains(look.left_out[0].reason, "another program than MATLAB wrote this file"));
}

TEST_CASE("MATLAB's days and milliseconds since a date are no seconds: the unit that is asked for reads them") {
  struct Count {
    char const* unit;
    double first, of_second;
    bool asked;
  };
  for (Count const& each : {Count{"d", 739000.5, 1.0 / 86400, true}, Count{"ms", 1.7145e12, 1e3, true},
                            Count{"s", 1.7145e9, 1, false}, Count{"s", 0, 1, false}}) {
    CAPTURE(each.unit);
    CAPTURE(each.first);
    Numbers time, samples;
    for (int i = 0; i < 60; ++i) time.push_back(each.first + 60 * i * each.of_second), samples.push_back(i % 7);
    Scratch const scratch("counts.mat");
    mat_t* const file = Mat_CreateVer(scratch.path.c_str(), nullptr, MAT_FT_MAT5);
    put(file, doubles("t", time.size(), 1, time.data()));
    put(file, doubles("y", time.size(), 1, samples.data()));
    Mat_Close(file);
    RecordRequest request;
    request.path = scratch.path;
    request.time = ColumnRequest{"t", {}, {}, {}};
    request.measured = {ColumnRequest{"y", {}, {}, {}}};
    Diagnostics diagnostics;
    CHECK(load(request, diagnostics).has_value() != each.asked);
    if (each.asked) {
      REQUIRE(diagnostics.all().size() == 1);
      CHECK(diagnostics.all()[0].code == "E4029");
      CHECK(contains(diagnostics.all()[0].help, fmt::format("`time t [{}]`", each.unit).c_str()));
    }
    request.time->unit = unit_atom(each.unit).value();
    auto const record = load(request, diagnostics);
    REQUIRE(record);
    for (std::size_t i = 0; i < 60; ++i) CHECK(std::fabs(record->time[i] - record->time[0] - 60.0 * static_cast<double>(i)) < 2e-5);
    RecordLook const look = look_at_record(scratch.path);
    CHECK(look.time.unit == each.unit);
    CHECK(look.time.step == doctest::Approx(60).epsilon(1e-6));
    CHECK(look.time.first == (each.asked ? 0 : each.first));
    CHECK(contains(look.block, fmt::format("time    t [{}]", each.unit).c_str()));
  }
}
