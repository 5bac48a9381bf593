#pragma once
/// What robot links are made of, read from their URDF geometry. Not part of the public interface.

#include <map>

#include "tandem/world/workcell.h"

namespace tandem::world {

/// In the link's frame.
struct LinkGeometry {
  std::vector<geometry::Shape> shapes;
  std::vector<geometry::PlacedSurface> surfaces;
  bool empty() const { return shapes.empty() && surfaces.empty(); }
};

/// Reads every mesh file once, however many links and robots use it.
class LinkGeometryReader {
 public:
  /// @return kNotFound, kIo or kInvalidInput naming the mesh, where it was looked for and what to
  /// do.
  Result<LinkGeometry> of_urdf(const robot::Link& link, RobotSpec::Meshes meshes);

 private:
  struct Mesh {
    std::shared_ptr<const geometry::Surface> surface;
    std::vector<geometry::Shape> hull;  // One; empty if nobody asked for it.
  };
  Result<void> add_mesh(const robot::MeshGeometry& mesh, const Eigen::Isometry3d& X_LG,
                        RobotSpec::Meshes meshes, LinkGeometry& out);

  std::map<std::string, Mesh> meshes_;  // By file, scale and kind.
};

}  // namespace tandem::world
