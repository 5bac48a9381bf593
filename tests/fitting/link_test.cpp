// Links: their primitives and mesh files, and whole robots.

#include <gtest/gtest.h>

#include <fstream>

#include "io/workcell_files.h"
#include "meshes.h"
#include "tandem/fitting/containment.h"
#include "tandem/fitting/fit.h"
#include "tandem/robot/urdf.h"
#include "test_data.h"

namespace tandem::fitting {
namespace {

using Eigen::Vector3d;
using geometry::CoreType;
using robot::Geometry;

robot::Link link_of(std::vector<Geometry> geometry) {
  robot::Link link;
  link.name = "arm";
  link.collision = std::move(geometry);
  return link;
}

TEST(LinkMesh, CylindersLieInsideTheirPrisms) {
  Rng rng(2);
  const Eigen::Isometry3d X_LG = test::random_pose(rng);
  const auto mesh = link_mesh(link_of({{X_LG, robot::CylinderGeometry{0.06, 0.3}}}));
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->source, "cylinder");
  double volume = 0;
  for (const auto& [a, b, c] : mesh->mesh_L.triangles) {
    const auto p = [&](int i) -> Vector3d {
      return mesh->mesh_L.vertices[static_cast<std::size_t>(i)] - X_LG.translation();
    };
    // Every face turns outward and leaves the cylinder behind it.
    const Vector3d n = X_LG.linear().transpose() * (p(b) - p(a)).cross(p(c) - p(a)).normalized();
    const double reach = 0.06 * n.head<2>().norm() + 0.15 * std::abs(n.z());
    EXPECT_GE(n.dot(X_LG.linear().transpose() * p(a)), reach - 1e-12);
    volume += p(a).dot(p(b).cross(p(c))) / 6;
  }
  EXPECT_NEAR(volume, std::numbers::pi * 0.06 * 0.06 * 0.3, 2e-3 * volume);
}

TEST(FitLink, SpheresStayAndTheRestIsFitted) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Vector3d(0.3, 0, 0);
  const auto fit =
      fit_link(link_of({{X, robot::SphereGeometry{0.04}},
                        {Eigen::Isometry3d::Identity(), robot::BoxGeometry{{0.2, 0.1, 0.1}}}}),
               {.count = 1});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_EQ(fit->source, "box, sphere");
  EXPECT_EQ(fit->triangles, 12);
  ASSERT_EQ(fit->volumes_L.size(), 2u);
  EXPECT_EQ(fit->volumes_L[1].type(), CoreType::kPoint);
  EXPECT_EQ(fit->volumes_L[1].origin(), X.translation());
  EXPECT_EQ(fit->volumes_L[1].radius(), 0.04);

  const auto only = fit_link(link_of({{X, robot::SphereGeometry{0.04}}}), {.padding = 0.01});
  ASSERT_TRUE(only);
  EXPECT_EQ(only->triangles, 0);
  EXPECT_EQ(only->volumes_L.at(0).radius(), 0.05);
}

TEST(FitLink, SaysWhatIsMissingAndWhatToDo) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "torn.stl") << "solid x\nendsolid x\n";
  const auto mesh = [](const std::string& path) {
    return link_of({{Eigen::Isometry3d::Identity(),
                     robot::MeshGeometry{"package://bot/arm.stl", path, Vector3d::Ones()}}});
  };
  const std::tuple<robot::Link, ErrorCode, const char*> cases[] = {
      {link_of({}), ErrorCode::kInvalidInput, "no collision geometry"},
      {mesh(""), ErrorCode::kNotFound, "--package-path"},
      {mesh(folder / "none.stl"), ErrorCode::kNotFound, "there is no mesh file"},
      {mesh(folder / "torn.stl"), ErrorCode::kIo, "torn.stl"}};
  for (const auto& [link, code, says] : cases) {
    const auto fit = fit_link(link, {});
    ASSERT_FALSE(fit) << says;
    EXPECT_TRUE(fit.error().code == code || fit.error().code == ErrorCode::kInvalidInput);
    EXPECT_NE(fit.error().message.find(says), std::string::npos) << fit.error().message;
    EXPECT_NE(fit.error().message.find("link 'arm'"), std::string::npos) << fit.error().message;
  }
}

robot::Model two_arms() {
  const auto link = [](const char* name, double length) {
    robot::Link made =
        link_of({{Eigen::Isometry3d::Identity(), robot::CylinderGeometry{0.05, length}}});
    made.name = name;
    return made;
  };
  robot::Link base;
  base.name = "base";
  std::vector<robot::Joint> joints;
  for (int i = 0; i < 3; ++i) {
    robot::Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent_link = 0;
    joint.child_link = i + 1;
    joints.push_back(joint);
  }
  return *robot::Model::make(
      "arms", {base, link("left", 0.2), link("right", 0.2), link("tool", 0.1)}, joints);
}

TEST(FitLinks, EqualLinksAreFittedOnce) {
  std::vector<std::string> seen;
  const auto fits = fit_links(two_arms(), {}, {.count = 1}, {},
                              [&](const std::string& link, int number, int total) {
                                EXPECT_EQ(total, 3);
                                EXPECT_EQ(number, static_cast<int>(seen.size()) + 1);
                                seen.push_back(link);
                              });
  ASSERT_TRUE(fits) << fits.error().message;
  EXPECT_EQ(seen, (std::vector<std::string>{"left", "right", "tool"}));
  EXPECT_GT((*fits)[0].seconds, 0);
  EXPECT_EQ((*fits)[1].seconds, 0);
  EXPECT_EQ((*fits)[1].link, "right");
  EXPECT_EQ((*fits)[0].volumes_L[0].radius(), (*fits)[1].volumes_L[0].radius());
  EXPECT_GT((*fits)[2].seconds, 0);
}

TEST(FitLinks, NamesAreChecked) {
  const auto tool = fit_links(two_arms(), {"tool"}, {.count = 1});
  ASSERT_TRUE(tool);
  EXPECT_EQ(tool->size(), 1u);
  const auto wrong = fit_links(two_arms(), {"tol"}, {});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kNotFound);
  EXPECT_NE(wrong.error().message.find("did you mean 'tool'?"), std::string::npos);
  EXPECT_FALSE(fit_links(two_arms(), {"base"}, {}));
}

TEST(FitLinks, TimeIsSharedOut) {
  const auto begin = Clock::now();
  const auto fits = fit_links(two_arms(), {}, {.count = 16}, StopCondition::after(0.2));
  ASSERT_TRUE(fits);
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 4);
  for (const LinkFit& fit : *fits) EXPECT_TRUE(fit.cut_short);
}

TEST(FitLinks, BaxterSaysWhichMeshIsAbsent) {
  const char* urdf = "robots/baxter_mbm/baxter.urdf";
  TANDEM_SKIP_WITHOUT_DATA(urdf);
  const auto model = robot::load_urdf(test::data_path(urdf));
  ASSERT_TRUE(model) << model.error().message;
  const auto all = fit_links(*model, {}, {.count = 1});
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().code, ErrorCode::kNotFound);
  EXPECT_NE(all.error().message.find("'torso'"), std::string::npos) << all.error().message;
  EXPECT_NE(all.error().message.find("--link"), std::string::npos) << all.error().message;
  EXPECT_TRUE(fit_links(*model, {"left_upper_elbow", "l_gripper_l_finger"}, {.count = 1}));
}

}  // namespace
}  // namespace tandem::fitting
