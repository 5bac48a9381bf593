// Vectors of points, sines and cosines. One of several files that batch_kernels.cpp compiles once
// per instruction set; private to it.
#if defined(TANDEM_COLLISION_BATCH_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_LANES_H
#undef TANDEM_COLLISION_BATCH_LANES_H
#else
#define TANDEM_COLLISION_BATCH_LANES_H
#endif

#include <hwy/highway.h>

#include "tandem/collision/batch_work.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kMostLanes>;
using V = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
inline constexpr Floats kFloats{};
inline constexpr int kLanes = static_cast<int>(hn::MaxLanes(kFloats));

HWY_INLINE V Fill(float value) { return hn::Set(kFloats, value); }
HWY_INLINE V Load(const LaneRow& row) { return hn::Load(kFloats, row.lane); }
HWY_INLINE void Store(V v, LaneRow& row) { hn::Store(v, kFloats, row.lane); }
HWY_INLINE V Square(V v) { return hn::Mul(v, v); }
HWY_INLINE bool All(Mask mask) { return hn::AllTrue(kFloats, mask); }
HWY_INLINE bool None(Mask mask) { return hn::AllFalse(kFloats, mask); }

/// One bit per lane.
HWY_INLINE unsigned Bits(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

/// Points or vectors, one per lane.
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 Fill(const Vector3f3& v) { return {Fill(v[0]), Fill(v[1]), Fill(v[2])}; }
HWY_INLINE V3 Load3(const LaneRow* rows) { return {Load(rows[0]), Load(rows[1]), Load(rows[2])}; }
HWY_INLINE void Store3(const V3& v, LaneRow* rows) {
  Store(v.x, rows[0]);
  Store(v.y, rows[1]);
  Store(v.z, rows[2]);
}
HWY_INLINE V3 operator-(const V3& a, const V3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V3 operator+(const V3& a, const V3& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE V3 Scale(V s, const V3& v) {
  return {hn::Mul(s, v.x), hn::Mul(s, v.y), hn::Mul(s, v.z)};
}
/// s * v + a
HWY_INLINE V3 MulAdd3(V s, const V3& v, const V3& a) {
  return {hn::MulAdd(s, v.x, a.x), hn::MulAdd(s, v.y, a.y), hn::MulAdd(s, v.z, a.z)};
}
HWY_INLINE V Dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}
HWY_INLINE V3 Cross(const V3& a, const V3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}
HWY_INLINE V Clamp(V v, V limit) { return hn::Max(hn::Neg(limit), hn::Min(v, limit)); }

/// Sine and cosine of |x| < 100 to 1.5e-7.
/// Ref: Cody, Waite, Software manual for the elementary functions (1980); minimax polynomials on an
/// eighth of a turn as in Moshier's Cephes (1989).
HWY_INLINE void SinCos(V x, V& sine, V& cosine) {
  const hn::Rebind<std::int32_t, Floats> ints;
  const V quarters = hn::Round(hn::Mul(x, Fill(0.636619772F)));
  // Half of pi in three parts, so that the products are exact.
  V r = hn::NegMulAdd(quarters, Fill(1.5703125F), x);
  r = hn::NegMulAdd(quarters, Fill(4.83751296997e-4F), r);
  r = hn::NegMulAdd(quarters, Fill(7.54978994e-8F), r);
  const V z = Square(r);
  V s = hn::MulAdd(z, Fill(-1.9515295891e-4F), Fill(8.3321608736e-3F));
  s = hn::MulAdd(s, z, Fill(-1.6666654611e-1F));
  s = hn::MulAdd(hn::Mul(s, z), r, r);
  V c = hn::MulAdd(z, Fill(2.443315711809948e-5F), Fill(-1.388731625493765e-3F));
  c = hn::MulAdd(c, z, Fill(4.166664568298827e-2F));
  c = hn::MulAdd(hn::Mul(c, z), z, hn::NegMulAdd(Fill(0.5F), z, Fill(1.0F)));
  const auto k = hn::ConvertTo(ints, quarters);
  const auto one = hn::Set(ints, 1), two = hn::Set(ints, 2);
  const Mask odd = hn::RebindMask(kFloats, hn::Eq(hn::And(k, one), one));
  const auto sign = [&](auto number) HWY_ATTR {
    return hn::BitCast(kFloats, hn::ShiftLeft<30>(hn::And(number, two)));
  };
  sine = hn::Xor(hn::IfThenElse(odd, c, s), sign(k));
  cosine = hn::Xor(hn::IfThenElse(odd, s, c), sign(hn::Add(k, one)));
}

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
