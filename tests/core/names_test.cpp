#include "tandem/core/names.h"

#include <gtest/gtest.h>

#include <set>

#include "tandem/core/contract.h"
#include "tandem/core/result.h"

namespace tandem {
namespace {

TEST(NearestName, FindsMisspeltNamesAndLeavesStrangersAlone) {
  const std::vector<std::string> known{"left_arm", "right_arm", "gripper"};
  EXPECT_EQ(nearest_name("left_arm", known), "left_arm");
  EXPECT_EQ(nearest_name("lefft_arm", known), "left_arm");
  EXPECT_EQ(nearest_name("right-arm", known), "right_arm");
  EXPECT_EQ(nearest_name("griper", known), "gripper");
  EXPECT_EQ(nearest_name("torso", known), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, AllowsAThirdOfTheLettersOrTwo) {
  EXPECT_EQ(nearest_name("ab", {"cd"}), "cd");  // Two letters may differ in the shortest names.
  EXPECT_EQ(nearest_name("ab", {"cde"}), "");
  EXPECT_EQ(nearest_name("abcdefghi", {"abcdefxyz"}), "abcdefxyz");
  EXPECT_EQ(nearest_name("abcdefghi", {"abcdewxyz"}), "");
}

TEST(NearestName, PrefersTheFirstOfEquals) {
  EXPECT_EQ(nearest_name("joint0", {"joint1", "joint2"}), "joint1");
}

TEST(NameHint, SuggestsOrLists) {
  EXPECT_EQ(name_hint("joint11", {"joint1", "elbow"}), "; did you mean 'joint1'?");
  EXPECT_EQ(name_hint("nothing_like_it", {"a", "b"}), "; known: a, b");
  EXPECT_EQ(name_hint("nothing_like_it", {}), "; there are none");
  const std::vector<std::string> many{"1", "2", "3", "4", "5", "6", "7", "8", "9"};
  EXPECT_EQ(name_hint("nothing_like_it", many), "; known: 1, 2, 3, 4, 5, 6, 7, 8, ...");
}

TEST(ErrorCode, NamesAreDistinct) {
  std::set<std::string> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::kCancelled); ++code) {
    names.insert(to_string(static_cast<ErrorCode>(code)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(ErrorCode::kCancelled) + 1);
  EXPECT_FALSE(names.contains("unknown"));
}

TEST(Expects, ThrowsWithPlaceAndReason) {
  EXPECT_NO_THROW(expects(true, "fine"));
  try {
    expects(false, "radius must be positive");
    FAIL() << "no exception";
  } catch (const ContractViolation& violation) {
    const std::string what = violation.what();
    EXPECT_NE(what.find("names_test.cpp:"), std::string::npos);
    EXPECT_NE(what.find("radius must be positive"), std::string::npos);
  }
}

}  // namespace
}  // namespace tandem
