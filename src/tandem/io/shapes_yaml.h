#pragma once
/// Shapes and poses in workcell and volumes files. Not part of the public interface.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "tandem/geometry/shape.h"
#include "tandem/geometry/surface.h"
#include "tandem/io/named_path.h"
#include "tandem/io/yaml_node.h"

namespace tandem::io {

/// Keys of a pose: position, and one of the two orientations. All are optional.
const std::vector<std::string>& pose_keys();
/// The pose in the pose keys of a map, which may have others.
Eigen::Isometry3d read_pose_in(const YamlNode& map);
/// A map of pose keys and nothing else.
Eigen::Isometry3d read_pose(const YamlNode& map);

/// What a body is made of, in one frame.
struct Pieces {
  std::vector<geometry::Shape> shapes;
  std::vector<geometry::PlacedSurface> surfaces;
  void move(const Eigen::Isometry3d& X);
};

/// Keys of a map that holds geometry: each kind of shape and surface, `shapes`, `pose`.
const std::vector<std::string>& geometry_keys();
/// The piece or `shapes` in the geometry keys of a map, moved by its `pose`; the map may have other
/// keys.
Pieces read_geometry(const YamlNode& map, const NamedPaths& paths);
/// A list of maps of one shape each; surfaces are refused.
std::vector<geometry::Shape> read_shapes(const YamlNode& list, const NamedPaths& paths);

}  // namespace tandem::io
