#pragma once
/// The search for volumes that contain points with little excess. Private to this folder.

#include <bitset>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/core/stop.h"
#include "tandem/fitting/core.h"
#include "tandem/fitting/solid.h"

namespace tandem::fitting {

/// What is searched for: volumes that contain `surface` and little of `outside`.
struct Problem {
  Points surface;             ///< Of the mesh.
  Points outside;             ///< Samples around the solid, none inside.
  std::vector<float> weight;  ///< [m^3] that each of them stands for.
  Bounds sampled;             ///< Where they lie.
  double area = 0;            ///< [m^2] of the mesh.
  double width = 0;           ///< [m] over which a sample goes from outside a volume to inside.

  /// @param density  of points and samples, 1 for a few thousand.
  Problem(const geometry::TriangleMesh& mesh, const Solid& solid, double density);
};

/// Volumes and what they cost [m]: their excess volume per area of the mesh, and what checking them
/// costs in time, as a thickness that one would rather bear.
struct Candidate {
  std::vector<Core> cores;
  double cost = 0;
};

/// Price of a volume with `dims` [m]. Every other volume of the cell is checked against it, so it
/// must bring the surface closer by half a millimetre on average. By time of a check, to capsules.
inline constexpr double kPrices[] = {0.3e-3, 0.5e-3, 1.5e-3, 4.0e-3};

struct SearchSize {
  int count;                      ///< Most volumes.
  int starts;                     ///< Per number of volumes.
  std::bitset<4> kinds = 0b1111;  ///< That may be used, by `Core::dims`.
};

/// Searches for volumes, which contain all of `mesh` in the end. Deterministic
/// unless `stop` cuts it short; even then it returns at least one volume around everything.
Candidate search(const geometry::TriangleMesh& mesh, const Solid& solid, SearchSize size, Rng& rng,
                 const StopCondition& stop);

}  // namespace tandem::fitting
