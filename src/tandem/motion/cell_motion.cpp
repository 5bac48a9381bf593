#include "tandem/motion/cell_motion.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tandem/core/contract.h"

namespace tandem::motion {

using Eigen::VectorXd;

Result<ArmMotion> ArmMotion::along(TimeMap map) const {
  constexpr double kTolerance = 1e-9;  // [s]
  const auto count = static_cast<int>(map.segments().size());
  for (int knot = 0; knot <= count; ++knot) {
    const double t = map.knots()[static_cast<std::size_t>(knot)];
    for (const int k : {knot - 1, knot}) {
      if (k < 0 || k == count) continue;
      const double local = map.on_segment(k, t)[0];
      if (local >= -kTolerance && local <= spline_->duration() + kTolerance) continue;
      return fail(ErrorCode::kInvalidInput, "time map: c is " + std::to_string(local) +
                                                " at knot " + std::to_string(knot) +
                                                ", outside the motion's time [0, " +
                                                std::to_string(spline_->duration()) + "]");
    }
  }
  ArmMotion motion = *this;
  motion.map_ = std::move(map);
  return motion;
}

void ArmMotion::position(double t, Eigen::Ref<VectorXd> q) const {
  spline_->position(map_ ? (*map_)(t) : t, q);
}

JointState ArmMotion::composed(const TimeMap::Derivatives& c, int segment) const {
  JointState s = spline_->on_segment(segment, c[0]);
  s.qddd = (c[1] * c[1] * c[1]) * s.qddd + (3 * c[1] * c[2]) * s.qdd + c[3] * s.qd;
  s.qdd = (c[1] * c[1]) * s.qdd + c[2] * s.qd;
  s.qd *= c[1];
  return s;
}

JointState ArmMotion::at(double t) const {
  if (!map_) return spline_->at(t);
  const TimeMap::Derivatives c = map_->at(t);
  if (c[0] < 0 || c[0] > spline_->duration()) return spline_->at(c[0]);
  int segment = spline_->segment_at(c[0]);
  // On the way back the segment before a knot is the next one.
  const bool goes_back = c[1] < 0 || (c[1] == 0 && c[2] < 0);
  const bool is_knot = c[0] == spline_->knots()[static_cast<std::size_t>(segment)];
  if (goes_back && is_knot && segment > 0) --segment;
  return composed(c, segment);
}

void ArmMotion::deviation(double t0, double t1, Eigen::Ref<VectorXd> D) const {
  if (!map_) return spline_->deviation(t0, t1, D);
  const auto [least, largest] = map_->range(t0, t1);
  spline_->deviation_from((*map_)(0.5 * (t0 + t1)), least, largest, D);
}

int ArmMotion::segment_between(int k, double t0, double t1) const {
  // At some times c may touch a knot: the one that is furthest from any tells.
  int segment = -1;
  double most = -1;
  for (const double u : {0.5, 0.2, 0.7}) {
    const double local = map_->on_segment(k, t0 + u * (t1 - t0))[0];
    const double beyond = std::max(-local, local - spline_->duration());
    const int at = spline_->segment_at(local);
    const auto knot = spline_->knots().begin() + at;
    const double margin = beyond > 0 ? beyond : std::min(local - knot[0], knot[1] - local);
    if (margin <= most) continue;
    most = margin;
    segment = beyond > 0 ? -1 : at;
  }
  return segment;
}

std::vector<ArmMotion::Piece> ArmMotion::pieces() const {
  std::vector<Piece> pieces;
  if (!map_) {
    for (int k = 0; k < static_cast<int>(spline_->segments().size()); ++k) {
      const auto knot = spline_->knots().begin() + k;
      pieces.push_back({knot[0], knot[1], -1, k});
    }
    return pieces;
  }
  std::vector<double> cuts;
  for (int k = 0; k < static_cast<int>(map_->segments().size()); ++k) {
    const auto knot = map_->knots().begin() + k;
    const auto [least, largest] = map_->range(knot[0], knot[1]);
    cuts.assign({knot[0], knot[1]});
    for (const double local : spline_->knots()) {
      if (local < least || local > largest) continue;
      for (const double t : map_->crossings(k, local)) cuts.push_back(t);
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      if (!(cuts[i] < cuts[i + 1])) continue;
      pieces.push_back({cuts[i], cuts[i + 1], k, segment_between(k, cuts[i], cuts[i + 1])});
    }
  }
  return pieces;
}

JointState ArmMotion::on_piece(const Piece& piece, double t) const {
  if (piece.map < 0) return spline_->on_segment(piece.spline, t);
  const TimeMap::Derivatives c = map_->on_segment(piece.map, t);
  if (piece.spline >= 0) return composed(c, piece.spline);
  const VectorXd zero = VectorXd::Zero(dof());
  JointState state{zero, zero, zero, zero};
  spline_->position(c[0], state.q);
  return state;
}

ArmMotion ArmMotion::stretched(double factor) const {
  ArmMotion slower = *this;
  if (map_) {
    slower.map_ = map_->stretched(factor);
  } else {
    slower.spline_ = std::make_shared<const PiecewiseCubic>(spline_->stretched(factor));
  }
  return slower;
}

Eigen::Vector3d ArmMotion::largest_jumps() const {
  if (!map_) return spline_->largest_jumps();
  Eigen::Vector3d jumps = Eigen::Vector3d::Zero();
  const std::vector<Piece> all = pieces();
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const JointState before = on_piece(all[i], all[i].t1), after = on_piece(all[i + 1], all[i].t1);
    jumps = jumps.cwiseMax(Eigen::Vector3d((after.q - before.q).cwiseAbs().maxCoeff(),
                                           (after.qd - before.qd).cwiseAbs().maxCoeff(),
                                           (after.qdd - before.qdd).cwiseAbs().maxCoeff()));
  }
  return jumps;
}

CellMotion::CellMotion(std::vector<ArmMotion> arms) : arms_(std::move(arms)) {
  expects(!arms_.empty(), "a cell motion needs an arm");
  for (const ArmMotion& arm : arms_) {
    dof_ += arm.dof();
    duration_ = std::max(duration_, arm.duration());
  }
}

void CellMotion::position(double t, Eigen::Ref<VectorXd> q) const {
  Eigen::Index first = 0;
  for (const ArmMotion& arm : arms_) {
    arm.position(t, q.segment(first, arm.dof()));
    first += arm.dof();
  }
}

JointState CellMotion::at(double t) const {
  JointState state;
  for (VectorXd* v : {&state.q, &state.qd, &state.qdd, &state.qddd}) v->resize(dof_);
  Eigen::Index first = 0;
  for (const ArmMotion& arm : arms_) {
    const JointState part = arm.at(t);
    const Eigen::Index n = arm.dof();
    state.q.segment(first, n) = part.q;
    state.qd.segment(first, n) = part.qd;
    state.qdd.segment(first, n) = part.qdd;
    state.qddd.segment(first, n) = part.qddd;
    first += n;
  }
  return state;
}

void CellMotion::deviation(double t0, double t1, Eigen::Ref<VectorXd> D) const {
  Eigen::Index first = 0;
  for (const ArmMotion& arm : arms_) {
    arm.deviation(t0, t1, D.segment(first, arm.dof()));
    first += arm.dof();
  }
}

}  // namespace tandem::motion
