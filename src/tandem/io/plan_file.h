#pragma once
/// Plan files: JSON and CSV. The schema is docs/schemas.md.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tandem/pipeline/plan.h"

namespace tandem::io {

/// What a plan file holds once read back.
struct PlanFile {
  std::string version;             ///< Of the tandem that wrote it.
  std::filesystem::path workcell;  ///< Resolved against the plan file's folder; empty if unknown.
  std::string query, strategy, preset;
  bool plpp = false;
  std::uint64_t seed = 0;
  std::vector<std::string> arms;
  std::vector<std::vector<std::string>> joints;  ///< By arm, cell names.
  Eigen::VectorXd start, goal;
  motion::CellMotion trajectory;
  pipeline::PlanReport report;
  world::SceneState scene;  ///< Of the motion: for Workcell::in_scene.
};

/// The cell as it stands during the plan's motion.   @return the errors of Workcell::in_scene.
Result<std::shared_ptr<const world::Workcell>> in_scene_of(
    const PlanFile& plan, const std::shared_ptr<const world::Workcell>& cell);

/// Writes atomically (a temporary file, then a rename). `workcell` is stored relative to the plan
/// file.   @return kIo; kInvalidInput if `file` exists and `overwrite` is false.
Result<void> save_plan(const std::filesystem::path& file, const pipeline::Plan& plan,
                       const world::Workcell& cell, bool overwrite = false);
/// The text that save_plan writes to `file`.   @return kInvalidInput for names that are not UTF-8.
Result<std::string> plan_json(const pipeline::Plan& plan, const world::Workcell& cell,
                              const std::filesystem::path& file);
/// Reads it back: numbers of the trajectory bit by bit, times to rounding. Unknown, missing and
/// repeated keys are errors.
/// @return kNotFound, kIo, or kInvalidInput naming file, key, value and what was expected.
Result<PlanFile> load_plan(const std::filesystem::path& file);

/// Rows of t, then q, qd, qdd per joint, at `rate` [Hz] and once more at the end; header names
/// them. Same errors as save_plan, and kInvalidInput for a rate outside (0, 1e6].
Result<void> save_csv(const std::filesystem::path& file, const motion::Motion& motion,
                      const std::vector<std::string>& joint_names, double rate,
                      bool overwrite = false);

/// Writes `text` to `file` atomically; kInvalidInput if it exists and `overwrite` is false, or if
/// it is no regular file.
Result<void> write_file(const std::filesystem::path& file, const std::string& text, bool overwrite);
/// The refusals of write_file without writing: ask before long work.
Result<void> check_writable(const std::filesystem::path& file, bool overwrite);

}  // namespace tandem::io
