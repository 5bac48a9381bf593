// Where joints, groups, bodies and shapes are. Compiled once per instruction set; private to
// batch_kernels.cpp.
#if defined(TANDEM_COLLISION_BATCH_PLACE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TANDEM_COLLISION_BATCH_PLACE_H
#undef TANDEM_COLLISION_BATCH_PLACE_H
#else
#define TANDEM_COLLISION_BATCH_PLACE_H
#endif

#include "tandem/collision/batch_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace tandem::collision::HWY_NAMESPACE {

/// A frame in C, one per lane.
struct Pose {
  V3 x, y, z, p;
};

HWY_INLINE Pose LoadPose(const LaneRow* rows) {
  return {Load3(rows), Load3(rows + 3), Load3(rows + 6), Load3(rows + 9)};
}

/// Directions of the frame: R * v for v given by numbers, of which most are often zero.
HWY_INLINE V3 Turn(const Pose& X, float x, float y, float z) {
  if (x == 0 && z == 0) return Scale(Fill(y), X.y);
  if (x == 0 && y == 0) return Scale(Fill(z), X.z);
  if (x == 0) return MulAdd3(Fill(z), X.z, Scale(Fill(y), X.y));
  if (y == 0 && z == 0) return Scale(Fill(x), X.x);
  return MulAdd3(Fill(z), X.z, MulAdd3(Fill(y), X.y, Scale(Fill(x), X.x)));
}

HWY_INLINE V3 Transform(const Pose& X, const Vector3f3& p) {
  return MulAdd3(Fill(p[2]), X.z, MulAdd3(Fill(p[1]), X.y, MulAdd3(Fill(p[0]), X.x, X.p)));
}

/// One block of configurations: places what is asked for.
class Placement {
 public:
  explicit Placement(BatchChecker::Scratch& work) : work_(work), model_(work.model) {}

  /// Places joints and groups from Scratch::values.
  void Place(const BatchPairs& pairs) {
    ++work_.now;
    for (const int joint : pairs.joints) PlaceJoint(static_cast<std::size_t>(joint));
  }
  HWY_INLINE Pose PoseOf(int joint) const {
    return LoadPose(&work_.poses[12 * static_cast<std::size_t>(joint)]);
  }
  HWY_INLINE V3 GroupCenter(int group) const {
    return Load3(&work_.group_centers[3 * static_cast<std::size_t>(group)]);
  }
  HWY_INLINE V3 BodyCenter(int body) {
    const auto b = static_cast<std::size_t>(body);
    if (work_.body_time[b] < work_.now) PlaceBody(b);
    return Load3(&work_.body_centers[3 * b]);
  }
  /// Centre of a shape's box,
  HWY_INLINE V3 CenterOf(int shape) {
    const BatchShape& s = ShapeAt(shape);
    return s.joint < 0 ? Fill(s.p_JC) : Load3(Placed(s));
  }
  /// its axis x, y or z,
  HWY_INLINE V3 AxisOf(int shape, int axis) {
    const BatchShape& s = ShapeAt(shape);
    const float* along = &s.R_BJ[3 * static_cast<std::size_t>(axis)];
    return s.joint < 0 ? Fill({along[0], along[1], along[2]}) : Load3(Placed(s) + 3 + 3 * axis);
  }
  /// or the half vector of a segment.
  HWY_INLINE V3 HalfVectorOf(int segment) {
    const BatchShape& s = ShapeAt(segment);
    if (s.joint >= 0) return Load3(Placed(s) + 3);
    return Fill({s.half[0] * s.R_BJ[0], s.half[0] * s.R_BJ[1], s.half[0] * s.R_BJ[2]});
  }

 private:
  HWY_INLINE const BatchShape& ShapeAt(int shape) const {
    return model_.shapes[static_cast<std::size_t>(shape)];
  }
  /// 12 rows of a shape that moves, see Scratch::placed_shapes.
  HWY_INLINE const LaneRow* Placed(const BatchShape& shape) {
    const auto slot = static_cast<std::size_t>(shape.slot);
    if (work_.shape_time[slot] < work_.now) PlaceShape(shape, slot);
    return &work_.placed_shapes[12 * slot];
  }

  void PlaceJoint(std::size_t j) {
    const BatchJoint& joint = model_.joints[j];
    const std::array<float, 9>& R = joint.R_PJ;
    Pose X;
    if (joint.parent < 0) {
      X = {Fill({R[0], R[1], R[2]}), Fill({R[3], R[4], R[5]}), Fill({R[6], R[7], R[8]}),
           Fill(joint.p_PJ)};
    } else {
      const Pose P = PoseOf(joint.parent);
      X = {Turn(P, R[0], R[1], R[2]), Turn(P, R[3], R[4], R[5]), Turn(P, R[6], R[7], R[8]),
           Transform(P, joint.p_PJ)};
    }
    const V value = Load(work_.values[j]);
    if (joint.prismatic) {
      X.p = MulAdd3(value, X.z, X.p);
    } else {
      V s, c;
      SinCos(value, s, c);
      const V3 x = X.x;
      X.x = MulAdd3(s, X.y, Scale(c, x));
      X.y = MulAdd3(hn::Neg(s), x, Scale(c, X.y));
    }
    LaneRow* rows = &work_.poses[12 * j];
    Store3(X.x, rows);
    Store3(X.y, rows + 3);
    Store3(X.z, rows + 6);
    Store3(X.p, rows + 9);
    Store3(Transform(X, model_.groups[j].p_JC), &work_.group_centers[3 * j]);
  }

  void PlaceBody(std::size_t b) {
    const BatchBody& body = model_.bodies[b];
    Store3(Transform(PoseOf(body.joint), body.sphere.p_JC), &work_.body_centers[3 * b]);
    work_.body_time[b] = work_.now;
  }

  HWY_NOINLINE void PlaceShape(const BatchShape& shape, std::size_t slot) {
    const Pose X = PoseOf(shape.joint);
    const std::array<float, 9>& R = shape.R_BJ;
    LaneRow* rows = &work_.placed_shapes[12 * slot];
    Store3(Transform(X, shape.p_JC), rows);
    if (shape.core == BatchCore::kSegment) {
      Store3(Turn(X, shape.half[0] * R[0], shape.half[0] * R[1], shape.half[0] * R[2]), rows + 3);
    } else if (shape.core != BatchCore::kPoint) {
      Store3(Turn(X, R[0], R[1], R[2]), rows + 3);
      Store3(Turn(X, R[3], R[4], R[5]), rows + 6);
      Store3(Turn(X, R[6], R[7], R[8]), rows + 9);
    }
    work_.shape_time[slot] = work_.now;
  }

  BatchChecker::Scratch& work_;
  const BatchModel& model_;
};

}  // namespace tandem::collision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
