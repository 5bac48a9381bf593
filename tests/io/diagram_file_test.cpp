#include "tandem/io/diagram_file.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "conformance/coordination_cells.h"
#include "tandem/coordination/diagram_coordinator.h"
#include "temporary_folder.h"
#include "test_data.h"

namespace tandem::io {
namespace {

using Json = nlohmann::json;
using coordination::DiagramDrawing;

struct Drawn {
  coordination::test::CoordinationCase c = coordination::test::crossing();
  DiagramDrawing drawing;

  Drawn() {
    const auto problem = c.problem();
    const auto schedules =
        coordination::make_diagram_coordinator()->alternatives(problem, 2, 1, {}).value();
    drawing = coordination::draw_diagram(problem, 0, 1, schedules, 0.04).value();
  }
  const world::Workcell& cell() const { return c.checker->cell(); }
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

TEST(DiagramFile, HoldsWhatTheDrawingDoes) {
  const Drawn d;
  const Json json = Json::parse(diagram_json(d.drawing, d.cell(), "cross"));
  EXPECT_EQ(json["schema_version"], 1);
  EXPECT_EQ(json["workcell"], "discs");
  EXPECT_EQ(json["query"], "cross");
  EXPECT_EQ(json["arms"], Json({"a", "b"}));
  EXPECT_EQ(json["durations"], Json({1.0, 1.0}));
  ASSERT_EQ(json["cells"].size(), d.drawing.cells.size());
  double area = 0;
  int blocked = 0;
  for (std::size_t k = 0; k < d.drawing.cells.size(); ++k) {
    const Json& cell = json["cells"][k];
    EXPECT_EQ(cell[0].get<double>(), d.drawing.cells[k].x0);
    EXPECT_EQ(cell[3].get<double>(), d.drawing.cells[k].y1);
    area += (cell[2].get<double>() - cell[0].get<double>()) *
            (cell[3].get<double>() - cell[1].get<double>());
    EXPECT_EQ(cell[5].is_null(), cell[4] == "free");
    if (cell[4] != "blocked") continue;
    ++blocked;
    EXPECT_EQ(json["pairs"][cell[5].get<std::size_t>()], "a/disc and b/disc");
  }
  EXPECT_NEAR(area, 1.0, 1e-9);
  EXPECT_GT(blocked, 0);
}

TEST(DiagramFile, LinesSayWhereTheyTouch) {
  const Drawn d;
  const Json json = Json::parse(diagram_json(d.drawing, d.cell(), ""));
  const Json& lines = json["lines"];
  ASSERT_GE(lines.size(), 3u);
  EXPECT_EQ(lines[0]["name"], "uncoordinated");
  EXPECT_EQ(lines[1]["name"], "slowed");
  EXPECT_EQ(lines[2]["name"], "coordinated");
  for (int k : {0, 1}) {  // Both discs are at the crossing at once.
    EXPECT_EQ(lines[k]["free"], false);
    EXPECT_EQ(lines[k]["touching"]["pair"], "a/disc and b/disc");
    EXPECT_NEAR(lines[k]["touching"]["time"].get<double>(), 0.5, 0.11);
    EXPECT_EQ(lines[k]["makespan"], 1.0);
  }
  EXPECT_EQ(lines[2]["free"], true);
  EXPECT_TRUE(lines[2]["touching"].is_null());
  EXPECT_EQ(lines[2]["places"].size(), lines[2]["times"].size());
  EXPECT_EQ(lines[2]["places"].back(), Json({1.0, 1.0}));
}

TEST(DiagramFile, TablesHaveARowForEach) {
  const Drawn d;
  const auto rows = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  const std::string cells = diagram_cells_csv(d.drawing, d.cell());
  EXPECT_TRUE(cells.starts_with("x0,y0,x1,y1,state,pair\n"));
  EXPECT_EQ(rows(cells), static_cast<long>(d.drawing.cells.size()) + 1);
  EXPECT_NE(cells.find(",blocked,\"a/disc and b/disc\"\n"), std::string::npos);
  const std::string lines = diagram_lines_csv(d.drawing);
  long places = 1;
  for (const auto& line : d.drawing.lines) places += static_cast<long>(line.schedule.places.size());
  EXPECT_EQ(rows(lines), places);
  EXPECT_NE(lines.find("\nslowed,1,1,1\n"), std::string::npos);
}

TEST(DiagramFile, IsWrittenAsItsNameSaysAndNotOverAnother) {
  const Drawn d;
  const test::TemporaryFolder folder;
  ASSERT_TRUE(save_diagram(folder.path() / "d.json", d.drawing, d.cell(), "q"));
  EXPECT_EQ(text_of(folder.path() / "d.json"), diagram_json(d.drawing, d.cell(), "q"));
  ASSERT_TRUE(save_diagram(folder.path() / "d.csv", d.drawing, d.cell(), "q"));
  EXPECT_EQ(text_of(folder.path() / "d.csv"), diagram_cells_csv(d.drawing, d.cell()));
  EXPECT_EQ(text_of(folder.path() / "d.lines.csv"), diagram_lines_csv(d.drawing));
  const auto again = save_diagram(folder.path() / "d.json", d.drawing, d.cell(), "q");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kInvalidInput);
  EXPECT_TRUE(save_diagram(folder.path() / "d.json", d.drawing, d.cell(), "q", true));
}

/// The example of the schema page has the keys that are written today. To write it anew, set
/// TANDEM_WRITE_EXAMPLES.
TEST(DiagramFile, ExampleHasTheKeysOfToday) {
  const Drawn d;
  const auto file = test::source_path("tests/io/diagrams/crossing.json");
  if (std::getenv("TANDEM_WRITE_EXAMPLES")) {
    ASSERT_TRUE(save_diagram(file, d.drawing, d.cell(), "cross", true));
  }
  const Json now = Json::parse(diagram_json(d.drawing, d.cell(), "cross"));
  const Json example = Json::parse(text_of(file));
  for (const auto& [key, value] : now.items()) {
    EXPECT_TRUE(example.contains(key)) << key;
    EXPECT_EQ(example[key].type_name(), std::string(value.type_name())) << key;
  }
  EXPECT_EQ(example.size(), now.size());
  for (const auto& [key, value] : now["lines"][0].items()) {
    EXPECT_TRUE(example["lines"][0].contains(key)) << key;
  }
  EXPECT_EQ(example["cells"][0].size(), 6u);
}

}  // namespace
}  // namespace tandem::io
