// Distances of cores. Compiled once per instruction set; private to batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_GAP_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_GAP_H
#undef TANDEM_COLLISION_BATCH_GAP_H
#else
#define TANDEM_COLLISION_BATCH_GAP_H
#endif

#include "tandem/collision/batch_support.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

// Distances are squared, with their sign.

/// From the nearest point of the box to p, seen from the box.
HWY_INLINE V3 FromBox(const V3& p, const V3& half) {
  return {hn::Sub(p.x, Clamp(p.x, half.x)), hn::Sub(p.y, Clamp(p.y, half.y)),
          hn::Sub(p.z, Clamp(p.z, half.z))};
}

/// Of a point, seen from the box.
HWY_INLINE V PointBox(const V3& p, const V3& half) {
  const V3 e = FromBox(p, half);
  return Dot(e, e);
}

/// Of a point, seen from a cylinder with x along its axis.
HWY_INLINE V PointCylinder(const V3& p, const V3& half) {
  const V zero = hn::Zero(kFloats);
  const V along = hn::Max(hn::Sub(hn::Abs(p.x), half.x), zero);
  const V from_axis = hn::Sqrt(hn::MulAdd(p.y, p.y, Square(p.z)));
  const V across = hn::Max(hn::Sub(from_axis, half.y), zero);
  return hn::MulAdd(across, across, Square(along));
}

/// From the nearest point of a cylinder with x along its axis to p.
HWY_INLINE V3 FromCylinder(const V3& p, const V3& half) {
  const V from_axis = hn::Sqrt(Positive(hn::MulAdd(p.y, p.y, Square(p.z))));
  const V beyond = hn::Max(hn::Sub(from_axis, half.y), hn::Zero(kFloats));
  const V part = hn::Div(beyond, from_axis);
  return {hn::Sub(p.x, Clamp(p.x, half.x)), hn::Mul(part, p.y), hn::Mul(part, p.z)};
}

/// A segment's half vector and one over its square, which does not change with where it is.
struct Half {
  V3 u;
  float inverse;
};

/// From the nearest point of a segment to a point r from its centre.
HWY_INLINE V3 FromSegment(const V3& r, const Half& half) {
  const V3& u = half.u;
  const V t = Clamp(hn::Mul(Dot(r, u), Fill(half.inverse)), Fill(1));
  return MulAdd3(hn::Neg(t), u, r);
}

/// Of two segments; r leads from the centre of the second to the first.
/// Ref: Ericson, Real-time collision detection (2005), 5.1.9.
HWY_INLINE V SegmentSegment(const V3& r, const Half& a, const Half& b) {
  const V3 &u = a.u, &v = b.u;
  const V uu = Dot(u, u), vv = Dot(v, v), uv = Dot(u, v);
  const V ur = Dot(u, r), vr = Dot(v, r), one = Fill(1);
  const V determinant = Positive(hn::NegMulAdd(uv, uv, hn::Mul(uu, vv)));
  V s = Clamp(hn::Div(hn::NegMulAdd(ur, vv, hn::Mul(uv, vr)), determinant), one);
  const V t = Clamp(hn::Mul(hn::MulAdd(s, uv, vr), Fill(b.inverse)), one);
  s = Clamp(hn::Mul(hn::MulSub(t, uv, ur), Fill(a.inverse)), one);
  const V3 e = MulAdd3(hn::Neg(t), v, MulAdd3(s, u, r));
  return Dot(e, e);
}

/// Half the derivative of the squared distance of the point c + t u to a box.
HWY_INLINE V BoxSlope(const V3& c, const V3& u, const V3& half, V t) {
  const V3 p = MulAdd3(t, u, c);
  const V ex = hn::Sub(p.x, Clamp(p.x, half.x));
  const V ey = hn::Sub(p.y, Clamp(p.y, half.y));
  const V ez = hn::Sub(p.z, Clamp(p.z, half.z));
  return hn::MulAdd(u.z, ez, hn::MulAdd(u.y, ey, hn::Mul(u.x, ex)));
}

/// Of the segment {c + t u, |t| <= 1}, seen from the box. The squared distance is convex and
/// piecewise quadratic in t with breaks at the faces' planes: its derivative is bracketed between
/// breaks, where it is linear.
HWY_INLINE V SegmentBox(const V3& c, const V3& u, const V3& half) {
  V low = Fill(-1), high = Fill(1);
  V at_low = BoxSlope(c, u, half, low), at_high = BoxSlope(c, u, half, high);
  const V zero = hn::Zero(kFloats);
  const Mask ends_low = hn::Ge(at_low, zero), ends_high = hn::Le(at_high, zero);
  const auto narrow = [&](V t) HWY_ATTR {
    const V at_t = BoxSlope(c, u, half, t);
    const Mask inside = hn::And(hn::Gt(t, low), hn::Lt(t, high));
    const Mask below = hn::Lt(at_t, zero);
    const Mask to_low = hn::And(inside, below), to_high = hn::AndNot(below, inside);
    low = hn::IfThenElse(to_low, t, low);
    at_low = hn::IfThenElse(to_low, at_t, at_low);
    high = hn::IfThenElse(to_high, t, high);
    at_high = hn::IfThenElse(to_high, at_t, at_high);
  };
  const auto both_sides = [&](V cx, V ux, V hx) HWY_ATTR {
    const V inverse = hn::Div(Fill(1), ux);  // Infinite where parallel: no break is inside.
    narrow(hn::Mul(hn::Sub(hx, cx), inverse));
    narrow(hn::Mul(hn::Sub(hn::Neg(hx), cx), inverse));
  };
  both_sides(c.x, u.x, half.x);
  both_sides(c.y, u.y, half.y);
  both_sides(c.z, u.z, half.z);
  const V rise = Positive(hn::Sub(at_high, at_low));
  V t = hn::NegMulAdd(hn::Div(at_low, rise), hn::Sub(high, low), low);
  t = hn::IfThenElse(ends_low, Fill(-1), hn::IfThenElse(ends_high, Fill(1), t));
  return PointBox(MulAdd3(t, u, c), half);
}

/// A box as three unit axes and half edges.
struct Box {
  V3 x, y, z, half;
};

/// How far planes normal to n hold two boxes apart, times |n|; r from the centre of B to that of A.
HWY_INLINE V Slit(const V3& n, const V3& r, const Box& a, const Box& b) {
  const auto extent = [&](const Box& box) HWY_ATTR {
    return hn::MulAdd(box.half.z, hn::Abs(Dot(n, box.z)),
                      hn::MulAdd(box.half.y, hn::Abs(Dot(n, box.y)),
                                 hn::Mul(box.half.x, hn::Abs(Dot(n, box.x)))));
  };
  return hn::Sub(hn::Abs(Dot(n, r)), hn::Add(extent(a), extent(b)));
}

/// A lower bound of the distance of two boxes, negative only where they overlap.
/// Ref: Gottschalk, Lin, Manocha, OBBTree (1996).
HWY_NOINLINE V BoxBox(const V3& r, const Box& a, const Box& b) {
  const V3* axes_a[] = {&a.x, &a.y, &a.z};
  const V3* axes_b[] = {&b.x, &b.y, &b.z};
  V most = Fill(-1e30F);
  for (const V3* n : axes_a) most = hn::Max(most, Slit(*n, r, a, b));
  for (const V3* n : axes_b) most = hn::Max(most, Slit(*n, r, a, b));
  // Where edges are nearly parallel their normal is mostly noise. It may be all that separates the
  // boxes, so that without it an overlap is not sure.
  constexpr float kLeastSine = 0.0625F;
  Mask skipped = hn::MaskFromVec(hn::Zero(kFloats));
  for (const V3* na : axes_a) {
    for (const V3* nb : axes_b) {
      const V3 n = Cross(*na, *nb);
      const V squared = Dot(n, n);
      const Mask noise = hn::Lt(squared, Fill(kLeastSine * kLeastSine));
      const V slit = hn::Div(Slit(n, r, a, b), hn::Sqrt(Positive(squared)));
      most = hn::IfThenElse(noise, most, hn::Max(most, slit));
      skipped = hn::Or(skipped, noise);
    }
  }
  most = hn::IfThenElse(skipped, hn::Max(most, hn::Zero(kFloats)), most);
  return hn::Mul(most, hn::Abs(most));
}

/// What is known of the distance of two cores.
struct Gap {
  V squared;          ///< [m^2] lower bound, with its sign,
  V upper;            ///< and upper bound.
  float touch_below;  ///< [m^2] Where the upper bound is less, the shapes touch for sure.
  bool is_vague;      ///< Where the lower bound is 0 or less, nothing more is found out here.
};

/// Distances of placed shapes.
class Gaps {
 public:
  Gaps(const BatchModel& model, Placement& placement) : model_(model), placement_(placement) {}

  const BatchShape& ShapeAt(int shape) const {
    return model_.shapes[static_cast<std::size_t>(shape)];
  }
  HWY_INLINE V3 Center(int shape) { return placement_.CenterOf(shape); }

  /// Of a point in C to a core, or to the box around an opaque one.
  HWY_INLINE V PointTo(const V3& p, int b) {
    const BatchShape& shape_b = ShapeAt(b);
    if (shape_b.core == BatchCore::kCylinder) {  // No division.
      return PointCylinder(PointInBox(p, b), Fill(shape_b.half));
    }
    const V3 e = FromShape(p, b);
    return Dot(e, e);
  }
  /// From the nearest point of that to p, along the axes of the shape's box.
  HWY_INLINE V3 FromShape(const V3& p, int b) {
    const BatchShape& shape_b = ShapeAt(b);
    switch (shape_b.core) {
      case BatchCore::kPoint:
        return p - Center(b);
      case BatchCore::kSegment:
        return FromSegment(p - Center(b), HalfOf(b));
      case BatchCore::kCylinder:
        return FromCylinder(PointInBox(p, b), Fill(shape_b.half));
      default:
        return FromBox(PointInBox(p, b), Fill(shape_b.half));
    }
  }
  /// A direction in C along the axes that FromShape uses.
  HWY_INLINE V3 AlongAxesOf(int shape, const V3& v) {
    return ShapeAt(shape).core <= BatchCore::kSegment ? v : DirectionInBox(v, shape);
  }

  /// Of a point a and a core b at this distance.
  HWY_INLINE Gap OfPoint(V squared, int a, int b) const {
    return Exactly(squared, ShapeAt(a), ShapeAt(b));
  }
  /// Whether FromShape is from the core itself.
  HWY_INLINE bool HasNearestPoint(int b) const { return ShapeAt(b).core <= BatchCore::kCylinder; }

  /// Of two cores.
  /// @param reach  [m] Beyond it a coarse lower bound will do.
  HWY_NOINLINE Gap Between(int a, int b, V reach) {
    if (ShapeAt(a).core > ShapeAt(b).core) std::swap(a, b);  // The simpler one first.
    const BatchShape& shape_a = ShapeAt(a);
    const BatchShape& shape_b = ShapeAt(b);
    const V3 p = Center(a);
    if (shape_a.core == BatchCore::kPoint && HasNearestPoint(b))
      return OfPoint(PointTo(p, b), a, b);
    if (shape_b.core <= BatchCore::kBox && shape_a.core == BatchCore::kSegment) {
      return Exactly(SegmentTo(p, HalfOf(a), b), shape_a, shape_b);
    }
    const V around = BetweenBoxes(p, a, b);
    const float touch_below = TouchBelow(shape_a, shape_b);
    const bool two_boxes = shape_a.core == BatchCore::kBox && shape_b.core == BatchCore::kBox;
    if (shape_b.core == BatchCore::kOpaque || All(hn::Gt(around, Square(reach)))) {
      return {around, around, kNever, !two_boxes};
    }
    if (two_boxes && touch_below == kNever) {
      const float margin = 0.5F * (shape_a.outer - shape_a.inner + shape_b.outer - shape_b.inner);
      return {around, around, -margin * margin, false};
    }
    const Bounds bounds = BoundDistance(Supports(model_, placement_), a, b, p - Center(b));
    return {hn::Max(bounds.lower, around), bounds.upper, touch_below, touch_below == kNever};
  }

 private:
  static constexpr float kNever = -std::numeric_limits<float>::infinity();

  static float TouchBelow(const BatchShape& a, const BatchShape& b) {
    const float inner = a.inner + b.inner;
    return inner > 0 ? inner * inner : kNever;
  }

  /// Of cores at this distance.
  HWY_INLINE static Gap Exactly(V squared, const BatchShape& a, const BatchShape& b) {
    return {squared, squared, TouchBelow(a, b), false};
  }
  /// Of the boxes around two cores, of which the first may be a point or a segment.
  HWY_INLINE V BetweenBoxes(const V3& p, int a, int b) {
    switch (ShapeAt(a).core) {
      case BatchCore::kPoint:
        return PointBox(PointInBox(p, b), Fill(ShapeAt(b).half));
      case BatchCore::kSegment: {
        const V3 u = DirectionInBox(HalfOf(a).u, b);
        return SegmentBox(PointInBox(p, b), u, Fill(ShapeAt(b).half));
      }
      default:
        return BoxBox(p - Center(b), BoxOf(a), BoxOf(b));
    }
  }

  HWY_INLINE V3 DirectionInBox(const V3& v, int shape) {
    if (ShapeAt(shape).aligned) return v;
    return {Dot(placement_.AxisOf(shape, 0), v), Dot(placement_.AxisOf(shape, 1), v),
            Dot(placement_.AxisOf(shape, 2), v)};
  }
  HWY_INLINE V3 PointInBox(const V3& p, int shape) {
    const BatchShape& box = ShapeAt(shape);
    if (box.aligned) return p - Fill(box.p_JC);
    return DirectionInBox(p - Center(shape), shape);
  }
  HWY_INLINE Box BoxOf(int shape) {
    return {placement_.AxisOf(shape, 0), placement_.AxisOf(shape, 1), placement_.AxisOf(shape, 2),
            Fill(ShapeAt(shape).half)};
  }
  HWY_INLINE Half HalfOf(int segment) {
    return {placement_.HalfVectorOf(segment), ShapeAt(segment).inverse};
  }
  HWY_INLINE V SegmentTo(const V3& p, const Half& a, int b) {
    if (ShapeAt(b).core == BatchCore::kSegment) {
      return SegmentSegment(p - Center(b), a, HalfOf(b));
    }
    return SegmentBox(PointInBox(p, b), DirectionInBox(a.u, b), Fill(ShapeAt(b).half));
  }

  const BatchModel& model_;
  Placement& placement_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
