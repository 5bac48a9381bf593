#pragma once
/// The batch checker's work space. Private to this folder.

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "tandem/collision/batch_model.h"

namespace tandem::collision {

/// Most configurations in one vector. Rows are this long for every instruction set.
inline constexpr int kMostLanes = 8;

struct alignas(sizeof(float) * kMostLanes) LaneRow {
  float lane[kMostLanes] = {};
};

/// Joint values as single precision takes them: angles without whole turns, which cost digits.
inline double without_turns(const BatchJoint& joint, double value) {
  constexpr double kTurn = 2 * std::numbers::pi;
  if (joint.prismatic || std::abs(value) <= kTurn) return value;
  return value - kTurn * std::round(value / kTurn);
}

/// Part of an edge, seen from its middle configuration at s = 0; the ends are s = -1 and s = 1.
struct EdgePart {
  double middle;
};

/// Two shapes that are near in some lanes.
struct NearLanes {
  int pair;         ///< Of the cell.
  int a, b;         ///< Shapes.
  unsigned lanes;   ///< One bit each.
  LaneRow squared;  ///< [m^2] lower bound of the squared distance of their cores, with its sign.
  float outer;      ///< [m] of both, to be taken off.
};

/// What is known of a block of boxes. Bits and lanes are by column.
struct BoxFindings {
  unsigned touching = 0;  ///< At the centre.
  unsigned open = 0;      ///< Not proven,
  unsigned hopeless = 0;  ///< nor by smaller boxes.
  // If a clearance is wanted:
  LaneRow least;    ///< Kept by what is proven [m], not above the cap.
  LaneRow nearest;  ///< At the centre, of the pairs of shapes that were looked at [m].
  LaneRow excess;   ///< How many times too far things move where it is not proven.
  // If Scratch::names_pairs:
  unsigned blocked = 0;  ///< Two shapes touch in all of it.
  int pair[kMostLanes];  ///< Of the cell: that blocks, else touches, else is furthest from a proof.
  int mover[kMostLanes];  ///< The body of that pair that moves further.
};

/// One block of configurations as placed, and what is left to prove of an edge.
class BatchChecker::Scratch {
 public:
  explicit Scratch(const BatchChecker& checker);

  /// Whether a pair of bodies touches in a lane, by the exact checker.
  bool touches_exactly(int pair, int lane);

  const BatchModel& model;
  const SsvChecker& exact;
  const std::unique_ptr<CollisionChecker::Scratch> exact_scratch;

  // The placement. What is placed when first asked for has the time it was placed at.
  std::uint32_t now = 0;
  std::vector<LaneRow> values;         ///< Of joints.
  std::vector<LaneRow> poses;          ///< Of joints: x, y, z axes and origin in C, 12 rows each.
  std::vector<LaneRow> group_centers;  ///< 3 rows each, as for bodies.
  std::vector<LaneRow> body_centers;
  /// Of those that move, 12 rows each: centre, then the half vector of a segment or the axes of the
  /// box.
  std::vector<LaneRow> placed_shapes;
  std::vector<std::uint32_t> body_time, shape_time;

  // Where the lanes are: columns of Q, or on an edge at s.
  const double* Q = nullptr;
  Eigen::Index stride = 0;
  int count = 0;  ///< Columns; lanes past them hold the last one.
  Eigen::VectorXd edge_a, edge_b;
  double s[kMostLanes] = {};

  // The edge: values are middle + s * half.
  std::vector<double> value_middle, value_half;
  std::vector<float> deviation;  ///< Of a joint's value per unit of s, upwards.
  std::vector<float> turn;       ///< The same summed over the turning joints down to this one.
  std::vector<float> travel;     ///< Of a group's centre per unit of s by the joints below a depth.
  std::vector<float> bend;       ///< The same of its velocity, with all joints above turning.
  std::vector<LaneRow> twists;   ///< Of joints, 6 rows each: angular and linear, see Travels.
  std::vector<int> pending, next_pending;   ///< Items not proven yet, and
  std::vector<EdgePart> parts, next_parts;  ///< where; all of one length:
  double half_length = 0;                   ///< [s]
  float least_clearance = 0;                ///< [m]

  // Boxes around the configurations: half edges are columns of D. The same for them, by lane:
  const double* D = nullptr;
  Eigen::Index D_stride = 0;
  std::vector<LaneRow> box_deviation, box_turn, box_travel;
  /// By all joints above, of the centres of groups and of bodies, and of shapes: kept as placed.
  std::vector<LaneRow> group_travel, body_travel, shape_travel;
  std::vector<std::uint32_t> group_travel_time, body_travel_time, shape_travel_time;
  float keep = 0;            ///< What has to be kept for a proof [m].
  bool names_pairs = false;  ///< Whether to look for what touches everywhere, and to tell pairs.
  BoxFindings findings;

  std::vector<NearLanes> near;  ///< Found last by find_near.

  int last_hit = -1;  ///< Item: neighbouring questions tend to collide in the same one.

 private:
  Eigen::VectorXd q_;
  world::PairSelection one_pair_;
};

/// What the kernels know of an edge.
enum class EdgeFinding {
  kFree,
  kNotFree,
  kOpen,  ///< `pending` at `parts` is not proven: a question for the exact certificate.
};

// Entry points of the kernels, for the instruction set found at run time.

/// Configurations per vector.
int batch_lanes();
/// Whether Scratch::count <= batch_lanes() columns from Scratch::Q are free.
bool is_block_free(const BatchPairs& pairs, BatchChecker::Scratch& work);
/// Fills Scratch::near with the shapes that are nearer than `within` [m] in any of the columns.
void find_near(const BatchPairs& pairs, float within, BatchChecker::Scratch& work);
/// Proves the edge between edge_a and edge_b as far as single precision can.
EdgeFinding examine_edge(const BatchPairs& pairs, bool want_clearance, BatchChecker::Scratch& work);
/// Fills Scratch::findings about the boxes of half edges Scratch::D around `count` columns from
/// Scratch::Q, and adds the items that are left open in any of them to Scratch::next_pending.
/// @param items  those to ask about; all, if none are given.
void examine_boxes(const BatchPairs& pairs, std::span<const int> items, bool want_clearance,
                   BatchChecker::Scratch& work);

}  // namespace tandem::collision
