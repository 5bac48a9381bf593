#include "tandem/io/table.h"

#include <gtest/gtest.h>

namespace tandem::io {
namespace {

TEST(Table, AlignsColumnsOfRaggedRows) {
  Table table;
  table.row({"name", "x", "long title"});
  table.row({"a", "12345", "1"});
  table.row({"longer name"});
  table.row({"b", "", "22"});
  EXPECT_EQ(table.text(),
            "name             x  long title\n"
            "a            12345           1\n"
            "longer name\n"
            "b                           22\n");
}

TEST(Table, EmptyTablesAndRows) {
  Table table;
  EXPECT_EQ(table.text(), "");
  table.row({});
  table.row({""});
  EXPECT_EQ(table.text(), "\n\n");
}

TEST(Table, Numbers) {
  EXPECT_EQ(Table::number(1.25, 1), "1.2");
  EXPECT_EQ(Table::number(-0.0625, 3), "-0.062");
  EXPECT_EQ(Table::number(12345, 0), "12345");
  EXPECT_EQ(Table::number(1e300, 3), "1e+300");
}

}  // namespace
}  // namespace tandem::io
