#include "tandem/fitting/search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace tandem::fitting {

using Eigen::Vector3d;
using geometry::TriangleMesh;

namespace {

constexpr double kLeastExtent = 1e-3;  // [m] of a core; smaller ones are not worth their kind.

/// One point per cell of a grid, of corners and points inside the triangles.
Points spread_over(const TriangleMesh& mesh, double spacing) {
  std::map<std::array<int, 3>, bool> taken;
  Points points;
  const auto add = [&](const Vector3d& p) {
    std::array<int, 3> cell;
    for (int i = 0; i < 3; ++i) {
      cell[static_cast<std::size_t>(i)] = static_cast<int>(std::floor(p[i] / spacing));
    }
    if (taken.try_emplace(cell, true).second) points.add(p);
  };
  for (const Vector3d& p : mesh.vertices) add(p);
  for (const auto& triangle : mesh.triangles) {
    const auto& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
    const Vector3d ab = mesh.vertices[static_cast<std::size_t>(triangle[1])] - a;
    const Vector3d ac = mesh.vertices[static_cast<std::size_t>(triangle[2])] - a;
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    const int steps = static_cast<int>(std::ceil(longest / spacing));
    for (int i = 0; i <= steps; ++i) {
      for (int k = 0; k <= steps - i; ++k) add(a + (i * ab + k * ac) / std::max(steps, 1));
    }
  }
  return points;
}

/// Evaluates candidates that differ in one core, keeping the distances of the others.
class State {
 public:
  State(const Problem& problem, std::vector<Core> cores)
      : problem_(problem), cores_(std::move(cores)), near_(cores_.size()), far_(cores_.size()) {
    for (std::size_t i = 0; i < cores_.size(); ++i) place(cores_[i], near_[i], far_[i]);
    hold_surface();
    cost_ = cost();
  }

  const std::vector<Core>& cores() const { return cores_; }
  double current() const { return cost_; }
  /// The cores without those that hold nothing and those extents that are hardly any.
  std::vector<Core> simplified() const {
    std::vector<Core> simple;
    for (std::size_t i = 0; i < cores_.size(); ++i) {
      if (owned_[i] > 0) simple.push_back(cores_[i].simplified(kLeastExtent));
    }
    return simple;
  }

  /// Puts `core` in place of core `i` if that costs less.
  bool try_core(std::size_t i, const Core& core) {
    place(core, spare_near_, spare_far_);
    swap(i);
    const std::vector<Core> before = cores_;
    cores_[i] = core;
    hold_surface();
    const double changed = cost();
    if (changed < cost_) {
      cost_ = changed;
      return true;
    }
    cores_ = before;
    swap(i);
    return false;
  }

  /// Cost of cores with the radii that they have.
  static double of_grown(const Problem& problem, const std::vector<Core>& cores) {
    State state(problem, cores);
    state.cores_ = cores;
    return state.cost();
  }

 private:
  double cost() const {
    const std::size_t n = problem_.outside.size();
    const float slope = static_cast<float>(1 / problem_.width);
    double volume = 0, beyond = 0, price = 0;
    depth_.assign(n, -1e9f);
    for (std::size_t k = 0; k < cores_.size(); ++k) {
      const float radius = static_cast<float>(cores_[k].radius);
      const float* d = far_[k].data();
      float* out = depth_.data();
      for (std::size_t i = 0; i < n; ++i) out[i] = std::max(out[i], radius - d[i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      volume += problem_.weight[i] * std::clamp(depth_[i] * slope + 0.5f, 0.f, 1.f);
    }
    for (const Core& core : cores_) {
      price += kPrices[core.dims];
      const Vector3d reach = core.axes.cwiseAbs() * core.half + Vector3d::Constant(core.radius);
      const Vector3d over = (core.center + reach - problem_.sampled.high)
                                .cwiseMax(problem_.sampled.low - core.center + reach);
      beyond += over.cwiseMax(0).sum();
    }
    return volume / problem_.area + price + beyond;
  }

  void place(const Core& core, std::vector<float>& near, std::vector<float>& far) const {
    core.distances(problem_.surface, near);
    core.distances(problem_.outside, far);
  }

  void swap(std::size_t i) {
    std::swap(near_[i], spare_near_);
    std::swap(far_[i], spare_far_);
  }

  /// Radii so that each core holds the points that belong to it.
  void hold_surface() {
    for (Core& core : cores_) core.radius = 1e-4;
    owned_.assign(cores_.size(), 0);
    const std::size_t n = problem_.surface.size();
    for (std::size_t i = 0; i < n; ++i) {
      std::size_t owner = 0;
      float least = near_[0][i] - static_cast<float>(cores_[0].offset);
      for (std::size_t k = 1; k < cores_.size(); ++k) {
        const float value = near_[k][i] - static_cast<float>(cores_[k].offset);
        if (value < least) owner = k;
        least = std::min(least, value);
      }
      cores_[owner].radius = std::max<double>(cores_[owner].radius, near_[owner][i]);
      ++owned_[owner];
    }
  }

  const Problem& problem_;
  std::vector<Core> cores_;
  std::vector<std::vector<float>> near_, far_;  // Distances to the surface, to what is outside.
  std::vector<float> spare_near_, spare_far_;
  std::vector<int> owned_;  // Surface points.
  mutable std::vector<float> depth_;
  double cost_ = 0;
};

/// A core near `core`, about `step` away [m].
Core varied(const Core& core, double step, Rng& rng) {
  const auto random = [&] { return rng.uniform(-1, 1) + rng.uniform(-1, 1); };
  Core other = core;
  // Half of the tries change one thing only: late improvements are along few directions.
  const std::size_t only = rng.index(8);
  const auto changes = [&](std::size_t what) { return only >= 4 || only == what; };
  if (changes(0)) other.center += step * core.axes * Vector3d(random(), random(), random());
  if (changes(1)) {
    const double lever = std::max(core.half.maxCoeff(), 0.01);
    const Vector3d turn = step / lever * Vector3d(random(), random(), random());
    other.axes = core.axes * Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  if (changes(2)) {
    for (int i = 0; i < core.dims; ++i) {
      other.half[i] = std::max(core.half[i] + step * random(), kLeastExtent / 2);
    }
  }
  if (changes(3)) other.offset += step * random();
  return other;
}

/// Direct search, one core at a time, with a step of its own that follows its success.
Candidate improved(const Problem& problem, std::vector<Core> cores, int rounds, Rng& rng,
                   const StopCondition& stop, double first_step = 0) {
  constexpr double kFirstStep = 0.05, kLastStep = 5e-5, kWiden = 1.6, kNarrow = 0.9;
  State state(problem, std::move(cores));
  const double size = problem.sampled.diagonal() / 2;
  std::vector<double> steps(state.cores().size(), first_step > 0 ? first_step : kFirstStep * size);
  for (int round = 0; round < rounds && !stop(); ++round) {
    bool moving = false;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const bool better = state.try_core(i, varied(state.cores()[i], steps[i], rng));
      steps[i] = std::clamp(steps[i] * (better ? kWiden : kNarrow), kLastStep / 2, size / 4);
      moving = moving || steps[i] > kLastStep;
    }
    if (!moving) {
      for (double& step : steps) step = 40 * kLastStep;  // Once more from afar, but not too far.
    }
  }
  const State simple(problem, state.simplified());
  return simple.current() <= state.current() ? Candidate{simple.cores(), simple.current()}
                                             : Candidate{state.cores(), state.current()};
}

std::vector<std::vector<Vector3d>> by_owner(const Problem& problem,
                                            const std::vector<Core>& cores) {
  std::vector<std::vector<Vector3d>> parts(cores.size());
  for (std::size_t i = 0; i < problem.surface.size(); ++i) {
    const Vector3d p = problem.surface[i];
    std::size_t owner = 0;
    const auto value = [&](std::size_t k) { return cores[k].distance(p) - cores[k].offset; };
    for (std::size_t k = 1; k < cores.size(); ++k) owner = value(k) < value(owner) ? k : owner;
    parts[owner].push_back(p);
  }
  return parts;
}

/// A core of `dims` about points, owning what is near to it.
Core core_for(const std::vector<Vector3d>& points, int dims, bool principal) {
  Core core = core_about(points, dims, principal);
  for (const Vector3d& p : points) core.offset = std::max(core.offset, core.distance(p));
  return core;
}

/// `cores` with one of them, at random, replaced by two that share its points; empty if it has too
/// few to share.
std::vector<Core> split(const Problem& problem, std::vector<Core> cores, std::bitset<4> kinds,
                        Rng& rng) {
  constexpr std::size_t kFewest = 4;
  const std::size_t i = rng.index(cores.size());
  const std::vector<Vector3d> part = by_owner(problem, cores)[i];
  if (part.empty()) return {};
  const auto k = static_cast<Eigen::Index>(rng.index(3));
  const Vector3d axis = rng.index(2) == 0 ? Vector3d(Vector3d::Unit(k)) : cores[i].axes.col(k);
  double low = axis.dot(part.front()), high = low;
  for (const Vector3d& p : part) {
    low = std::min(low, axis.dot(p));
    high = std::max(high, axis.dot(p));
  }
  const double at = low + (high - low) * rng.uniform(0.25, 0.75);
  std::vector<Vector3d> halves[2];
  for (const Vector3d& p : part) halves[axis.dot(p) > at].push_back(p);
  if (halves[0].size() < kFewest || halves[1].size() < kFewest) return {};
  for (Core& core : cores) core.offset = core.radius;
  constexpr int kKinds[] = {1, 1, 1, 2, 3, 0};
  const auto kind = [&] {
    for (;;) {
      const int dims = kKinds[rng.index(std::size(kKinds))];
      if (kinds[static_cast<std::size_t>(dims)]) return dims;
    }
  };
  cores[i] = core_for(halves[0], kind(), rng.index(2) == 0);
  cores.push_back(core_for(halves[1], kind(), rng.index(2) == 0));
  return cores;
}

std::vector<int> dims_of(std::bitset<4> kinds) {
  std::vector<int> dims;
  for (std::size_t d = 0; d < kinds.size(); ++d) {
    if (kinds[d]) dims.push_back(static_cast<int>(d));
  }
  return dims;
}

constexpr int kShort = 300, kLong = 1500;  // Rounds.

void keep_cheaper(Candidate& best, Candidate other) {
  if (best.cores.empty() || other.cost < best.cost) best = std::move(other);
}

/// The best of one volume of any kind.
Candidate single(const Problem& problem, std::bitset<4> kinds, Rng& rng,
                 const StopCondition& stop) {
  std::vector<Vector3d> all;
  for (std::size_t i = 0; i < problem.surface.size(); ++i) all.push_back(problem.surface[i]);
  Candidate best;
  for (const int dims : dims_of(kinds)) {
    for (const bool principal : {false, true}) {
      keep_cheaper(best, improved(problem, {core_about(all, dims, principal)}, kShort, rng, stop));
    }
  }
  return best;
}

/// Tries other kinds for every core.
Candidate with_other_kinds(const Problem& problem, Candidate best, std::bitset<4> kinds, Rng& rng,
                           const StopCondition& stop) {
  for (std::size_t i = 0; i < best.cores.size(); ++i) {
    const std::vector<Core> base = best.cores;  // The best may come to have fewer.
    const auto part = by_owner(problem, base)[i];
    if (part.size() < 4) continue;
    for (const int dims : dims_of(kinds)) {
      if (dims == base[i].dims || stop()) continue;
      for (const bool principal : {false, true}) {
        std::vector<Core> cores = base;
        for (Core& core : cores) core.offset = core.radius;
        cores[i] = core_for(part, dims, principal);
        keep_cheaper(best, improved(problem, cores, kShort, rng, stop));
      }
    }
  }
  return best;
}

/// `cores` as the volumes file will hold them, grown until they contain the mesh.
/// @param tight  gets the surface points that made them grow.
Candidate contained(const TriangleMesh& mesh, const Problem& problem, std::vector<Core> cores,
                    std::vector<Vector3d>& tight) {
  // More than rounding in the file and in whoever reads it, less than anyone can measure.
  constexpr double kMargin = 1e-6, kGrid = 1e-6;  // [m]
  for (Core& core : cores) core = core.rounded();
  tight = grow_to_contain(mesh, cores);
  for (Core& core : cores) core.radius = std::ceil((core.radius + kMargin) / kGrid) * kGrid;
  const double cost = State::of_grown(problem, cores);
  return {std::move(cores), cost};
}

/// Goes over to the whole mesh: what sticks out between the points becomes points, until little
/// does.
Candidate settled(const TriangleMesh& mesh, Problem& problem, Candidate found, Rng& rng,
                  const StopCondition& stop) {
  constexpr int kPasses = 4;
  Candidate best;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Vector3d> tight;
    keep_cheaper(best, contained(mesh, problem, found.cores, tight));
    if (tight.empty() || pass + 1 == kPasses || stop()) break;
    for (const Vector3d& p : tight) problem.surface.add(p);
    found = improved(problem, std::move(found.cores), kShort, rng, stop, 2e-3);
  }
  return best;
}

}  // namespace

Problem::Problem(const TriangleMesh& mesh, const Solid& solid, double density)
    : sampled(Bounds::of(mesh)), area(solid.area()) {
  constexpr double kSurfacePoints = 2000;
  surface = spread_over(mesh, std::sqrt(area / (density * kSurfacePoints)));
  // Close to the mesh samples are dense, further away only to say that it is bad there.
  const Bounds tight = sampled;
  const Vector3d near = Vector3d::Constant(0.05 * tight.diagonal());
  const Vector3d far = Vector3d::Constant(0.35 * tight.diagonal());
  const Bounds inner{tight.low - near, tight.high + near};
  sampled = {tight.low - far, tight.high + far};
  const double counts[] = {6000 * density, 3000 * density};
  const auto holds = [](const Bounds& box, const Vector3d& p) {
    return ((p - box.low).array() >= 0).all() && ((box.high - p).array() >= 0).all();
  };
  for (const bool is_inner : {true, false}) {
    const Bounds& box = is_inner ? inner : sampled;
    const auto count = static_cast<std::size_t>(counts[is_inner ? 0 : 1]);
    for (std::size_t i = 1; i <= count; ++i) {
      const Vector3d p = box.low + (box.high - box.low).cwiseProduct(spread_point(i));
      if (!is_inner && holds(inner, p)) continue;
      if (holds(tight, p) && solid.contains(p)) continue;
      outside.add(p);
      weight.push_back(static_cast<float>(box.volume() / static_cast<double>(count)));
    }
  }
  width = 0.5 * std::cbrt(inner.volume() / counts[0]);
}

Candidate search(const TriangleMesh& mesh, const Solid& solid, SearchSize size, Rng& rng,
                 const StopCondition& stop) {
  constexpr std::size_t kKept = 3;
  const Problem coarse(mesh, solid, 0.25);
  Problem fine(mesh, solid, 1);
  std::vector<Candidate> last{
      single(coarse, size.kinds, rng, stop)};  // The best of the last count.
  Candidate best =
      settled(mesh, fine, improved(fine, last.front().cores, kLong, rng, stop), rng, stop);
  for (int more = 2; more <= size.count && !stop(); ++more) {
    std::vector<Candidate> pool;
    for (int start = 0; start < size.starts && !stop(); ++start) {
      const std::vector<Core> cores =
          split(coarse, last[rng.index(last.size())].cores, size.kinds, rng);
      if (!cores.empty()) pool.push_back(improved(coarse, cores, kShort, rng, stop));
    }
    std::ranges::stable_sort(pool, {}, &Candidate::cost);
    pool.resize(std::min(pool.size(), kKept));
    if (pool.empty()) break;
    Candidate next;
    for (Candidate& candidate : pool) {
      candidate = with_other_kinds(coarse, std::move(candidate), size.kinds, rng, stop);
      keep_cheaper(next, improved(fine, candidate.cores, kLong, rng, stop));
    }
    keep_cheaper(best, settled(mesh, fine, std::move(next), rng, stop));
    last = std::move(pool);
  }
  return best;
}

}  // namespace tandem::fitting
