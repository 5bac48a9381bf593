#include "tandem/collision/fcl/fcl_checker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "collision/random_cell.h"
#include "conformance/checker_conformance.h"
#include "tandem/collision/ssv_checker.h"
#include "tandem/robot/srdf.h"
#include "tandem/robot/urdf.h"
#include "temporary_folder.h"
#include "test_data.h"

namespace tandem::collision {

namespace {

std::unique_ptr<CollisionChecker> make_fcl(const std::shared_ptr<const world::Workcell>& cell) {
  auto checker = FclChecker::make(cell, FclGeometry::kVolumes);
  if (!checker) throw std::runtime_error(checker.error().message);
  return std::move(*checker);
}

}  // namespace

namespace conformance {

INSTANTIATE_TEST_SUITE_P(Fcl, CheckerConformance,
                         testing::Values(CheckerCase{"fcl", make_fcl, 1e-5, 1e-5, 1.0}));

}  // namespace conformance

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::Shape;
using world::PairScope;
using world::PairSelection;

bool has_cylinder(const world::Workcell& cell, int pair) {
  const auto any = [&](int body) {
    const auto& shapes = cell.bodies()[static_cast<std::size_t>(body)].shapes_L;
    return std::ranges::any_of(
        shapes, [](const Shape& s) { return s.type() == geometry::CoreType::kCylinder; });
  };
  const world::BodyPair& p = cell.pairs()[static_cast<std::size_t>(pair)];
  return any(p.a) || any(p.b);
}

struct Tally {
  int apart = 0, deep = 0;
};

/// Both checkers on one pair at one configuration.
void expect_agreement(const SsvChecker& ssv, const CollisionChecker& fcl, const VectorXd& q,
                      int pair, CollisionChecker::Scratch& ssv_scratch,
                      CollisionChecker::Scratch& fcl_scratch, Tally& tally) {
  const world::Workcell& cell = ssv.cell();
  const PairClearance a = ssv.least_clearance(q, {pair}, ssv_scratch);
  const PairClearance b = fcl.least_clearance(q, {pair}, fcl_scratch);
  if (a.distance > 0 || !has_cylinder(cell, pair)) {
    EXPECT_NEAR(a.distance, b.distance, 1e-5) << describe(cell, a);
  } else {
    EXPECT_LE(b.distance, a.distance + 1e-5) << describe(cell, a);
  }
  (a.distance > 0 ? tally.apart : tally.deep) += 1;
  if (std::abs(a.distance) < 1e-5) return;
  EXPECT_EQ(fcl.is_free(q, {pair}, fcl_scratch), a.distance > 0) << describe(cell, a);
}

TEST(FclChecker, AgreesWithSsvCheckerOnVolumes) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto cell = test::random_cell(seed);
    const SsvChecker ssv(cell);
    const auto fcl = make_fcl(cell);
    const auto ssv_scratch = ssv.make_scratch(), fcl_scratch = fcl->make_scratch();
    Rng rng(seed);
    for (int i = 0; i < 40; ++i) {
      const VectorXd q = test::random_configuration(rng, *cell);
      for (const int pair : cell->select(PairScope::all())) {
        expect_agreement(ssv, *fcl, q, pair, *ssv_scratch, *fcl_scratch, tally);
      }
    }
  }
  EXPECT_GT(tally.apart, 10000);
  EXPECT_GT(tally.deep, 300);
}

TEST(FclChecker, AgreesWithSsvCheckerOnMeshesAndClouds) {
  int apart = 0, deep = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    test::RandomCellOptions options;
    options.surface_pieces = seed == 0 ? 5000 : 300;
    const auto cell = test::random_cell(seed, options);
    const SsvChecker ssv(cell);
    const auto fcl = make_fcl(cell);
    const auto ssv_scratch = ssv.make_scratch(), fcl_scratch = fcl->make_scratch();
    Rng rng(seed);
    for (int i = 0; i < 12; ++i) {
      const VectorXd q = test::random_configuration(rng, *cell);
      for (const int pair : cell->select(PairScope::all())) {
        const PairClearance a = ssv.least_clearance(q, {pair}, *ssv_scratch);
        const PairClearance b = fcl->least_clearance(q, {pair}, *fcl_scratch);
        (a.distance > 0 ? apart : deep) += 1;
        if (a.distance > 0) {  // Against meshes a cylinder is a prism of 128 sides around it.
          EXPECT_NEAR(a.distance, b.distance, has_cylinder(*cell, pair) ? 1e-4 : 1e-5)
              << describe(*cell, a);
        }
        if (std::abs(a.distance) < 1e-4) continue;
        EXPECT_EQ(fcl->is_free(q, {pair}, *fcl_scratch), a.distance > 0) << describe(*cell, a);
      }
    }
  }
  EXPECT_GT(apart, 3000);
  EXPECT_GT(deep, 100);
}

/// A shape on a grid, turned by right angles: every cell has such, and every tie is in them.
Shape aligned_shape(Rng& rng) {
  const auto grid = [&](double step, int from, std::size_t count) {
    return step * (from + static_cast<int>(rng.index(count)));
  };
  const auto extent = [&] { return grid(0.1, 1, 3); };
  const auto corner = [&] {
    return Vector3d(grid(0.1, -1, 3), grid(0.1, -1, 3), grid(0.1, -1, 3));
  };
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = rng.index(9); i > 0; --i) {
    const Vector3d axis = Vector3d::Unit(static_cast<int>(rng.index(3)));
    X.linear() = (Eigen::AngleAxisd(0.5 * M_PI, axis) * X.linear()).eval();
  }
  X.linear() = X.linear().array().round();
  X.translation() = corner();
  const double radius = grid(0.05, 1, 2);
  for (;;) {
    const auto shape = [&]() -> Result<Shape> {
      switch (rng.index(6)) {
        case 0:
          return Shape::sphere(X.translation(), radius);
        case 1:
          return Shape::capsule(corner(), corner(), radius);
        case 2:
          return Shape::rounded_triangle(corner(), corner(), corner(), radius);
        case 3:
          return Shape::rounded_rectangle(X, {extent(), extent()}, radius);
        case 4:
          return Shape::box(X, {extent(), extent(), extent()}, grid(0.05, 0, 2));
        default:
          return Shape::cylinder(X, 0.5 * extent(), extent(), grid(0.05, 0, 2));
      }
    }();
    if (shape) return *shape;
  }
}

TEST(FclChecker, AgreesWithSsvCheckerWhereEverythingIsAligned) {
  Tally tally;
  Rng rng(8);
  for (int i = 0; i < 4000; ++i) {
    world::WorkcellSpec spec = test::slider_cell_spec();
    spec.robots[0].volumes["carriage"] = {aligned_shape(rng)};
    Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
    for (double& p : X_WO.translation()) p = 0.1 * (static_cast<int>(rng.index(13)) - 6);
    spec.obstacles[0].shapes_W = {aligned_shape(rng).in(X_WO)};
    const SsvChecker ssv(test::make_cell(spec));
    const auto fcl = make_fcl(test::make_cell(spec));
    const auto ssv_scratch = ssv.make_scratch(), fcl_scratch = fcl->make_scratch();
    for (const double x : {0.0, 0.05, 0.4}) {
      expect_agreement(ssv, *fcl, VectorXd::Constant(1, x), 0, *ssv_scratch, *fcl_scratch, tally);
    }
  }
  EXPECT_GT(tally.apart, 5000);
  EXPECT_GT(tally.deep, 300);
}

/// A box as an OBJ file, faces outward.
std::string box_obj(const Vector3d& size) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    text << "v";
    for (int k = 0; k < 3; ++k) text << ' ' << ((i >> k) & 1 ? 0.5 : -0.5) * size[k];
    text << '\n';
  }
  for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
    text << "f " << face << '\n';
  }
  return text.str();
}

/// The slider cell whose carriage has URDF geometry; its volumes are a ball of 0.1 m.
world::WorkcellSpec urdf_slider(std::vector<robot::Geometry> collision) {
  world::WorkcellSpec spec = test::slider_cell_spec();
  std::vector<robot::Link> links = spec.robots[0].model.links();
  links[1].collision = std::move(collision);
  spec.robots[0].model = *robot::Model::make("slider", links, spec.robots[0].model.joints());
  return spec;
}

double urdf_distance(const world::WorkcellSpec& spec, double x) {
  auto checker = FclChecker::make(test::make_cell(spec), FclGeometry::kUrdf);
  if (!checker) throw std::runtime_error(checker.error().message);
  const auto scratch = (*checker)->make_scratch();
  const VectorXd q = VectorXd::Constant(1, x);
  const double distance = (*checker)->least_clearance(q, {0}, *scratch).distance;
  EXPECT_EQ((*checker)->is_free(q, {0}, *scratch), distance > 0);
  return distance;
}

TEST(FclChecker, TakesPrimitivesFromTheUrdfUnpadded) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().x() = 0.05;
  world::WorkcellSpec spec = urdf_slider({{X, robot::SphereGeometry{0.2}}});
  spec.padding = 0.03;
  EXPECT_NEAR(urdf_distance(spec, 0), 0.55, 1e-9);
  spec = urdf_slider({{X, robot::BoxGeometry{{0.2, 0.4, 0.6}}}});
  EXPECT_NEAR(urdf_distance(spec, 0), 0.65, 1e-9);
  X.linear() = Eigen::AngleAxisd(0.5 * M_PI, Vector3d::UnitY()).toRotationMatrix();
  spec = urdf_slider({{X, robot::CylinderGeometry{0.1, 0.5}}});
  EXPECT_NEAR(urdf_distance(spec, 0), 0.5, 1e-5);
}

TEST(FclChecker, MeshesOfBoxesMatchBoxes) {
  const test::TemporaryFolder folder;
  const Vector3d size(0.2, 0.4, 0.6);
  const std::string file = folder.write("box.obj", box_obj({0.1, 0.4, 0.3}));
  Rng rng(4);
  int colliding = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d X = test::random_pose(rng, 0.2);
    world::WorkcellSpec mesh =
        urdf_slider({{X, robot::MeshGeometry{file, file, Vector3d(2, 1, 2)}}});
    mesh.obstacles[0].shapes_W = {
        test::random_shape(rng, 0.3, 0.05).in(test::random_pose(rng, 0.4))};
    world::WorkcellSpec box = urdf_slider({{X, robot::BoxGeometry{size}}});
    box.obstacles = mesh.obstacles;
    const double of_mesh = urdf_distance(mesh, 0), of_box = urdf_distance(box, 0);
    // Against meshes a cylinder is a prism of 128 sides around it.
    if (of_box > 1e-4) {
      EXPECT_NEAR(of_mesh, of_box, 1e-4);
    } else {
      EXPECT_LE(of_mesh, 0);
      ++colliding;
    }
  }
  EXPECT_GT(colliding, 30);
}

TEST(FclChecker, WhatIsInsideAMeshIsInCollision) {
  const test::TemporaryFolder folder;
  const std::string file = folder.write("big.obj", box_obj({1.0, 1.0, 1.0}));
  const robot::Geometry big{Eigen::Isometry3d::Identity(),
                            robot::MeshGeometry{file, file, Vector3d::Ones()}};
  world::WorkcellSpec spec = urdf_slider({big});
  EXPECT_NEAR(urdf_distance(spec, 1.0), -0.7, 1e-6);  // A ball of 0.2 m in the middle.
  EXPECT_NEAR(urdf_distance(spec, 1.2), -0.5, 1e-6);
  EXPECT_LT(urdf_distance(spec, 1.5), 0);
  EXPECT_GT(urdf_distance(spec, 0.2), 0);
}

TEST(FclChecker, MeshesInsideMeshesAreInCollision) {
  const test::TemporaryFolder folder;
  const std::string big = folder.write("big.obj", box_obj({1.0, 1.0, 1.0}));
  const std::string small = folder.write("small.obj", box_obj({0.2, 0.2, 0.2}));
  const auto mesh = [](const std::string& file) {
    return robot::Geometry{Eigen::Isometry3d::Identity(),
                           robot::MeshGeometry{file, file, Vector3d::Ones()}};
  };
  for (const bool swapped : {false, true}) {
    world::WorkcellSpec spec = urdf_slider({mesh(swapped ? big : small)});
    std::vector<robot::Link> links = spec.robots[0].model.links();
    links[0].collision = {mesh(swapped ? small : big)};
    spec.robots[0].model = *robot::Model::make("slider", links, spec.robots[0].model.joints());
    spec.robots[0].volumes["rail"] = spec.robots[0].volumes["carriage"];
    spec.obstacles.clear();
    EXPECT_NEAR(urdf_distance(spec, 0), -0.4, 1e-7);
    EXPECT_LE(urdf_distance(spec, 0.5), 0);
    EXPECT_NEAR(urdf_distance(spec, 0.7), 0.1, 1e-7);
  }
}

// Real meshes, STL and by package: the answers agree with each other.
TEST(FclChecker, ChecksTheMeshesOfARealCell) {
  TANDEM_SKIP_WITHOUT_DATA("robots/dual_ur5e/dual_ur5e.urdf");
  const robot::PackagePath packages({test::data_path("robots/packages")});
  auto model = robot::load_urdf(test::data_path("robots/dual_ur5e/dual_ur5e.urdf"), packages);
  ASSERT_TRUE(model) << model.error().message;
  for (std::size_t j = 0; j < model->joints().size(); ++j) {
    robot::JointLimits limits = model->joints()[j].limits;
    limits.acceleration = 10;
    if (model->joints()[j].type == robot::JointType::kRevolute) {
      model->set_limits(static_cast<int>(j), limits);
    }
  }
  world::WorkcellSpec spec;
  spec.name = "dual_ur5e";
  world::RobotSpec robot;
  robot.name = "ur";
  robot.model = *model;
  robot.semantics = *robot::load_srdf(test::data_path("robots/dual_ur5e/dual_ur5e.srdf"), *model);
  for (const robot::Link& link : model->links()) {
    if (!link.collision.empty())
      robot.volumes[link.name] = {*Shape::sphere(Vector3d::Zero(), 0.01)};
  }
  spec.robots = {robot};
  for (const char* name : {"left_arm", "right_arm"}) {
    world::ArmSpec arm;
    arm.name = arm.group = name;
    arm.robot = "ur";
    spec.arms.push_back(arm);
  }
  const auto cell = test::make_cell(spec);
  auto checker = FclChecker::make(cell, FclGeometry::kUrdf);
  ASSERT_TRUE(checker) << checker.error().message;
  const auto scratch = (*checker)->make_scratch();
  const PairSelection all = cell->select(PairScope::all());
  Rng rng(6);
  int free = 0;
  for (int i = 0; i < 40; ++i) {
    const VectorXd q = test::random_configuration(rng, *cell, 0.5);
    const PairClearance least = (*checker)->least_clearance(q, all, *scratch);
    EXPECT_EQ((*checker)->is_free(q, all, *scratch), least.distance > 0);
    double least_alone = 1e9;
    for (const int pair : all) {
      least_alone =
          std::min(least_alone, (*checker)->least_clearance(q, {pair}, *scratch).distance);
    }
    if (least.distance > 0) {
      EXPECT_NEAR(least.distance, least_alone, 1e-9);
      EXPECT_NEAR((least.p_WCa - least.p_WCb).norm(), least.distance, 1e-9);
      ++free;
    } else {
      EXPECT_LE(least_alone, 0);
    }
  }
  EXPECT_GT(free, 5);
}

TEST(FclChecker, NamesWhatItCannotRead) {
  const test::TemporaryFolder folder;
  const auto error_of = [&](const std::string& uri, const std::string& path) {
    const auto checker = FclChecker::make(
        test::make_cell(urdf_slider(
            {{Eigen::Isometry3d::Identity(), robot::MeshGeometry{uri, path, Vector3d::Ones()}}})),
        FclGeometry::kUrdf);
    return checker ? Error{ErrorCode::kInvalidInput, "no error"} : checker.error();
  };
  const auto expect_error = [](const Error& error, ErrorCode code,
                               const std::vector<std::string>& parts) {
    EXPECT_EQ(error.code, code);
    for (const std::string& part : parts) {
      EXPECT_NE(error.message.find(part), std::string::npos) << error.message;
    }
  };
  expect_error(error_of("package://gone/a.stl", ""), ErrorCode::kNotFound,
               {"slider/carriage", "package://gone/a.stl", "--package-path"});
  expect_error(error_of("a.stl", "/nowhere/a.stl"), ErrorCode::kIo,
               {"slider/carriage", "/nowhere/a.stl"});
  for (const std::string& text :
       {std::string(), std::string("v 0 0 0\n"), std::string("not a mesh\n"),
        std::string("v 0 0 0\nv 1 0 0\nl 1 2\n"), std::string("f 1 2 3\n")}) {
    const std::string file = folder.write("bad.obj", text);
    expect_error(error_of("bad.obj", file), ErrorCode::kInvalidInput, {"slider/carriage", file});
  }
  const auto checker =
      FclChecker::make(test::make_cell(test::slider_cell_spec()), FclGeometry::kUrdf);
  ASSERT_FALSE(checker);
  expect_error(checker.error(), ErrorCode::kUnsupported, {"slider/carriage"});
}

}  // namespace
}  // namespace tandem::collision
