#include "tandem/collision/batch_checker.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tandem/collision/batch_work.h"
#include "tandem/collision/certificate.h"
#include "tandem/collision/joint_map.h"
#include "tandem/collision/ssv_model.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

constexpr std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Half the longest edge that single precision is up to [rad or m]; longer ones are rare.
constexpr double kLongestHalf = 4.0;

}  // namespace

BatchChecker::Scratch::Scratch(const BatchChecker& checker)
    : model(*checker.model_), exact(checker.exact_), exact_scratch(checker.exact_.make_scratch()) {
  const std::size_t joints = model.joints.size();
  values.resize(joints);
  poses.resize(12 * joints);
  group_centers.resize(3 * joints);
  body_centers.resize(3 * model.bodies.size());
  body_time.resize(model.bodies.size());
  placed_shapes.resize(12 * index(model.moving_shapes));
  shape_time.resize(index(model.moving_shapes));
  value_middle.resize(joints);
  value_half.resize(joints);
  deviation.resize(joints);
  turn.resize(joints);
  travel.resize(joints * index(model.depth));
  box_deviation.resize(joints);
  box_turn.resize(joints);
  box_travel.resize(joints * index(model.depth));
  group_travel.resize(joints);
  group_travel_time.resize(joints);
  body_travel.resize(model.bodies.size());
  body_travel_time.resize(model.bodies.size());
  shape_travel.resize(model.shapes.size());
  shape_travel_time.resize(model.shapes.size());
  bend.resize(joints * index(model.depth));
  twists.resize(6 * joints);
  edge_a.resize(model.dof);
  edge_b.resize(model.dof);
  q_.resize(model.dof);
  one_pair_.resize(1);
}

bool BatchChecker::Scratch::touches_exactly(int pair, int lane) {
  if (Q) {
    q_ = Eigen::Map<const Eigen::VectorXd>(Q + std::min(lane, count - 1) * stride, model.dof);
  } else {
    const double t = 0.5 * (1.0 + s[lane]);
    q_ = (1 - t) * edge_a + t * edge_b;
  }
  one_pair_[0] = pair;
  return !exact.is_free(q_, one_pair_, *exact_scratch);
}

void BatchChecker::ScratchDeleter::operator()(Scratch* scratch) const { delete scratch; }

namespace {

/// Leaves of the exact model by shape of the batch model, -1 for surfaces. Both keep the shapes of
/// a body together, in its order; in the batch model its surfaces follow.
std::vector<int> leaves_of(const SsvModel& exact, const BatchModel& model) {
  std::vector<int> leaves(model.shapes.size(), -1);
  for (std::size_t b = 0; b < exact.bodies.size(); ++b) {
    const SsvBody& body = exact.bodies[b];
    const int first = model.bodies[b].first_shape - body.first_shape;
    for (int n = body.root; n < exact.node_end(body.root); ++n) {
      const SsvNode& node = exact.node(n);
      if (node.is_leaf() && node.is_shape()) leaves[index(first + node.piece)] = n;
    }
  }
  return leaves;
}

}  // namespace

BatchChecker::BatchChecker(const SsvChecker& exact, const JointMaps* known)
    : exact_(exact), model_(std::make_unique<BatchModel>(exact.cell())) {
  model_->joint_maps = std::make_shared<const JointMaps>(
      prove_joint_maps(*this, *model_, known ? *known : JointMaps()));
  leaves_ = leaves_of(exact.model(), *model_);
}

BatchChecker::~BatchChecker() = default;

BatchChecker::Pairs BatchChecker::compile(const world::PairSelection& selection,
                                          double within) const {
  expects(within >= kClearanceCap, "edges are proven to keep up to kClearanceCap");
  return std::make_shared<const BatchPairs>(compile_pairs(*model_, cell(), selection, within));
}

const std::shared_ptr<const JointMaps>& BatchChecker::joint_maps() const {
  return model_->joint_maps;
}

BatchChecker::ScratchPtr BatchChecker::make_scratch() const {
  return ScratchPtr(new Scratch(*this));
}

bool BatchChecker::are_free(const Eigen::Ref<const Eigen::MatrixXd>& Q, const BatchPairs& pairs,
                            Scratch& scratch) const {
  expects(pairs.model == model_.get() && &scratch.model == model_.get(),
          "pairs and scratch were made by this checker");
  expects(Q.rows() == model_->dof, "Q has a row per joint of the cell's arms");
  expects(Q.allFinite(), "Q is finite");
  const int lanes = batch_lanes();
  scratch.stride = Q.outerStride();
  for (Eigen::Index first = 0; first < Q.cols(); first += lanes) {
    scratch.Q = Q.data() + first * scratch.stride;
    scratch.count = static_cast<int>(std::min<Eigen::Index>(lanes, Q.cols() - first));
    if (!is_block_free(pairs, scratch)) return false;
  }
  return true;
}

bool BatchChecker::is_edge_free(const Eigen::Ref<const Eigen::VectorXd>& a,
                                const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                                Scratch& scratch, const StopCondition& stop) const {
  return examine(a, b, pairs, false, scratch, stop).is_free;
}

EdgeProof BatchChecker::prove_edge(const Eigen::Ref<const Eigen::VectorXd>& a,
                                   const Eigen::Ref<const Eigen::VectorXd>& b,
                                   const BatchPairs& pairs, Scratch& scratch,
                                   const StopCondition& stop) const {
  return examine(a, b, pairs, true, scratch, stop);
}

EdgeProof BatchChecker::examine(const Eigen::Ref<const Eigen::VectorXd>& a,
                                const Eigen::Ref<const Eigen::VectorXd>& b, const BatchPairs& pairs,
                                bool want_clearance, Scratch& work,
                                const StopCondition& stop) const {
  expects(pairs.model == model_.get() && &work.model == model_.get(),
          "pairs and scratch were made by this checker");
  expects(a.size() == model_->dof && b.size() == model_->dof,
          "both ends of an edge have one entry per joint of the cell's arms");
  expects(a.allFinite() && b.allFinite(), "the ends of an edge are finite");
  // One direction for both, or rounding could tell them apart.
  const bool forward = !std::lexicographical_compare(b.begin(), b.end(), a.begin(), a.end());
  work.edge_a = forward ? a : b;
  work.edge_b = forward ? b : a;
  work.Q = nullptr;
  bool is_long = false;
  for (const int j : pairs.joints) {
    const BatchJoint& joint = model_->joints[index(j)];
    const double at_a = joint.multiplier * work.edge_a[joint.column] + joint.offset;
    const double at_b = joint.multiplier * work.edge_b[joint.column] + joint.offset;
    work.value_middle[index(j)] = without_turns(joint, 0.5 * (at_a + at_b));
    work.value_half[index(j)] = 0.5 * (at_b - at_a);
    is_long = is_long || std::abs(work.value_half[index(j)]) > kLongestHalf;
  }
  if (is_long) {
    work.pending.resize(pairs.items.size());
    std::iota(work.pending.begin(), work.pending.end(), 0);
    work.parts = {{0.0}};
    work.half_length = 1;
    work.least_clearance = static_cast<float>(kClearanceCap);
    return prove_exactly(pairs, work, stop);
  }
  switch (examine_edge(pairs, want_clearance, work)) {
    case EdgeFinding::kNotFree:
      return {};
    case EdgeFinding::kFree:
      return {true, static_cast<double>(work.least_clearance)};
    case EdgeFinding::kOpen:
      break;
  }
  return prove_exactly(pairs, work, stop);
}

/// Asks the exact certificate about the parts of the edge and the pairs that are left.
EdgeProof BatchChecker::prove_exactly(const BatchPairs& pairs, Scratch& work,
                                      const StopCondition& stop) const {
  world::PairSelection selection;
  for (const int i : work.pending) {
    const BatchItem& item = pairs.items[index(i)];
    for (int k = item.first; k < item.first + item.count; ++k) {
      selection.push_back(pairs.body_pairs[index(k)].pair);
    }
  }
  const motion::StraightEdge edge(work.edge_a, work.edge_b);
  // Parts are ordered within a block only; neighbours are proven together.
  std::ranges::sort(work.parts, {}, &EdgePart::middle);
  // Parts are placed to single precision.
  const double half = work.half_length * (1 + 1e-3) + 1e-6;
  double least = kClearanceCap;
  for (std::size_t i = 0; i < work.parts.size();) {
    const double begin = work.parts[i].middle - half;
    double end = work.parts[i].middle + half;
    for (++i; i < work.parts.size() && work.parts[i].middle - half <= end; ++i) {
      end = work.parts[i].middle + half;
    }
    const Certificate certificate =
        certify_interval(exact_, edge, std::max(0.0, 0.5 * (1 + begin)),
                         std::min(1.0, 0.5 * (1 + end)), selection, *work.exact_scratch, {}, stop);
    if (!certificate.is_free()) return {};
    least = std::min(least, certificate.least_clearance);
  }
  return {true, std::min(least, static_cast<double>(work.least_clearance))};
}

double BatchChecker::margin() const { return static_cast<double>(model_->margin); }

}  // namespace tandem::collision
