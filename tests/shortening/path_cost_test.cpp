#include "tandem/shortening/path_cost.h"

#include <gtest/gtest.h>

#include "small_cell.h"
#include "tandem/core/rng.h"
#include "tandem/math/so3.h"

namespace tandem::shortening {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using Vector3l = Eigen::Matrix<long double, 3, 1>;
using Quaternionl = Eigen::Quaternion<long double>;

/// exp and log in long double, term by term as in the paper (eq:Log_impl) with a series near zero.
Quaternionl exp_long(const Vector3l& p) {
  const long double angle = p.norm();
  const long double factor =
      angle < 1e-5L ? 0.5L - angle * angle / 48 : std::sin(angle / 2) / angle;
  Quaternionl u;
  u.w() = std::cos(angle / 2);
  u.vec() = factor * p;
  return u;
}
Vector3l log_long(Quaternionl u) {
  if (u.w() < 0) u.coeffs() = -u.coeffs();
  const long double v = u.vec().norm();
  if (v < 1e-5L) return u.vec() * (2 / u.w()) * (1 - v * v / (3 * u.w() * u.w()));
  return u.vec() * (2 * std::atan2(v, u.w()) / v);
}

/// A cell of two arms whose tools the test places as it likes.
struct Tools {
  std::shared_ptr<const world::Workcell> cell = test::small_cell();
  Waypoint from, to;

  explicit Tools(Rng& rng) {
    for (Waypoint* waypoint : {&from, &to}) {
      waypoint->q = VectorXd::Zero(cell->dof());
      waypoint->tools.resize(2);
      for (Waypoint::Tool& tool : waypoint->tools) {
        tool.p_WE.setZero();
        tool.Q_WE.setIdentity();
        tool.J_WE.setZero(6, 4);
      }
      for (double& value : waypoint->tools[0].J_WE.reshaped()) value = rng.uniform(-1, 1);
    }
  }

  /// Rotational cost when joint j of the first arm moves by h at one end: turned by J h in W.
  long double cost(bool at_to, int j, long double h) const {
    const auto turned = [&](const Waypoint::Tool& tool, bool moves) {
      const Vector3l rate = tool.J_WE.bottomRows<3>().col(j).cast<long double>();
      const Quaternionl Q = tool.Q_WE.cast<long double>();
      return moves ? exp_long(h * rate) * Q : Q;
    };
    const Quaternionl a = turned(from.tools[0], !at_to), b = turned(to.tools[0], at_to);
    return log_long(a.conjugate() * b).squaredNorm() / 2;
  }
};

TEST(PathCost, RotationalGradientIsExactFromEqualToOpposite) {
  Rng rng(1);
  const Weights rotation_only{.translation = 0, .rotation = 1, .joints = 0, .arms = {}};
  for (const double angle :
       {1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.1, 1.0, 2.0, 3.0, 3.1, M_PI - 1e-3, M_PI - 1e-5}) {
    for (int n = 0; n < 50; ++n) {
      Tools tools(rng);
      const Eigen::Vector3d axis =
          Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized();
      // Where angles are tiny, both ends stand at the identity so that the angle is what it says.
      const Eigen::Quaterniond Q =
          angle < 1e-6 ? Eigen::Quaterniond::Identity() : math::exp_map(rng.uniform(0, 3) * axis);
      tools.from.tools[0].Q_WE = Q;
      tools.to.tools[0].Q_WE = Q * math::exp_map(angle * axis);
      if (n % 2 == 1) tools.to.tools[0].Q_WE.coeffs() *= -1;  // The same rotation.

      PathCost cost(*tools.cell, rotation_only);
      VectorXd gradient = VectorXd::Zero(2 * tools.cell->dof());
      cost.add_derivatives(tools.from, tools.to, 1.0, 0, gradient, nullptr);
      // The step stays below the distance to pi, where the shorter arc changes sides.
      const long double h =
          1e-4L * std::min({1.0L, static_cast<long double>(angle), M_PIl - angle});
      for (int end : {0, 1}) {
        for (int j = 0; j < 4; ++j) {
          const long double difference =
              (tools.cost(end == 1, j, h) - tools.cost(end == 1, j, -h)) / (2 * h);
          EXPECT_NEAR(gradient[end * tools.cell->dof() + j], static_cast<double>(difference),
                      1e-6 * angle)
              << "angle " << angle << ", end " << end << ", joint " << j;
        }
      }
    }
  }
}

TEST(PathCost, EqualWaypointsCostNothingAndPullNowhere) {
  Rng rng(2);
  const auto cell = test::small_cell();
  PathCost cost(*cell, {});
  for (int n = 0; n < 100; ++n) {
    VectorXd q(cell->dof());
    for (double& value : q) value = rng.uniform(-2, 2);
    Waypoint a, b;
    cost.place(q, true, a);
    cost.place(q, true, b);
    b.tools[0].Q_WE.coeffs() *= -1;
    VectorXd gradient = VectorXd::Zero(2 * cell->dof());
    cost.add_derivatives(a, b, 1.0, 0, gradient, nullptr);
    EXPECT_LT(cost.edge(a, b), 1e-28);
    EXPECT_LT(gradient.norm(), 1e-14);
  }
}

/// A path of random waypoints, and its cost with all inner ones stacked.
struct RandomPath {
  std::shared_ptr<const world::Workcell> cell = test::small_cell();
  motion::JointPath path;

  RandomPath(int count, double spread, Rng& rng) {
    VectorXd q(cell->dof());
    for (double& value : q) value = rng.uniform(-1.5, 1.5);
    for (int i = 0; i < count; ++i) {
      for (double& value : q) value += rng.uniform(-spread, spread);
      path.push_back(q);
    }
  }

  double value(PathCost& cost, const VectorXd& step) const {
    std::vector<Waypoint> placed(path.size());
    double sum = 0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const bool inner = i > 0 && i + 1 < path.size();
      const Eigen::Index first = static_cast<Eigen::Index>(i - 1) * cell->dof();
      const VectorXd q = inner ? VectorXd(path[i] + step.segment(first, cell->dof())) : path[i];
      cost.place(q, false, placed[i]);
      if (i > 0) sum += cost.edge(placed[i - 1], placed[i]);
    }
    return sum;
  }

  void differentiate(PathCost& cost, VectorXd& gradient, math::BlockTridiagonal& H) const {
    std::vector<Waypoint> placed(path.size());
    gradient.setZero(H.block_size() * H.block_count());
    H.set_zero();
    for (std::size_t i = 0; i < path.size(); ++i) {
      cost.place(path[i], true, placed[i]);
      if (i == 0) continue;
      cost.add_derivatives(placed[i - 1], placed[i], 1.0, static_cast<int>(i) - 2, gradient, &H);
    }
  }
};

TEST(PathCost, GradientAgreesWithDifferences) {
  Rng rng(3);
  for (int n = 0; n < 40; ++n) {
    const RandomPath random(6, rng.uniform(0.01, 0.8), rng);
    const Weights weights{.translation = rng.uniform(0, 8),
                          .rotation = rng.uniform(0, 3),
                          .joints = rng.uniform(0, 1),
                          .arms = {rng.uniform(0, 2), rng.uniform(0, 2)}};
    PathCost cost(*random.cell, weights);
    VectorXd gradient;
    math::BlockTridiagonal H(random.cell->dof(), 4);
    random.differentiate(cost, gradient, H);
    VectorXd step = VectorXd::Zero(gradient.size());
    for (Eigen::Index k = 0; k < gradient.size(); ++k) {
      constexpr double h = 1e-5;
      step[k] = h;
      const double up = random.value(cost, step);
      step[k] = -h;
      const double down = random.value(cost, step);
      step[k] = 0;
      EXPECT_NEAR(gradient[k], (up - down) / (2 * h), 1e-6 * gradient.norm()) << "entry " << k;
    }
  }
}

TEST(PathCost, HessianIsTheSecondDerivativeWhereWaypointsAreEqual) {
  Rng rng(4);
  for (int n = 0; n < 20; ++n) {
    const RandomPath random(5, 0.0, rng);
    const Weights weights{.translation = 5, .rotation = 1, .joints = 0.1, .arms = {1, 0.3}};
    PathCost cost(*random.cell, weights);
    VectorXd gradient;
    math::BlockTridiagonal H(random.cell->dof(), 3);
    random.differentiate(cost, gradient, H);
    VectorXd step(gradient.size()), Hx(gradient.size());
    for (double& value : step) value = rng.uniform(-1, 1);
    H.multiply(step, Hx);
    constexpr double h = 1e-4;
    EXPECT_NEAR(random.value(cost, h * step) / (h * h), 0.5 * step.dot(Hx), 1e-3 * step.dot(Hx));
  }
}

TEST(PathCost, LengthGradientAgreesWithDifferences) {
  Rng rng(5);
  for (int n = 0; n < 40; ++n) {
    const RandomPath random(2, 0.5, rng);
    const int dof = random.cell->dof();
    PathCost cost(*random.cell, {.translation = 3, .rotation = 2, .joints = 1, .arms = {}});
    Waypoint a, b;
    cost.place(random.path[0], true, a);
    cost.place(random.path[1], true, b);
    VectorXd at_from, at_to;
    cost.length_gradient(a, b, at_from, at_to);
    const double scale = std::max(at_from.norm(), at_to.norm());
    for (int j = 0; j < dof; ++j) {
      constexpr double h = 1e-5;
      const auto moved = [&](int end, double by) {
        motion::JointPath path = random.path;
        path[static_cast<std::size_t>(end)][j] += by;
        Waypoint from, to;
        cost.place(path[0], false, from);
        cost.place(path[1], false, to);
        return cost.squared_length(from, to);
      };
      EXPECT_NEAR(at_from[j], (moved(0, h) - moved(0, -h)) / (2 * h), 1e-6 * scale);
      EXPECT_NEAR(at_to[j], (moved(1, h) - moved(1, -h)) / (2 * h), 1e-6 * scale);
    }
  }
}

TEST(PathCost, IsThePapersObjective) {
  Rng rng(6);
  const RandomPath random(7, 0.4, rng);
  PathCost cost(*random.cell, {.translation = 5, .rotation = 1, .joints = 0, .arms = {}});
  VectorXd positions;
  robot::LinkPoses X_WL;
  double f = 0;
  for (int arm : {0, 1}) {
    std::vector<Eigen::Isometry3d> X_WE;
    for (const VectorXd& q : random.path) {
      random.cell->forward_kinematics(q, positions, X_WL);
      X_WE.push_back(random.cell->tool_pose(arm, X_WL));
    }
    f += motion::cartesian_length(X_WE).f;
  }
  EXPECT_NEAR(random.value(cost, VectorXd::Zero(5 * random.cell->dof())), f, 1e-12 * f);
}

}  // namespace
}  // namespace tandem::shortening
