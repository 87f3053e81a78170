// The grammar for texts of numbers: accepted input, and error messages of one line.
#include "base/number_rows.hpp"

#include <gtest/gtest.h>

using namespace eulastic;

namespace {

using Rows = std::vector<std::vector<double>>;

const RowFormat table{"rows of time,value", {"time", "value"}, {2}};
const RowFormat list{"rows of x,y,z", {"x", "y", "z"}, {3, 6}, true};

std::string wrong_with(const std::string &text, const RowFormat &format = table, Rows *rows = nullptr) {
  return read_rows("t.csv", text, format, [&](const std::vector<double> &row) {
    if (rows) rows->push_back(row);
    return std::string(row[0] == 99 ? "99 is refused" : "");
  });
}

Rows rows_of(const std::string &text, const RowFormat &format = table) {
  Rows rows;
  EXPECT_EQ(wrong_with(text, format, &rows), "") << text;
  return rows;
}

}  // namespace

TEST(NumberRows, EverySeparatorHeaderAndComment) {
  const Rows wanted{{0, 1}, {0.5, -2e-3}};
  for (const char *text :
       {"0,1\n0.5,-2e-3\n", "0;1\n0.5;-2e-3", "0 1\n.5   -.002", "0\t1\r\n\r\n.5\t-2E-3\r\n", "0 , 1\n 0.5\t,\t-.002 ",
        "\xEF\xBB\xBFtime,value\n0,1\n0.5,-2e-3\n", "time value\n0 1\n.5 -2e-3", "\"Time\";\"Value\"\n0;+1\n0.5;-2e-3",
        "# a beat\n\n  # more\ntime (s), flow [ml/s]\n# units above\n0,1 # first\n0.5,-2e-3# last"})
    EXPECT_EQ(rows_of(text), wanted) << text;
  EXPECT_EQ(rows_of("2\n1 2 3\n4 5 6 7 8 9\n", list), (Rows{{1, 2, 3}, {4, 5, 6, 7, 8, 9}}));
  EXPECT_EQ(rows_of("# cells\n1\nx y z\n1 2 3\n", list), (Rows{{1, 2, 3}}));
  EXPECT_EQ(rows_of("1\n2 3\n4", {"numbers", {}, {}}), (Rows{{1}, {2, 3}, {4}}));
}

TEST(NumberRows, OneLineSaysFileLineAndWhatIsExpected) {
  const std::string end = "; accepted: rows of time,value";
  EXPECT_EQ(wrong_with("0,1\n\n1,x\n"), "t.csv line 3: \"x\" is not a number" + end);
  EXPECT_EQ(wrong_with("time,value\n1,,2\n"), "t.csv line 2: an item is empty" + end);
  EXPECT_EQ(wrong_with("0,1\n1,2,\n"), "t.csv line 2: an item is empty" + end);
  EXPECT_EQ(wrong_with("0,1\n1,nan\n"), "t.csv line 2: \"nan\" is not finite" + end);
  EXPECT_EQ(wrong_with("0,1\n1,2,3\n"), "t.csv line 2: a row has 3 numbers" + end);
  EXPECT_EQ(wrong_with("0,1\ntime,value\n"), "t.csv line 2: \"time\" is not a number" + end);
  EXPECT_EQ(wrong_with("0,1\n99,1\n"), "t.csv line 2: 99 is refused" + end);
  EXPECT_EQ(wrong_with("value,time\n1,2\n"), "t.csv line 1: column value is number 1" + end);
  EXPECT_EQ(wrong_with("# nothing\ntime,value\n"), "t.csv holds no numbers" + end);
  EXPECT_EQ(wrong_with(std::string("\xFF\xFE\x30\0,\0", 6)), "t.csv line 1: \"??0?\" is not a number" + end);
}

// A decimal comma would give additional numbers, and a number with a unit might be taken for a header.
TEST(NumberRows, NoNumberIsTakenForAnother) {
  EXPECT_NE(wrong_with("1,5;2,5;3,5\n", list).find("\"1,5\" is not a number"), std::string::npos);
  EXPECT_NE(wrong_with("1,5 2,5 3,5\n", list).find("\"5 2\" is not a number"), std::string::npos);
  EXPECT_NE(wrong_with("6um 5um 5um\n1 2 3\n", list).find("line 1: \"6um\""), std::string::npos);
  EXPECT_NE(wrong_with("3\n1 2 3\n4 5 6\n", list).find("line 1: says that 3 rows follow, but 2 do"), std::string::npos);
  EXPECT_NE(wrong_with("1.5\n1 2 3\n", list).find("line 1: \"1.5\" is not a number of rows"), std::string::npos);
  EXPECT_NE(wrong_with("1 2 3\n2\n", list).find("line 2: a row has 1 number;"), std::string::npos);
}

TEST(NumberRows, ACommentLineNamesANumber) {
  const RowFormat named{"rows of time,value", {"time", "value"}, {2}, false, "period"};
  const auto read = [&](const std::string &text, double *period) {
    return read_rows(
        "t.csv", text, named, [](const std::vector<double> &) { return std::string(); }, period);
  };
  for (const char *line : {"# period 0.8", "#PERIOD\t.8", "  #   Period +8e-1\r"}) {
    double period = 0;
    EXPECT_EQ(read(std::string(line) + "\n0,1\n", &period), "") << line;
    EXPECT_EQ(period, 0.8) << line;
    EXPECT_EQ(read(std::string("0,1\n") + line, &period), "") << line;
    EXPECT_EQ(wrong_with(std::string(line) + "\n0,1\n"), "") << line;  // without a meaning in other texts
  }
  double period = 0;
  EXPECT_EQ(read("# periodic\n# the period is 3\n0,1 # period 4\n", &period), "");
  EXPECT_EQ(period, 0);
  for (const char *wrong :
       {"# period", "# period = 0.8", "# period 0.8 s", "# period -1", "# period inf", "# period 0,8"})
    EXPECT_NE(read(std::string(wrong) + "\n0,1\n", &period).find("t.csv line 1: \"period"), std::string::npos) << wrong;
  EXPECT_EQ(read("# period 1\n0,1\n# period 1\n", &period),
            "t.csv line 3: \"period 1\" is repeated; accepted: one line # period T with a number T > 0, or other "
            "comments");
}
