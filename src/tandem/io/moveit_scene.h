#pragma once
/// MoveIt's planning scenes as text files (".scene"): obstacles in and out. See docs/workcell.md.

#include <filesystem>
#include <string>
#include <vector>

#include "tandem/world/workcell.h"

namespace tandem::io {

struct MoveitScene {
  std::string name;
  std::vector<world::ObstacleSpec> obstacles;  ///< Objects with shapes, in the file's frame.
};

/// Reads the old format (shapes posed in the world) and the new one (objects with a pose and
/// subframes). Spheres, boxes and cylinders are exact, meshes are surfaces, a cone is a
/// pyramid around it. Colours and subframes have no effect.
/// @return kNotFound, kIo, or kInvalidInput with file, line, column and value; kUnsupported for
/// planes and shapes that MoveIt does not write.
Result<MoveitScene> load_moveit_scene(const std::filesystem::path& file);
/// Same from text; `origin` stands for the file in messages.
Result<MoveitScene> parse_moveit_scene(const std::string& text, const std::string& origin);

struct MoveitSceneText {
  std::string text;
  std::vector<std::string> notes;  ///< What MoveIt's shapes cannot say exactly, by obstacle.
};

/// The obstacles of a cell, unpadded, in the new format: a shape that MoveIt does not have is
/// composed of several that it has. Numbers read back bit by bit.
/// @return kInvalidInput for names that do not fit into a line.
Result<MoveitSceneText> moveit_scene_text(const std::string& name,
                                          const std::vector<world::ObstacleSpec>& obstacles);

}  // namespace tandem::io
