// Distances of any convex cores, by their support points. Compiled once per instruction set;
// private to batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_SUPPORT_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_SUPPORT_H
#undef TANDEM_COLLISION_BATCH_SUPPORT_H
#else
#define TANDEM_COLLISION_BATCH_SUPPORT_H
#endif

#include "tandem/collision/batch_place.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

HWY_INLINE V3 Select(Mask mask, const V3& yes, const V3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// Guards a division: squares of lengths far below any shape's.
HWY_INLINE V Positive(V squared) { return hn::Max(squared, Fill(1e-30F)); }

/// The points of cores that are furthest along directions in C, which need not be unit vectors.
class Supports {
 public:
  Supports(const BatchModel& model, Placement& placement) : model_(model), placement_(placement) {}

  HWY_INLINE V3 Of(int shape, const V3& along) {
    const BatchShape& s = model_.shapes[static_cast<std::size_t>(shape)];
    const V3 center = placement_.CenterOf(shape);
    switch (s.core) {
      case BatchCore::kPoint:
        return center;
      case BatchCore::kSegment: {
        const V3 u = placement_.HalfVectorOf(shape);
        return MulAdd3(Toward(Fill(1), Dot(u, along)), u, center);
      }
      case BatchCore::kCylinder:
        return center + OfCylinder(s, AxesOf(shape), along);
      case BatchCore::kPolytope:
        return center + OfPolytope(s, AxesOf(shape), along);
      default:
        return center + OfBox(s, AxesOf(shape), along);
    }
  }

 private:
  struct Axes {
    V3 x, y, z;
  };
  HWY_INLINE Axes AxesOf(int shape) {
    return {placement_.AxisOf(shape, 0), placement_.AxisOf(shape, 1), placement_.AxisOf(shape, 2)};
  }
  /// `length` with the sign of `along`.
  HWY_INLINE static V Toward(V length, V along) { return hn::CopySign(length, along); }

  HWY_INLINE static V3 OfBox(const BatchShape& s, const Axes& axes, const V3& along) {
    const auto& [x, y, z] = axes;
    return MulAdd3(Toward(Fill(s.half[0]), Dot(x, along)), x,
                   MulAdd3(Toward(Fill(s.half[1]), Dot(y, along)), y,
                           Scale(Toward(Fill(s.half[2]), Dot(z, along)), z)));
  }
  HWY_INLINE static V3 OfCylinder(const BatchShape& s, const Axes& axes, const V3& along) {
    const auto& [x, y, z] = axes;
    // By its coordinates, the rim's point is one of the rim however the direction is rounded.
    const V of_y = Dot(y, along), of_z = Dot(z, along);
    const V scale =
        hn::Div(Fill(s.half[1]), hn::Sqrt(Positive(hn::MulAdd(of_y, of_y, Square(of_z)))));
    return MulAdd3(Toward(Fill(s.half[0]), Dot(x, along)), x,
                   MulAdd3(hn::Mul(scale, of_y), y, Scale(hn::Mul(scale, of_z), z)));
  }
  HWY_INLINE V3 OfPolytope(const BatchShape& s, const Axes& axes, const V3& along) const {
    const auto& [x, y, z] = axes;
    const V3 along_B{Dot(x, along), Dot(y, along), Dot(z, along)};
    const Vector3f3* vertices = &model_.vertices[static_cast<std::size_t>(s.first_vertex)];
    V3 best = Fill(vertices[0]);
    V most = Dot(best, along_B);
    for (int i = 1; i < s.vertex_count; ++i) {
      const V3 vertex = Fill(vertices[i]);
      const V reached = Dot(vertex, along_B);
      best = Select(hn::Gt(reached, most), vertex, best);
      most = hn::Max(most, reached);
    }
    return MulAdd3(best.x, x, MulAdd3(best.y, y, Scale(best.z, z)));
  }

  const BatchModel& model_;
  Placement& placement_;
};

/// Bounds of a distance, squared.
struct Bounds {
  V lower, upper;
};

/// The point nearest to the origin in what is left of a simplex, and the vertices around it. Fewer
/// than three stand several times.
struct Nearest {
  V3 point, a, b, c;
  V squared;

  HWY_INLINE void Take(Mask among, const V3& p, const V3& pa, const V3& pb, const V3& pc) {
    const V length = Dot(p, p);
    const Mask nearer = hn::And(among, hn::Lt(length, squared));
    squared = hn::IfThenElse(nearer, length, squared);
    point = Select(nearer, p, point);
    a = Select(nearer, pa, a);
    b = Select(nearer, pb, b);
    c = Select(nearer, pc, c);
  }
  /// An edge from w to p.
  HWY_INLINE void TakeEdge(const V3& w, const V3& p) {
    const V3 edge = p - w;
    const V t = hn::Div(hn::Neg(Dot(w, edge)), Positive(Dot(edge, edge)));
    const V inside = hn::Max(hn::Zero(kFloats), hn::Min(t, Fill(1)));
    Take(hn::Eq(w.x, w.x), MulAdd3(inside, edge, w), w, p, p);
  }
  /// The inside of a triangle: its point by weights, so that rounding keeps it in the triangle.
  HWY_INLINE void TakeFace(const V3& w, const V3& p, const V3& q) {
    const V3 n = Cross(p - w, q - w);
    const V of_w = Dot(n, Cross(p, q)), of_p = Dot(n, Cross(q, w)), of_q = Dot(n, Cross(w, p));
    const V zero = hn::Zero(kFloats);
    const V sum = hn::Add(hn::Add(of_w, of_p), of_q);
    const Mask inside = hn::And(hn::And(hn::Gt(of_w, zero), hn::Gt(of_p, zero)),
                                hn::And(hn::Gt(of_q, zero), hn::Gt(sum, Fill(1e-30F))));
    const V scale = hn::Div(Fill(1), Positive(sum));
    const V3 weighted = MulAdd3(hn::Mul(of_w, scale), w,
                                MulAdd3(hn::Mul(of_p, scale), p, Scale(hn::Mul(of_q, scale), q)));
    Take(inside, weighted, w, p, q);
  }
};

/// Of two cores. Every direction bounds the distance from below by the gap between planes across
/// it, every point of the Minkowski difference from above. Of lanes that overlap nothing is known
/// from below. Ref: Gilbert, Johnson, Keerthi, A fast procedure for computing the distance (1988).
HWY_NOINLINE Bounds BoundDistance(Supports supports, int a, int b, const V3& from_b_to_a) {
  constexpr int kMostRounds = 16;
  constexpr float kClose = 0.99F;  // Of what the lower bound may be.
  const auto support = [&](const V3& v) HWY_ATTR {
    const V3 back{hn::Neg(v.x), hn::Neg(v.y), hn::Neg(v.z)};
    return supports.Of(a, back) - supports.Of(b, v);
  };
  const V3 first = support(from_b_to_a);
  Nearest nearest{first, first, first, first, Dot(first, first)};
  V lower = hn::Zero(kFloats);
  for (int round = 0; round < kMostRounds; ++round) {
    const V3 v = nearest.point;
    const V3 w = support(v);
    const V length = hn::Sqrt(Positive(nearest.squared));
    lower = hn::Max(lower, hn::Div(Dot(v, w), length));
    // Where less is left than single precision sees, the cores overlap.
    if (All(hn::Or(hn::Ge(lower, hn::Mul(Fill(kClose), length)), hn::Lt(length, Fill(1e-6F))))) {
      break;
    }
    const V3 pa = nearest.a, pb = nearest.b, pc = nearest.c;
    const V before = nearest.squared;
    nearest.TakeEdge(w, pa);
    nearest.TakeEdge(w, pb);
    nearest.TakeEdge(w, pc);
    nearest.TakeFace(w, pa, pb);
    nearest.TakeFace(w, pb, pc);
    nearest.TakeFace(w, pa, pc);
    if (None(hn::Lt(nearest.squared, before))) break;
  }
  // How deep cores overlap is not known.
  const V unbounded = Fill(-1e30F);
  const Mask apart = hn::Gt(lower, hn::Zero(kFloats));
  return {hn::IfThenElse(apart, hn::Mul(lower, lower), unbounded), nearest.squared};
}

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
