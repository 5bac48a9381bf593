#pragma once
/// What the viewer shows of a cell and of a plan, as JSON. The schema is docs/viewer.md.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tandem/collision/compiled_cell.h"
#include "tandem/motion/motion.h"

namespace tandem::server {

struct Scene {
  std::string json;
  /// Mesh files that `json` names by index; nothing else of the disk is ever served.
  std::vector<std::filesystem::path> meshes;
};

/// Links with their joints, bodies with their shapes and surfaces, visual geometry, arms, limits,
/// queries of all lists, and a configuration to show while there is no other.
Scene describe_scene(const world::Workcell& cell);

/// The bodies, as in the scene of `shown`, of all objects that are elsewhere in `cell`, which is
/// the same in another scene.
std::string describe_moved(const world::Workcell& shown, const world::Workcell& cell);

inline constexpr double kClearanceRate = 50;  ///< [Hz] that the page is given.

/// Least clearance over a motion at `rate` [Hz] and at its end: time, distance, pair, witness
/// points. By the swept sphere volumes, padding included. Long motions are sampled less often: at
/// 2001 times at most. `[]` without pairs to check.
std::string describe_clearance(const collision::CompiledCell& compiled,
                               const motion::Motion& motion, double rate);

}  // namespace tandem::server
