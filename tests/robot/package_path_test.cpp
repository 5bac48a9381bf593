#include "tandem/robot/package_path.h"

#include <fstream>

#include "robots.h"

namespace tandem::robot {
namespace {

namespace fs = std::filesystem;
using test::expect_error;

class PackagePathTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::path(testing::TempDir()) / (std::string("tandem_package_path_") + info->name());
    fs::remove_all(root_);
    for (const char* file : {"ws1/arm/meshes/a.stl", "ws2/arm/meshes/a.stl", "ws2/arm/meshes/b.stl",
                             "ws2/hand/c.stl", "urdf/meshes/d.stl"}) {
      fs::create_directories((root_ / file).parent_path());
      std::ofstream(root_ / file) << "solid";
    }
  }
  void TearDown() override { fs::remove_all(root_); }

  fs::path root_;
};

TEST_F(PackagePathTest, FindsTheFirstMatch) {
  const PackagePath packages({root_ / "ws1", root_ / "ws2"});
  EXPECT_EQ(packages.resolve("package://arm/meshes/a.stl", ""), root_ / "ws1/arm/meshes/a.stl");
  EXPECT_EQ(packages.resolve("package://arm/meshes/b.stl", ""), root_ / "ws2/arm/meshes/b.stl");
}

TEST_F(PackagePathTest, TakesAPackageFolderItself) {
  EXPECT_EQ(PackagePath({root_ / "ws2/hand"}).resolve("package://hand/c.stl", ""),
            root_ / "ws2/hand/c.stl");
  EXPECT_EQ(PackagePath({root_ / "ws2/hand/"}).resolve("package://hand/c.stl", ""),
            root_ / "ws2/hand/c.stl");
}

TEST_F(PackagePathTest, ReadsPlainPathsAndFileUris) {
  const PackagePath packages;
  const fs::path mesh = root_ / "urdf/meshes/d.stl";
  EXPECT_EQ(packages.resolve("meshes/d.stl", root_ / "urdf"), mesh);
  EXPECT_EQ(packages.resolve(mesh.string(), "/somewhere"), mesh);
  EXPECT_EQ(packages.resolve("file://" + mesh.string(), "/somewhere"), mesh);
}

TEST_F(PackagePathTest, SaysWhereItLooked) {
  const PackagePath packages({root_ / "ws1", root_ / "ws2"});
  expect_error(packages.resolve("package://leg/x.stl", ""), ErrorCode::kNotFound,
               {"package://leg/x.stl", "ws1", "ws2", "leg"});
  expect_error(PackagePath().resolve("package://leg/x.stl", ""), ErrorCode::kNotFound,
               {"none are given"});
  expect_error(packages.resolve("meshes/e.stl", root_ / "urdf"), ErrorCode::kNotFound,
               {"urdf/meshes/e.stl"});
  expect_error(packages.resolve("file:///no/such.stl", ""), ErrorCode::kNotFound, {"/no/such.stl"});
}

TEST_F(PackagePathTest, RejectsWhatIsNoPath) {
  const PackagePath packages({root_ / "ws1"});
  for (const char* uri : {"package://", "package://arm", "package://arm/", "package:///a.stl"}) {
    expect_error(packages.resolve(uri, ""), ErrorCode::kInvalidInput, {uri, "package://NAME/PATH"});
  }
  expect_error(packages.resolve("file://a.stl", ""), ErrorCode::kInvalidInput, {"absolute"});
  expect_error(packages.resolve("http://host/a.stl", ""), ErrorCode::kUnsupported, {"http://"});
}

TEST_F(PackagePathTest, AppendsTheEnvironment) {
  const char* before = std::getenv("ROS_PACKAGE_PATH");
  const std::string saved = before ? before : "";
  const std::string folders = std::string(":").append(root_ / "ws2").append("::/none");
  setenv("ROS_PACKAGE_PATH", folders.c_str(), 1);
  const PackagePath packages = PackagePath::with_environment({root_ / "ws1"});
  if (before) {
    setenv("ROS_PACKAGE_PATH", saved.c_str(), 1);
  } else {
    unsetenv("ROS_PACKAGE_PATH");
  }
  EXPECT_EQ(packages.resolve("package://arm/meshes/a.stl", ""), root_ / "ws1/arm/meshes/a.stl");
  EXPECT_EQ(packages.resolve("package://hand/c.stl", ""), root_ / "ws2/hand/c.stl");
  expect_error(packages.resolve("package://leg/x", ""), ErrorCode::kNotFound, {"/none"});
}

}  // namespace
}  // namespace tandem::robot
