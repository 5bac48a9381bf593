#include "tandem/fitting/core.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tandem/fitting/containment.h"

namespace tandem::fitting {

using Eigen::Vector3d;
using geometry::Shape;

double Core::distance(const Vector3d& p) const {
  Vector3d s = axes.transpose() * (p - center);
  for (int i = 0; i < 3; ++i) s[i] = std::max(std::abs(s[i]) - half[i], 0.0);
  return s.norm();
}

void Core::distances(const Points& points, std::vector<float>& out) const {
  out.resize(points.size());
  const Eigen::Matrix3f R = axes.transpose().cast<float>();
  const Eigen::Vector3f t = (axes.transpose() * center).cast<float>(), h = half.cast<float>();
  const float* x = points.x.data();
  const float* y = points.y.data();
  const float* z = points.z.data();
  float* d = out.data();
  const float r00 = R(0, 0), r01 = R(0, 1), r02 = R(0, 2), r10 = R(1, 0), r11 = R(1, 1),
              r12 = R(1, 2), r20 = R(2, 0), r21 = R(2, 1), r22 = R(2, 2);
  const float t0 = t[0], t1 = t[1], t2 = t[2], h0 = h[0], h1 = h[1], h2 = h[2];
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const float a = std::abs(r00 * x[i] + r01 * y[i] + r02 * z[i] - t0) - h0;
    const float b = std::abs(r10 * x[i] + r11 * y[i] + r12 * z[i] - t1) - h1;
    const float c = std::abs(r20 * x[i] + r21 * y[i] + r22 * z[i] - t2) - h2;
    const float pa = 0.5f * (a + std::abs(a)), pb = 0.5f * (b + std::abs(b)),
                pc = 0.5f * (c + std::abs(c));
    const float ab = 0.5f * (a + b + std::abs(a - b)), abc = 0.5f * (ab + c + std::abs(ab - c));
    d[i] = std::sqrt(pa * pa + pb * pb + pc * pc) + 0.5f * (abc - std::abs(abc));
  }
}

Core Core::simplified(double least) const {
  Core core = *this;
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return half[a] > half[b]; });
  core.dims = 0;
  for (int k = 0; k < 3; ++k) {
    const int from = order[static_cast<std::size_t>(k)];
    core.axes.col(k) = axes.col(from);
    core.half[k] = half[from] >= least ? half[from] : 0;
    core.dims += core.half[k] > 0;
  }
  if (core.axes.determinant() < 0) core.axes.col(2) *= -1;
  return core;
}

Core Core::rounded() const {
  constexpr double kGrid = 1e-5;
  const auto snapped = [&](const Vector3d& v) {
    return Vector3d((v.array() / kGrid).round() * kGrid);
  };
  Core core = *this;
  if (dims == 1) {
    const Vector3d from = snapped(center - half[0] * axes.col(0));
    const Vector3d to = snapped(center + half[0] * axes.col(0));
    core.center = (from + to) / 2;
    core.half[0] = (to - from).norm() / 2;
    core.axes.col(0) = (to - from).normalized();
    core.axes.col(1) = core.axes.col(0).unitOrthogonal();
    core.axes.col(2) = core.axes.col(0).cross(core.axes.col(1));
    return core;
  }
  core.center = snapped(center);
  core.half = snapped(2 * half) / 2;
  return core;
}

Shape Core::shape() const {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::Quaterniond(axes).normalized().toRotationMatrix();
  X.translation() = center;
  switch (dims) {
    case 0:
      return *Shape::sphere(center, radius);
    case 1:
      return *Shape::capsule(center - half[0] * axes.col(0), center + half[0] * axes.col(0),
                             radius);
    case 2:
      return *Shape::rounded_rectangle(X, 2 * half.head<2>(), radius);
    default:
      return *Shape::box(X, 2 * half, radius);
  }
}

Core core_about(const std::vector<Vector3d>& points, int dims, bool principal) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - mean) * (p - mean).transpose();
  Core core;
  if (principal) core.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
  Vector3d low = core.axes.transpose() * points.front(), high = low;
  for (const Vector3d& p : points) {
    low = low.cwiseMin(core.axes.transpose() * p);
    high = high.cwiseMax(core.axes.transpose() * p);
  }
  core.center = core.axes * ((low + high) / 2);
  core.half = (high - low) / 2;
  core = core.simplified(0);
  // What has no extent is left to the radius, which then need not be in the others.
  const double radius = dims < 3 ? core.half[dims] : core.half[2] / 10;
  for (int i = 0; i < 3; ++i) core.half[i] = i < dims ? std::max(core.half[i] - radius, 1e-3) : 0;
  core.dims = dims;
  return core;
}

namespace {

/// A surface point and its distance to every core.
struct Corner {
  Vector3d p;
  std::vector<double> distances;
};

class Growth {
 public:
  explicit Growth(std::vector<Core>& cores) : cores_(cores) {}

  Corner corner(const Vector3d& p) {
    Corner corner{p, {}};
    for (const Core& core : cores_) corner.distances.push_back(core.distance(p));
    return corner;
  }

  /// One of the volumes holds all the corners, grown if it must be and `may_grow`.
  bool holds(std::initializer_list<const Corner*> corners, bool may_grow) {
    double least = std::numeric_limits<double>::infinity();
    Core* best = nullptr;
    for (std::size_t i = 0; i < cores_.size(); ++i) {
      double need = -cores_[i].radius;
      for (const Corner* corner : corners) {
        need = std::max(need, corner->distances[i] - cores_[i].radius);
      }
      if (need < least) best = &cores_[i];
      least = std::min(least, need);
    }
    if (least > 0 && may_grow) {
      best->radius += least;
      for (const Corner* corner : corners) tight_.push_back(corner->p);
    }
    return least <= 0 || may_grow;
  }

  void hold(const Corner& a, const Corner& b, const Corner& c) {
    const double ab = (b.p - a.p).norm(), bc = (c.p - b.p).norm(), ca = (a.p - c.p).norm();
    const double longest = std::max({ab, bc, ca});
    // Coarser than the proof's parts by far, so that the proof needs no further growth.
    if (holds({&a, &b, &c}, longest < 4 * kFinest)) return;
    if (longest == ab) return halves(a, b, c);
    if (longest == bc) return halves(b, c, a);
    halves(c, a, b);
  }

  const std::vector<Vector3d>& tight() const { return tight_; }

 private:
  void halves(const Corner& from, const Corner& to, const Corner& tip) {
    const Corner middle = corner((from.p + to.p) / 2);
    holds({&middle}, true);
    hold(from, middle, tip);
    hold(middle, to, tip);
  }

  std::vector<Core>& cores_;
  std::vector<Vector3d> tight_;
};

}  // namespace

std::vector<Vector3d> grow_to_contain(const geometry::TriangleMesh& mesh,
                                      std::vector<Core>& cores) {
  Growth growth(cores);
  std::vector<Corner> corners;
  for (const Vector3d& p : mesh.vertices) {
    corners.push_back(growth.corner(p));
    growth.holds({&corners.back()}, true);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](int i) -> const Corner& { return corners[static_cast<std::size_t>(i)]; };
    growth.hold(at(a), at(b), at(c));
  }
  return growth.tight();
}

}  // namespace tandem::fitting
