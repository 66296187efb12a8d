// Definitions of data.hpp: one rule per statement. No expression stands alone here, so a keyword commits at once.
#pragma once
#include "grammar/actions.hpp"
#include "grammar/data.hpp"

namespace sysid::grammar {

struct data_line_tag : resumes_behind_statement {};

constexpr x3::rule<data_line_tag, ast::DataStatement> data_line = wanted::data_statement;
constexpr x3::rule<struct data_statement_tag, ast::DataStatement> data_statement = wanted::data_statement;
constexpr x3::rule<struct column_tag, ast::Column> column = wanted::column;
constexpr x3::rule<struct data_file_tag, ast::DataFile> data_file = "a file";
constexpr x3::rule<struct data_time_tag, ast::DataTime> data_time = "a time column";
constexpr x3::rule<struct data_rate_tag, ast::DataRate> data_rate = "a rate";
constexpr x3::rule<struct data_input_tag, ast::DataInput> data_input = "an input column";
constexpr x3::rule<struct data_measure_tag, ast::DataMeasure> data_measure = "a measured column";
constexpr x3::rule<struct data_constant_tag, ast::DataConstant> data_constant = "a constant";
constexpr x3::rule<struct data_split_tag, ast::DataSplit> data_split = "a split";
constexpr x3::rule<struct split_part_tag, ast::SplitPart> split_part = wanted::name;
constexpr x3::rule<struct data_reading_tag, ast::DataReading> data_reading = "how the file is read";
constexpr x3::rule<struct reading_setting_tag, ast::ReadingSetting> reading_setting = wanted::name;
constexpr x3::rule<struct reading_item_tag, ast::ReadingItem> reading_item = "a value";
constexpr x3::rule<struct rows_tag> rows_word = "`rows`";
constexpr x3::rule<struct range_tag> range = "`..`";

/// A column goes by an identifier or, where its name is none, by a text.
constexpr auto column_name = [](auto& context) { x3::_val(context).name = std::move(x3::_attr(context).text); };
constexpr auto column_text = [](auto& context) { x3::_val(context).name = std::move(x3::_attr(context).value); };

/// An item keeps how it is written.
constexpr auto item_text = [](auto& context) {
  x3::_val(context).value = std::move(x3::_attr(context).value);
  x3::_val(context).quoted = true;
};
constexpr auto item_word = [](auto& context) { x3::_val(context).value = std::move(x3::_attr(context).text); };
constexpr auto item_digits = [](auto& context) {
  for (char const c : x3::_attr(context))
    if (c != ' ' && c != '\t') x3::_val(context).value += c;
};

auto const data_def = located[keyword("data") > name[to(&ast::Data::name)] > opening_brace >
                              *(data_line[append(&ast::Data::statements)] | '\n' | ';') > '}'];
auto const data_line_def = (!(x3::lit('\n') | ';' | '}' | x3::eoi)) > data_statement[take] > end_of_statement;
auto const data_statement_def = data_file[take] | data_time[take] | data_rate[take] | data_input[take] | data_measure[take] |
                                data_constant[take] | data_split[take] | data_reading[take];

auto const column_def = located[(name[column_name] | text[column_text]) >> -unit[to(&ast::Column::unit)]];
auto const data_file_def = located[word("file") > text[to(&ast::DataFile::path)]];
auto const data_time_def = located[word("time") > column[to(&ast::DataTime::column)]];
auto const data_rate_def =
    located[(word("rate") | word("step")[set(&ast::DataRate::step, true)]) > expression[to(&ast::DataRate::value)]];
auto const data_input_def =
    located[word("input") > element[to(&ast::DataInput::input)] > equals > column[to(&ast::DataInput::column)] >
            -(word("hold") > name[to(&ast::DataInput::rule)]) > -(word("error") > distribution[to(&ast::DataInput::error)])];
auto const data_measure_def =
    located[word("measure") > element[to(&ast::DataMeasure::channel)] > equals > column[to(&ast::DataMeasure::column)]];
auto const data_constant_def =
    located[word("constant") > element[to(&ast::DataConstant::parameter)] > equals > expression[to(&ast::DataConstant::value)]];
auto const data_split_def =
    located[word("split") > split_part[append(&ast::DataSplit::parts)] > *(',' > split_part[append(&ast::DataSplit::parts)])];
auto const split_part_def = located[name[to(&ast::SplitPart::name)] > equals > rows_word > expression[to(&ast::SplitPart::first)] >
                                    range > expression[to(&ast::SplitPart::last)]];
auto const data_reading_def = located[word("read") > reading_setting[append(&ast::DataReading::settings)] >
                                      *(',' > reading_setting[append(&ast::DataReading::settings)])];
auto const reading_setting_def =
    located[name[to(&ast::ReadingSetting::name)] > equals >
            (('(' > reading_item[append(&ast::ReadingSetting::items)] > *(',' > reading_item[append(&ast::ReadingSetting::items)]) >
              ')') |
             (reading_item[append(&ast::ReadingSetting::items)] >>
              -(range[set(&ast::ReadingSetting::range, true)] > reading_item[append(&ast::ReadingSetting::items)])))];
auto const reading_item_def = located[text[item_text] | name[item_word] | x3::raw[-x3::lit('-') >> plain_number][item_digits]];
auto const rows_word_def = word("rows");
auto const range_def = x3::lit("..");

BOOST_SPIRIT_DEFINE(data, data_line, data_statement, column, data_file, data_time, data_rate, data_input, data_measure,
                    data_constant, data_split, data_reading, reading_setting, reading_item, split_part, rows_word, range)

}  // namespace sysid::grammar
