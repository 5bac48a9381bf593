// Volumes files: what was written is what is read, and still contains the mesh.

#include <gtest/gtest.h>

#include "io/workcell_files.h"
#include "meshes.h"
#include "tandem/fitting/containment.h"
#include "tandem/fitting/fit.h"
#include "tandem/io/volumes_file.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/robot/urdf.h"
#include "test_data.h"

namespace tandem::io {
namespace {

using Eigen::Vector3d;
using geometry::Shape;

robot::Model one_link() {
  robot::Link link;
  link.name = "arm";
  return *robot::Model::make("bot", {link}, {});
}

std::vector<Shape> read_back(const std::vector<Shape>& shapes) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("v.yaml", volumes_text("two\nlines", {{"arm", "a comment", shapes}}));
  const auto volumes = load_volumes(file, one_link());
  EXPECT_TRUE(volumes) << volumes.error().message;
  return volumes ? volumes->at("arm") : std::vector<Shape>{};
}

TEST(VolumesFile, EveryShapeComesBack) {
  Rng rng(4);
  for (int i = 0; i < 200; ++i) {
    const auto point = [&] {
      return Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    };
    const auto size = [&] { return rng.uniform(0.01, 0.5); };
    const Eigen::Isometry3d X = i == 0 ? Eigen::Isometry3d::Identity() : test::random_pose(rng);
    const std::vector<Shape> shapes{*Shape::sphere(point(), size()),
                                    *Shape::capsule(point(), point(), size()),
                                    *Shape::rounded_triangle(point(), point(), point(), size()),
                                    *Shape::rounded_rectangle(X, {size(), size()}, size()),
                                    *Shape::box(X, {size(), size(), size()}),
                                    *Shape::box(X, {size(), size(), size()}, size()),
                                    *Shape::cylinder(X, size(), size()),
                                    *Shape::cylinder(X, size(), size(), size())};
    const std::vector<Shape> back = read_back(shapes);
    ASSERT_EQ(back.size(), shapes.size());
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      ASSERT_EQ(back[k].type(), shapes[k].type());
      EXPECT_NEAR(back[k].radius(), shapes[k].radius(), 1e-9);
      EXPECT_NEAR(back[k].core_radius(), shapes[k].core_radius(), 1e-9);
      EXPECT_LT((back[k].origin() - shapes[k].origin()).norm(), 2e-9);
      EXPECT_LT((back[k].extents() - shapes[k].extents()).norm(), 5e-9);
    }
  }
}

TEST(VolumesFile, HoldsNoVolumesAndNoComments) {
  EXPECT_EQ(volumes_text("", {}), "links: {}\n");
  EXPECT_EQ(volumes_text("", {{"arm", "", {*Shape::sphere({0, -0.0, 0.25}, 1)}}}),
            "links:\n  arm:\n    - sphere: {center: [0, 0, 0.25], radius: 1}\n");
}

TEST(VolumesFile, FittedVolumesContainTheMeshAfterReading) {
  for (const bool is_box : {false, true}) {
    Rng rng(8);
    const auto mesh =
        test::moved(is_box ? test::box_mesh({0, 0, 0}, {0.1, 0.2, 0.3}) : test::elbow(),
                    test::random_pose(rng));
    const auto fit = fitting::fit_mesh(mesh, {.count = 2, .starts = 4});
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_FALSE(fitting::prove_containment(mesh, read_back(fit->volumes_L)));
  }
}

/// The volumes that come with the scenarios.
struct Case {
  const char* urdf;
  const char* volumes;
};

class ScenarioVolumes : public ::testing::TestWithParam<Case> {};

TEST_P(ScenarioVolumes, ContainEveryLink) {
  TANDEM_SKIP_WITHOUT_DATA(GetParam().urdf);
  const auto model = robot::load_urdf(test::data_path(GetParam().urdf),
                                      robot::PackagePath({test::data_path("robots/packages")}));
  ASSERT_TRUE(model) << model.error().message;
  const auto volumes = load_volumes(test::source_path(GetParam().volumes), *model);
  ASSERT_TRUE(volumes) << volumes.error().message;
  Rng rng(6);
  int noticed = 0;
  for (const robot::Link& link : model->links()) {
    ASSERT_EQ(volumes->contains(link.name), !link.collision.empty()) << link.name;
    if (link.collision.empty()) continue;
    const auto mesh = fitting::link_mesh(link);
    ASSERT_TRUE(mesh) << mesh.error().message;
    const std::vector<Shape>& shapes = volumes->at(link.name);
    const auto gap = fitting::prove_containment(mesh->mesh_L, shapes);
    EXPECT_FALSE(gap) << link.name << " sticks out near " << gap->p_LG.transpose();
    EXPECT_LE(test::sticks_out(mesh->mesh_L, shapes, rng, 20000), 0) << link.name;
    std::vector<Shape> smaller;
    for (const Shape& shape : shapes) {
      smaller.push_back(shape.padded(-std::min(1e-4, shape.radius() / 2)));
    }
    noticed += fitting::prove_containment(mesh->mesh_L, smaller).has_value();
  }
  EXPECT_EQ(noticed, static_cast<int>(volumes->size()));
}

INSTANTIATE_TEST_SUITE_P(
    Fitted, ScenarioVolumes,
    ::testing::Values(Case{"robots/fr3_duo/fr3_duo.urdf", "scenarios/robots/fr3_duo.volumes.yaml"},
                      Case{"robots/dual_ur5e/dual_ur5e.urdf",
                           "scenarios/robots/dual_ur5e.volumes.yaml"}),
    [](const auto& tested) { return tested.index == 0 ? "Fr3Duo" : "DualUr5e"; });

}  // namespace
}  // namespace tandem::io
