#include "tandem/collision/ssv_checker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_cell.h"
#include "conformance/checker_conformance.h"
#include "tandem/collision/ssv_scratch.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {
namespace conformance {

INSTANTIATE_TEST_SUITE_P(Ssv, CheckerConformance,
                         testing::Values(CheckerCase{
                             "ssv", [](auto cell) { return std::make_unique<SsvChecker>(cell); }}));

}  // namespace conformance

namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using world::PairScope;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// A body's pieces in W, and its closed meshes.
struct Pieces {
  std::vector<geometry::Shape> shapes_W;
  std::vector<std::pair<const geometry::Surface*, Eigen::Isometry3d>> solids;  ///< With X_WS.
};

Pieces pieces(const world::Body& body, const Eigen::Isometry3d& X_WL) {
  Pieces all;
  for (const geometry::Shape& shape_L : body.shapes_L) {
    all.shapes_W.push_back(shape_L.padded(body.padding).in(X_WL));
  }
  for (const auto& [surface, X_LS] : body.surfaces_L) {
    for (int i = 0; i < surface->piece_count(); ++i) {
      all.shapes_W.push_back(surface->piece(i, body.padding).in(X_WL * X_LS));
    }
    if (surface->is_closed()) all.solids.emplace_back(surface.get(), X_WL * X_LS);
  }
  return all;
}

/// Whether a closed mesh winds around a point.
bool encloses(const geometry::Surface& mesh, const Vector3d& p_S) {
  double solid_angle = 0;
  for (const auto& [i, j, k] : mesh.triangles()) {
    const Vector3d a = mesh.vertices()[index(i)] - p_S, b = mesh.vertices()[index(j)] - p_S,
                   c = mesh.vertices()[index(k)] - p_S;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2 * std::atan2(a.dot(b.cross(c)),
                                  la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(solid_angle) > 2 * M_PI;
}

bool any_inside(const Pieces& inner, const Pieces& outer) {
  for (const auto& [mesh, X_WS] : outer.solids) {
    for (const geometry::Shape& shape_W : inner.shapes_W) {
      if (encloses(*mesh, X_WS.inverse() * shape_W.support(Vector3d::UnitZ()))) return true;
    }
  }
  return false;
}

struct BruteForce {
  double distance;  ///< Least of all pieces.
  bool inside;      ///< A piece's core has a point inside a closed mesh.
  bool solid;       ///< There is a closed mesh: depths in it are more than those of its triangles.
};

/// Every piece against every piece, with poses from the robot module: no bounding volumes.
BruteForce brute_force(const world::Workcell& cell, const robot::LinkPoses& X_WL, int pair) {
  const world::Body& body_a = cell.bodies()[index(cell.pairs()[index(pair)].a)];
  const world::Body& body_b = cell.bodies()[index(cell.pairs()[index(pair)].b)];
  const Pieces a = pieces(body_a, X_WL[index(body_a.link)]);
  const Pieces b = pieces(body_b, X_WL[index(body_b.link)]);
  BruteForce least{std::numeric_limits<double>::infinity(), any_inside(a, b) || any_inside(b, a),
                   !a.solids.empty() || !b.solids.empty()};
  for (const geometry::Shape& shape_a : a.shapes_W) {
    for (const geometry::Shape& shape_b : b.shapes_W) {
      // Far apart is told from the centres: exact, and what keeps thousands of pieces bearable.
      const double at_least = (shape_a.bounding_center() - shape_b.bounding_center()).norm() -
                              shape_a.bounding_radius() - shape_b.bounding_radius();
      if (at_least > least.distance) continue;
      least.distance = std::min(least.distance, geometry::clearance(shape_a, shape_b).distance);
    }
  }
  return least;
}

struct BruteTally {
  int free = 0, touching = 0, inside_only = 0;
};

/// The checker on one pair at a placed configuration.
void expect_brute_force(const SsvChecker& checker, const VectorXd& q, const BruteForce& exact,
                        int pair, double needed, CollisionChecker::Scratch& scratch,
                        BruteTally& tally) {
  const double found = checker.least_clearance(q, {pair}, scratch).distance;
  const double within = checker.pair_distance(pair, needed, scratch);
  const bool touching = exact.distance <= 0 || exact.inside;
  if (std::abs(exact.distance) > 1e-9) {
    EXPECT_EQ(checker.is_free(q, {pair}, scratch), !touching);
  }
  const double allowed = exact.distance > 0 ? 1e-8 : 1e-6;
  touching ? ++tally.touching : ++tally.free;
  if (touching && exact.solid) {
    EXPECT_LE(found, std::min(exact.distance + allowed, 0.0));
    EXPECT_LE(within, std::max(needed, found) + allowed);
    if (exact.distance > 0) ++tally.inside_only;
    return;
  }
  EXPECT_NEAR(found, exact.distance, allowed);
  if (exact.distance < needed - allowed) {
    EXPECT_NEAR(within, exact.distance, allowed);
  } else {
    EXPECT_LE(within, exact.distance + allowed);
    EXPECT_GE(within, needed - allowed);
  }
}

BruteTally compare_with_brute_force(const test::RandomCellOptions& options, std::uint64_t cells,
                                    int configurations) {
  BruteTally tally;
  for (std::uint64_t seed = 0; seed < cells; ++seed) {
    const SsvChecker checker(test::random_cell(seed, options));
    const world::Workcell& cell = checker.cell();
    const auto scratch = checker.make_scratch();
    const auto all = cell.select(PairScope::all());
    Rng rng(seed);
    VectorXd positions;
    robot::LinkPoses X_WL;
    for (int i = 0; i < configurations; ++i) {
      const VectorXd q = test::random_configuration(rng, cell);
      cell.forward_kinematics(q, positions, X_WL);
      double least = std::numeric_limits<double>::infinity();
      bool inside = false;  // Or so deep in a mesh that its depth counts.
      for (const int pair : all) {
        const BruteForce exact = brute_force(cell, X_WL, pair);
        least = std::min(least, exact.distance);
        inside = inside || exact.inside || (exact.solid && exact.distance <= 0);
        expect_brute_force(checker, q, exact, pair, rng.uniform(-0.1, 0.5), *scratch, tally);
      }
      const double found = checker.least_clearance(q, all, *scratch).distance;
      if (inside) {
        EXPECT_LE(found, std::min(least + 1e-6, 0.0));
      } else {
        EXPECT_NEAR(found, least, least > 0 ? 1e-8 : 1e-6);
      }
    }
  }
  return tally;
}

TEST(SsvChecker, MatchesBruteForceOnEveryPair) {
  const BruteTally tally = compare_with_brute_force({}, 6, 50);
  EXPECT_GT(tally.free, 10000);
  EXPECT_GT(tally.touching, 300);
}

TEST(SsvChecker, MatchesBruteForceOnMeshesAndClouds) {
  test::RandomCellOptions options;
  options.surface_pieces = 120;
  BruteTally tally = compare_with_brute_force(options, 8, 12);
  EXPECT_GT(tally.free, 1000);
  EXPECT_GT(tally.touching, 100);
  EXPECT_GT(tally.inside_only, 20);
  options.surface_pieces = 5000;
  options.joints = 3;
  tally = compare_with_brute_force(options, 2, 4);
  EXPECT_GT(tally.free, 50);
  EXPECT_GT(tally.touching, 5);
}

/// A ball of 0.1 m on a rail, a box of 1 m around x = 1 as a mesh or cloud in its way.
world::WorkcellSpec surface_slider(test::SurfacePtr surface) {
  world::WorkcellSpec spec = test::slider_cell_spec();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation().x() = 1;
  spec.obstacles[0].shapes_W.clear();
  spec.obstacles[0].surfaces_W = {{std::move(surface), X}};
  return spec;
}

TEST(SsvChecker, ClosedMeshesAreSolid) {
  for (const double radius : {0.0, 0.03}) {
    const SsvChecker checker(
        test::make_cell(surface_slider(test::box_mesh(Vector3d::Ones(), radius))));
    const auto scratch = checker.make_scratch();
    for (const double x : {-0.5, 0.2, 0.39, 0.41, 0.45, 0.52, 0.55, 0.7, 1.1, 1.45, 1.7}) {
      // The signed distance of a ball whose centre is left, right or inside of the walls.
      const double exact = std::max(0.5 - x, x - 1.5) - 0.1 - radius;
      const VectorXd q = VectorXd::Constant(1, x);
      const PairClearance found = checker.least_clearance(q, {0}, *scratch);
      EXPECT_NEAR(found.distance, exact, 1e-9) << x;
      EXPECT_EQ(checker.is_free(q, {0}, *scratch), exact > 0) << x;
      EXPECT_NEAR(checker.pair_distance(0, 1.0, *scratch), exact, 1e-9) << x;
      EXPECT_NEAR((found.p_WCa - found.p_WCb - found.distance * found.nhat_BA_W).norm(), 0, 1e-12);
      EXPECT_NEAR(found.nhat_BA_W.x(), x < 1 ? -1 : 1, 1e-9) << x;
    }
  }
}

TEST(SsvChecker, OpenMeshesAreNot) {
  std::vector<std::array<int, 3>> triangles = test::box_mesh(Vector3d::Ones())->triangles();
  const std::vector<Vector3d> vertices = test::box_mesh(Vector3d::Ones())->vertices();
  triangles.pop_back();
  const SsvChecker checker(test::make_cell(surface_slider(test::make_mesh(vertices, triangles))));
  const auto scratch = checker.make_scratch();
  EXPECT_NEAR(checker.least_clearance(VectorXd::Constant(1, 1.0), {0}, *scratch).distance, 0.4,
              1e-9);
  EXPECT_TRUE(checker.is_free(VectorXd::Constant(1, 1.0), {0}, *scratch));
}

TEST(SsvChecker, PaddingSweepsEveryPiece) {
  Rng rng(3);
  const auto cloud = test::random_cloud(rng, 500, 0.4, 0.01);
  world::WorkcellSpec spec = surface_slider(cloud);
  const SsvChecker plain(test::make_cell(spec));
  spec.body_padding = {{"ball", 0.02}, {"slider/carriage", 0.005}};
  const SsvChecker padded(test::make_cell(spec));
  const auto scratch = plain.make_scratch(), padded_scratch = padded.make_scratch();
  for (const double x : {-0.4, 0.1, 0.4, 1.0}) {
    const VectorXd q = VectorXd::Constant(1, x);
    EXPECT_NEAR(padded.least_clearance(q, {0}, *padded_scratch).distance,
                plain.least_clearance(q, {0}, *scratch).distance - 0.025, 1e-12);
  }
}

TEST(SsvChecker, ScratchesDoNotGrowWithWhatStandsStill) {
  Rng rng(4);
  const auto bytes = [&](int points) {
    const SsvChecker checker(
        test::make_cell(surface_slider(test::random_cloud(rng, points, 0.5, 0.01))));
    return SsvScratch(checker.model()).memory();
  };
  EXPECT_EQ(bytes(10), bytes(5000));
}

TEST(SsvChecker, RefusesConfigurationsThatAreNotFinite) {
  const SsvChecker checker(test::random_cell(2));
  const auto scratch = checker.make_scratch();
  const auto all = checker.cell().select(PairScope::all());
  const VectorXd q =
      VectorXd::Constant(checker.cell().dof(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(checker.is_free(q, all, *scratch), ContractViolation);
}

}  // namespace
}  // namespace tandem::collision
