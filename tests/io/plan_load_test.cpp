#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "plan_samples.h"
#include "tandem/io/plan_file.h"

namespace tandem::io {
namespace {

using Json = nlohmann::ordered_json;
using test::TemporaryFolder;

/// One way to spoil a good plan file: the value at `pointer` becomes `value`, or goes if empty.
struct Damage {
  const char* pointer;
  const char* value;
  std::vector<const char*> words;  ///< That the message must have.
};

std::ostream& operator<<(std::ostream& out, const Damage& damage) {
  return out << damage.pointer << " := " << damage.value;
}

std::string good_plan() {
  const auto cell = test::small_cell();
  return *plan_json(test::rough_plan(*cell, 6), *cell, "plan.json");
}

std::string damaged(const Damage& damage) {
  Json json = Json::parse(good_plan());
  const Json::json_pointer pointer(damage.pointer);
  if (*damage.value) {
    json[pointer] = Json::parse(damage.value);
  } else {
    json[pointer.parent_pointer()].erase(pointer.back());
  }
  return json.dump();
}

void expect_refused(const TemporaryFolder& folder, const std::string& text, ErrorCode code,
                    const std::vector<const char*>& words) {
  const auto file = folder / "plan.json";
  test::write_text(file, text);
  const auto loaded = load_plan(file);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, code);
  const std::string& message = loaded.error().message;
  ASSERT_TRUE(message.starts_with(file.string())) << message;
  EXPECT_TRUE(std::regex_search(message.substr(file.string().size()),
                                std::regex("^:[1-9][0-9]*:[1-9][0-9]*: ")))
      << message;
  for (const char* word : words) {
    EXPECT_NE(loaded.error().message.find(word), std::string::npos)
        << "no '" << word << "' in: " << loaded.error().message;
  }
}

class Damaged : public testing::TestWithParam<Damage> {};

TEST_P(Damaged, IsRefusedWithKeyValueAndExpectation) {
  const TemporaryFolder folder;
  SCOPED_TRACE(GetParam().pointer);
  expect_refused(folder, damaged(GetParam()), ErrorCode::kInvalidInput, GetParam().words);
}

INSTANTIATE_TEST_SUITE_P(
    Top, Damaged,
    testing::Values(
        Damage{"/schema_version", "1", {"schema_version is 1", "expected 2 to 3", "another"}},
        Damage{"/schema_version", "\"1\"", {"schema_version is \"1\"", "whole number"}},
        Damage{"/schema_version", "", {"key schema_version is missing"}},
        Damage{"/tandem_version", "\"\"", {"tandem_version is \"\"", "not empty"}},
        Damage{"/workcell", "3", {"workcell is 3", "expected a text"}},
        Damage{"/query", "null", {"query is null"}},
        Damage{"/sede", "1", {"unknown key sede", "did you mean 'seed'"}},
        Damage{"/seed", "-1", {"seed is -1", "whole number"}},
        Damage{"/seed", "1.5", {"seed is 1.5", "whole number"}},
        Damage{"/options/preset", "", {"key options.preset is missing"}},
        Damage{"/options/presets", "1", {"unknown key options.presets", "'preset'"}},
        Damage{"/options/strategy", "true", {"options.strategy is true", "a text"}},
        Damage{"/options", "[]", {"options is a list of 0", "an object"}},
        Damage{"/start", "[1, 2]", {"start is a list of 2", "expected 8 numbers"}},
        Damage{"/goal/7", "\"a\"", {"goal[7] is \"a\"", "a number"}},
        Damage{"/goal/7", "false", {"goal[7] is false", "a number"}},
        Damage{"/goal/7", "null", {"goal[7] is null", "a number"}}));

INSTANTIATE_TEST_SUITE_P(
    TimeMap, Damaged,
    testing::Values(Damage{"/arms/0/time_map", "3", {"arms[0].time_map is 3", "an object"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1]})",
                           {"key arms[0].time_map.coefficients is missing"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1, 1], "coefficients": [[0], [0]]})",
                           {"arms[0].time_map", "knot 2 (1.000000)", "greater"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, null], "coefficients": [[0]]})",
                           {"arms[0].time_map.knots[1] is null", "a number"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[0], [0]]})",
                           {"arms[0].time_map", "2 knots need 1 segments, there are 2"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[]]})",
                           {"arms[0].time_map.coefficients[0] is a list of 0", "1 to 6 numbers"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[0, 1, 2, 3, 4, 5, 6]]})",
                           {"arms[0].time_map.coefficients[0] is a list of 7", "1 to 6 numbers"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[0, "a"]]})",
                           {"arms[0].time_map.coefficients[0][1] is \"a\"", "a number"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[-0.5]]})",
                           {"arms[0].time_map", "c is -0.500000 at knot 0",
                            "outside the motion's time"}},
                    Damage{"/arms/0/time_map",
                           R"({"knots": [0, 1], "coefficients": [[0, 100]]})",
                           {"arms[0].time_map", "c is 100.000000 at knot 1"}}));

INSTANTIATE_TEST_SUITE_P(
    Scene, Damaged,
    testing::Values(
        Damage{"/scene", "", {"key scene is missing"}},
        Damage{"/scene", "[]", {"scene is a list of 0", "an object"}},
        Damage{"/scene/objects", "", {"key scene.objects is missing"}},
        Damage{"/scene/objcts", "[]", {"unknown key scene.objcts", "'objects'"}},
        Damage{"/scene/objects/0/name", "\"\"", {"scene.objects[0].name is \"\"", "not empty"}},
        Damage{"/scene/objects/1/name", "\"table\"", {"objects[1].name", "no other object"}},
        Damage{"/scene/objects/0/link", "null", {"scene.objects[0].link is null"}},
        Damage{"/scene/objects/0/pose/xyz", "[1, 2]", {"xyz is a list of 2", "3 numbers"}},
        Damage{"/scene/objects/0/pose/quat_wxyz", "[1, 1, 0, 0]", {"quaternion of length 1"}},
        Damage{"/scene/objects/0/pose/quat_wxyz", "[0, 0, 0, 0]", {"quaternion of length 1"}},
        Damage{"/scene/objects/0/pose/rpy", "[0, 0, 0]", {"unknown key scene.objects[0].pose.rpy"}},
        Damage{"/scene/objects/0/touching", "\"wall\"", {"touching is \"wall\"", "a list"}},
        Damage{"/scene/allowed/0/reason", "", {"key scene.allowed[0].reason is missing"}},
        Damage{"/scene/allowed/0/a", "7", {"scene.allowed[0].a is 7"}}));

INSTANTIATE_TEST_SUITE_P(
    Arms, Damaged,
    testing::Values(
        Damage{"/arms", "[]", {"arms is a list of 0", "at least one arm"}},
        Damage{"/arms", "{}", {"arms is an object of 0", "expected a list"}},
        Damage{"/arms/1/name", "\"left\"", {"arms[1].name is \"left\"", "no other arm"}},
        Damage{"/arms/0/joints", "[]", {"arms[0].joints", "at least one joint"}},
        Damage{"/arms/0/joints/1", "\"left/joint1\"", {"arms[0].joints[1]", "no other joint"}},
        Damage{"/arms/0/knots", "", {"key arms[0].knots is missing"}},
        Damage{"/arms/0/knots/0", "0.5", {"arms[0]", "knot"}},
        Damage{"/arms/0/knots/1", "0.0", {"arms[0]", "knot"}},
        Damage{"/arms/0/knots/1", "[]", {"arms[0].knots[1] is a list of 0", "a number"}},
        Damage{"/arms/0/knots", "[0.0]", {"arms[0].coefficients", "one segment less", "1 knots"}},
        Damage{"/arms/1/coefficients/0/3",
               "[1, 2, 3]",
               {"arms[1].coefficients[0][3] is a list of 3", "4 numbers", "c0, c1, c2, c3"}},
        Damage{"/arms/1/coefficients/0",
               "[[0, 0, 0, 0]]",
               {"arms[1].coefficients[0] is a list of 1", "one row per joint: 4"}},
        Damage{"/arms/1/extra", "0", {"unknown key arms[1].extra"}}));

INSTANTIATE_TEST_SUITE_P(
    Report, Damaged,
    testing::Values(
        Damage{"/phases/0/path/1", "[0]", {"phases[0].path[1] is a list of 1", "8 numbers"}},
        Damage{"/phases/0/name", "7", {"phases[0].name is 7"}},
        Damage{"/report/motion_duration_s", "99", {"report.motion_duration_s is 99", "last knot"}},
        Damage{"/report/least_clearance_m", "-0.1", {"least_clearance_m is -0.1", "not negative"}},
        Damage{"/report/times_ms/total", "", {"key report.times_ms.total is missing"}},
        Damage{"/report/times_ms/totl", "1", {"unknown key report.times_ms.totl", "'total'"}},
        Damage{"/report/counts/repairs", "0.5", {"report.counts.repairs is 0.5", "whole"}},
        Damage{"/report/arms/left", "", {"key report.arms.left is missing"}},
        Damage{"/report/rungs/repair", "5000000000", {"report.rungs.repair is 5000000000"}},
        Damage{"/report/rungs", "null", {"report.rungs is null", "an object"}}));

TEST(LoadPlan, TextThatIsNoPlan) {
  const TemporaryFolder folder;
  const auto code = ErrorCode::kInvalidInput;
  expect_refused(folder, "", code, {"not JSON"});
  expect_refused(folder, "{\n\"a\": ,\n}", code, {":2:6: not JSON"});
  expect_refused(folder, "[]", code, {"the document is a list of 0", "an object"});
  expect_refused(folder, "{}", code, {"key schema_version is missing"});
  expect_refused(folder, "{\"schema_version\": 1e999}", code, {"1e999"});
  expect_refused(folder, "{\"schema_version\": 1, \"schema_version\": 1}", code,
                 {"\"schema_version\" stands twice"});
  expect_refused(folder, std::string("\xff\xfe\0", 3), code, {"not JSON"});
}

TEST(LoadPlan, CutShortAnywhereIsRefused) {
  const TemporaryFolder folder;
  const std::string text = good_plan();
  Rng rng(11);
  for (int i = 0; i < 200; ++i) {
    const std::size_t length = rng.index(text.size() - 2);  // Without "}\n" nothing is whole.
    test::write_text(folder / "plan.json", text.substr(0, length));
    EXPECT_FALSE(load_plan(folder / "plan.json")) << length;
  }
}

TEST(LoadPlan, OneChangedByteIsReadOrRefusedButNeverFatal) {
  const TemporaryFolder folder;
  const std::string text = good_plan();
  Rng rng(12);
  int refused = 0;
  for (int i = 0; i < 500; ++i) {
    std::string changed = text;
    changed[rng.index(text.size())] = static_cast<char>(rng.index(256));
    test::write_text(folder / "plan.json", changed);
    const auto loaded = load_plan(folder / "plan.json");
    if (!loaded) ++refused;
    if (loaded) {
      EXPECT_EQ(loaded->start.size(), 8);
    }
  }
  EXPECT_GT(refused, 250);
}

TEST(LoadPlan, NoFileAndNoReadableFile) {
  const TemporaryFolder folder;
  const auto missing = load_plan(folder / "none.json");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_NE(missing.error().message.find("none.json"), std::string::npos);
  const auto directory = load_plan(folder.path());
  ASSERT_FALSE(directory);
  EXPECT_EQ(directory.error().code, ErrorCode::kIo);
  EXPECT_NE(directory.error().message.find(folder.path().string()), std::string::npos);
}

}  // namespace
}  // namespace tandem::io
