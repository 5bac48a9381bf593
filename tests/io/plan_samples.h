#pragma once
/// Plans of the small cell with random numbers in them, and a folder to write them to.

#include <unistd.h>

#include <fstream>
#include <iterator>

#include "motion/random_motions.h"
#include "small_cell.h"
#include "tandem/core/rng.h"
#include "tandem/io/plan_file.h"
#include "temporary_folder.h"

namespace tandem::test {

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

/// Numbers of many magnitudes: what a short notation would round.
inline double rough_number(Rng& rng) {
  const double value = rng.uniform(-1, 1) * std::pow(10.0, rng.uniform(-12, 3));
  return rng.index(8) == 0 ? 0.0 : value;
}

inline Eigen::VectorXd rough_vector(Rng& rng, Eigen::Index size) {
  return Eigen::VectorXd::NullaryExpr(size, [&] { return rough_number(rng); });
}

inline motion::PiecewiseCubic rough_spline(Rng& rng, Eigen::Index dof) {
  std::vector<double> knots = {0.0};
  std::vector<motion::PiecewiseCubic::Coefficients> segments;
  const std::size_t count = 1 + rng.index(6);
  for (std::size_t k = 0; k < count; ++k) {
    knots.push_back(knots.back() + rng.uniform(1e-3, 1.0));
    motion::PiecewiseCubic::Coefficients c(dof, 4);
    for (Eigen::Index i = 0; i < c.size(); ++i) c(i) = rough_number(rng);
    segments.push_back(c);
  }
  return *motion::PiecewiseCubic::make(std::move(knots), std::move(segments));
}

inline pipeline::PlanReport rough_report(Rng& rng, Eigen::Index dof) {
  pipeline::PlanReport report;
  report.times = {.path_planning = rng.uniform(),
                  .simplification = rng.uniform(),
                  .trajectory = rng.uniform(),
                  .certificate = rng.uniform(),
                  .distance = rng.uniform(),
                  .total = rng.uniform()};
  report.counts = {.state_checks = 12,
                   .edge_checks = 345,
                   .certificate_evaluations = 6789,
                   .shortenings = 3,
                   .timings = 2,
                   .repairs = 1};
  report.arms = {{1.5, 1.25, 2.5, 2.25, 3.125}, {0.1, 0.2, 0.3, 0.4, 0.7}};
  report.rungs = {{"repair", 1}, {"rest_to_rest", 2}};
  report.phases = {{"planned", {rough_vector(rng, dof), rough_vector(rng, dof)}},
                   {"simplified", {rough_vector(rng, dof)}},
                   {"empty", {}}};
  report.least_clearance = rng.uniform(0, 0.1);
  return report;
}

inline Eigen::Isometry3d rough_pose(Rng& rng) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = rough_vector(rng, 3);
  X.linear() =
      Eigen::Quaterniond(Eigen::Vector4d(rough_vector(rng, 4)) + Eigen::Vector4d(0, 0, 0, 2000))
          .normalized()
          .toRotationMatrix();
  return X;
}

/// The left arm carries the table, the wall stands elsewhere.
inline std::shared_ptr<const world::Workcell> rough_scene(const world::Workcell& cell, Rng& rng) {
  world::SceneState scene;
  scene.objects["table"] = {"left/link3", rough_pose(rng), {"right/link4", "wall"}};
  scene.objects["wall"] = {world::kWorldLink, rough_pose(rng)};
  scene.allowed = {{"table", "right/link1", "it may"}};
  return *cell.in_scene(scene);
}

/// Nothing in it fits together but the sizes: files do not care.
inline pipeline::Plan rough_plan(const world::Workcell& cell, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<motion::ArmMotion> motions;
  for (const world::Arm& arm : cell.arms()) {
    motion::ArmMotion motion = rough_spline(rng, arm.dof());
    const bool has_map = seed % 4 == 1 || (seed % 4 == 2 && motions.empty());
    if (has_map) motion = *motion.along(motion::random_map(rng, 3, motion.duration()));
    motions.push_back(std::move(motion));
  }
  return {.query = "cross",
          .strategy = pipeline::Strategy::kCentralized,
          .preset = seed % 2 ? pipeline::Preset::kPaper : pipeline::Preset::kDefault,
          .seed = rng.split(),
          .plpp = seed % 3 == 0,
          .ends = {"cross", rough_vector(rng, cell.dof()), rough_vector(rng, cell.dof()),
                   rough_scene(cell, rng)},
          .trajectory = motion::CellMotion(std::move(motions)),
          .report = rough_report(rng, cell.dof())};
}

}  // namespace tandem::test
