#pragma once
/// Swept sphere volumes for the links of a robot.

#include <bitset>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tandem/core/result.h"
#include "tandem/core/stop.h"
#include "tandem/fitting/link_mesh.h"
#include "tandem/geometry/shape.h"
#include "tandem/robot/model.h"

namespace tandem::fitting {

struct FitOptions {
  int count = 4;           ///< Most volumes per link, >= 1; spheres of the URDF come on top.
  std::uint64_t seed = 1;  ///< Same seed, same volumes, unless the time ran out.
  int starts = 40;         ///< Searches begun per number of volumes, >= 1; more find tighter ones.
  double padding = 0;      ///< [m] >= 0 by which the volumes are swept further.
  /// Which may be used, at least one: spheres, capsules, rounded rectangles, rounded boxes, by the
  /// number of their extents. One with extents of next to nothing comes out simpler all the same.
  std::bitset<4> kinds = 0b1111;
};

/// Volumes, proven to contain a mesh, and what they add to it (before padding).
struct MeshFit {
  std::vector<geometry::Shape> volumes_L;
  int triangles = 0;
  bool is_closed = true;   ///< Else the mesh has no inside, and `solid` is a guess.
  double solid = 0;        ///< [m^3] of what the mesh encloses.
  double excess = 0;       ///< [m^3] of the union of the volumes outside of it.
  double area = 0;         ///< [m^2] of the mesh.
  double protrusion = 0;   ///< [m] largest distance of the volumes' surface from the mesh.
  double seconds = 0;      ///< Wall time.
  bool cut_short = false;  ///< The time ran out: a longer search may find less excess.
};

struct LinkFit : MeshFit {
  std::string link;
  std::string source;  ///< What was fitted: "link5.stl", "2 x box".
};

/// Fits at most `options.count` spheres, capsules, rounded rectangles and rounded boxes: as few and
/// as simple ones as pay. When `stop` times out, the best so far is returned, proven as every
/// result. `excess` and `solid` are known to about 1 % of the solid, `protrusion` from samples.
/// @return kInvalidInput if the mesh has no area, a corner that is not finite or beyond 1000 m, or
/// an index out of range; kCancelled on request.
/// Ref: docs/fitting.md.
Result<MeshFit> fit_mesh(const geometry::TriangleMesh& mesh_L, const FitOptions& options,
                         const StopCondition& stop = {});

/// The same for all collision geometry of a link. Spheres stay what they are.
/// @return the errors of `link_mesh` and `fit_mesh`, naming the link; kInvalidInput if it has no
/// collision geometry.
Result<LinkFit> fit_link(const robot::Link& link, const FitOptions& options,
                         const StopCondition& stop = {});

/// Fits `links` (all with collision geometry if empty), in the order of the model. Links with equal
/// geometry are fitted once. The time that is left is shared out evenly.
/// @param progress  called before each link with its name, its number from 1, and how many there
/// are.
/// @return kNotFound for an unknown link; else the errors of `fit_link`.
Result<std::vector<LinkFit>> fit_links(
    const robot::Model& model, const std::vector<std::string>& links, const FitOptions& options,
    const StopCondition& stop = {},
    const std::function<void(const std::string&, int, int)>& progress = {});

}  // namespace tandem::fitting
