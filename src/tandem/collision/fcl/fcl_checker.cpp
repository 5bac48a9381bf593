#include "tandem/collision/fcl/fcl_checker.h"

#include <algorithm>
#include <iterator>

#include "tandem/collision/fcl/fcl_cloud.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What FCL shall see of a body.
struct BodyPieces {
  std::vector<FclPiece> pieces;
  std::vector<std::unique_ptr<const FclCloud>> clouds;
};

Result<BodyPieces> make_pieces(const world::Workcell& cell, const world::Body& body,
                               FclGeometry geometry, FclMeshes& meshes) {
  BodyPieces made;
  if (geometry == FclGeometry::kVolumes || body.kind != world::Body::Kind::kRobotLink) {
    const double padding = geometry == FclGeometry::kVolumes ? body.padding : 0.0;
    for (const geometry::Shape& shape_L : body.shapes_L) {
      made.pieces.push_back(make_piece(shape_L.padded(padding)));
    }
    for (const geometry::PlacedSurface& surface_L : body.surfaces_L) {
      if (surface_L.surface->is_mesh()) {
        made.pieces.push_back(make_piece(surface_L, padding));
      } else {
        made.clouds.push_back(std::make_unique<FclCloud>(surface_L, padding));
      }
    }
    return made;
  }
  const robot::Link& link = cell.model().links()[static_cast<std::size_t>(body.link)];
  if (link.collision.empty()) {
    return fail(ErrorCode::kUnsupported,
                "link '" + link.name +
                    "' has swept sphere volumes but no collision geometry in its URDF, so there is "
                    "nothing to check it against; add collision geometry to the URDF");
  }
  for (const robot::Geometry& part : link.collision) {
    Result<FclPiece> piece = make_piece(part, link.name, meshes);
    if (!piece) return std::unexpected(piece.error());
    made.pieces.push_back(std::move(*piece));
  }
  return made;
}

}  // namespace

struct FclChecker::Impl {
  class Scratch;

  struct Body {
    int link;
    bool moves;
    std::size_t first_piece, piece_count;
    std::size_t first_cloud, cloud_count;
  };
  /// A piece as placed.
  struct Placed {
    const FclPiece& piece;
    Eigen::Isometry3d X_WG;
    FclBox box;
  };

  std::shared_ptr<const world::Workcell> cell;
  std::vector<Body> bodies;
  std::vector<FclPiece> pieces;
  std::vector<std::unique_ptr<const FclCloud>> clouds;

  const world::BodyPair& pair(int index) const {
    expects(0 <= index && index < static_cast<int>(cell->pairs().size()),
            "a selection holds indices into pairs()");
    return cell->pairs()[static_cast<std::size_t>(index)];
  }
  Scratch& place(const Eigen::Ref<const Eigen::VectorXd>& q,
                 CollisionChecker::Scratch& scratch) const;
  bool improve(int index, const Scratch& scratch, PairClearance& best) const;
  static bool improve(int index, const Placed& a, const Placed& b, PairClearance& best);
  bool improve_with_clouds(int index, const Scratch& scratch, PairClearance& best) const;
  bool improve_with_cloud(int index, const Placed& other, std::size_t cloud, bool cloud_is_a,
                          const Scratch& scratch, PairClearance& best) const;
};

class FclChecker::Impl::Scratch final : public CollisionChecker::Scratch {
 public:
  explicit Scratch(const Impl& impl)
      : owner(&impl),
        X_WG(impl.pieces.size()),
        boxes(impl.pieces.size()),
        X_WL_of_cloud(impl.clouds.size()),
        cloud_boxes(impl.clouds.size()),
        body_boxes(impl.bodies.size()) {
    place(Eigen::VectorXd::Zero(impl.cell->dof()), true);
  }

  /// Poses and boxes at q; of bodies that no arm moves only if `all`.
  void place(const Eigen::Ref<const Eigen::VectorXd>& q, bool all) {
    owner->cell->forward_kinematics(q, positions, X_WL);
    for (std::size_t b = 0; b < owner->bodies.size(); ++b) {
      const Body& body = owner->bodies[b];
      if (!body.moves && !all) continue;
      Eigen::Vector3d low = Eigen::Vector3d::Constant(kInfinity), high = -low;
      const auto include = [&](const FclBox& box) {
        low = low.cwiseMin(box.center - box.half);
        high = high.cwiseMax(box.center + box.half);
      };
      for (std::size_t p = body.first_piece; p < body.first_piece + body.piece_count; ++p) {
        X_WG[p] = X_WL[static_cast<std::size_t>(body.link)] * owner->pieces[p].X_LG;
        boxes[p] = box_around(owner->pieces[p], X_WG[p]);
        include(boxes[p]);
      }
      for (std::size_t c = body.first_cloud; c < body.first_cloud + body.cloud_count; ++c) {
        X_WL_of_cloud[c] = X_WL[static_cast<std::size_t>(body.link)];
        cloud_boxes[c] = box_around(owner->clouds[c]->box_L(), X_WL_of_cloud[c]);
        include(cloud_boxes[c]);
      }
      body_boxes[b] = {0.5 * (low + high), 0.5 * (high - low)};
    }
  }

  const Impl* owner;
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  std::vector<Eigen::Isometry3d> X_WG;  // By piece.
  std::vector<FclBox> boxes;
  std::vector<Eigen::Isometry3d> X_WL_of_cloud;
  std::vector<FclBox> cloud_boxes;
  std::vector<FclBox> body_boxes;
  std::size_t last_hit = 0;  // Positions in a selection: where the next query begins.
  std::size_t last_nearest = 0;
};

FclChecker::Impl::Scratch& FclChecker::Impl::place(const Eigen::Ref<const Eigen::VectorXd>& q,
                                                   CollisionChecker::Scratch& scratch) const {
  auto* own = dynamic_cast<Scratch*>(&scratch);
  expects(own && own->owner == this, "the scratch was made by this checker");
  expects(q.allFinite(), "q is finite");
  own->place(q, false);
  return *own;
}

/// Replaces `best` by the clearance of pair `index` if that is less.
bool FclChecker::Impl::improve(int index, const Scratch& scratch, PairClearance& best) const {
  const world::BodyPair& p = pair(index);
  const auto a = static_cast<std::size_t>(p.a), b = static_cast<std::size_t>(p.b);
  if (distance(scratch.body_boxes[a], scratch.body_boxes[b]) >= best.distance) return false;
  bool improved = false;
  for (std::size_t i = bodies[a].first_piece; i < bodies[a].first_piece + bodies[a].piece_count;
       ++i) {
    const Placed piece_a{pieces[i], scratch.X_WG[i], scratch.boxes[i]};
    for (std::size_t j = bodies[b].first_piece; j < bodies[b].first_piece + bodies[b].piece_count;
         ++j) {
      const Placed piece_b{pieces[j], scratch.X_WG[j], scratch.boxes[j]};
      improved = improve(index, piece_a, piece_b, best) || improved;
    }
  }
  return improve_with_clouds(index, scratch, best) || improved;
}

/// The same by two pieces alone.
bool FclChecker::Impl::improve(int index, const Placed& a, const Placed& b, PairClearance& best) {
  const double at_least = distance(a.box, b.box);
  if (at_least >= best.distance) return false;
  const double radii = a.piece.radius + b.piece.radius;
  const auto core_distance =
      a.piece.is_mesh() || b.piece.is_mesh() ? surface_distance : solid_distance;
  const CoreDistance core = core_distance(a.piece, a.X_WG, b.piece, b.X_WG, best.distance + radii);
  if (!(core.distance - radii < best.distance)) return false;
  // FCL's estimates of depth may be deeper than the boxes overlap.
  best = {index, std::max(core.distance - radii, at_least), core.nhat_BA_W,
          core.p_Wa - a.piece.radius * core.nhat_BA_W, core.p_Wb + b.piece.radius * core.nhat_BA_W};
  return true;
}

/// The same by the clouds of either body and everything of the other.
bool FclChecker::Impl::improve_with_clouds(int index, const Scratch& scratch,
                                           PairClearance& best) const {
  const world::BodyPair& p = pair(index);
  bool improved = false;
  for (const bool cloud_is_a : {true, false}) {
    const Body& owner = bodies[static_cast<std::size_t>(cloud_is_a ? p.a : p.b)];
    const Body& other = bodies[static_cast<std::size_t>(cloud_is_a ? p.b : p.a)];
    for (std::size_t c = owner.first_cloud; c < owner.first_cloud + owner.cloud_count; ++c) {
      for (std::size_t i = other.first_piece; i < other.first_piece + other.piece_count; ++i) {
        const Placed piece{pieces[i], scratch.X_WG[i], scratch.boxes[i]};
        improved = improve_with_cloud(index, piece, c, cloud_is_a, scratch, best) || improved;
      }
      if (!cloud_is_a) continue;  // Clouds with clouds once.
      for (std::size_t o = other.first_cloud; o < other.first_cloud + other.cloud_count; ++o) {
        if (distance(scratch.cloud_boxes[c], scratch.cloud_boxes[o]) >= best.distance) continue;
        for (const auto& ball_L : clouds[o]->balls_L()) {
          const Eigen::Isometry3d X_WG = scratch.X_WL_of_cloud[o] * ball_L->getTransform();
          const FclPiece& point = clouds[o]->point();
          const Placed piece{point, X_WG, box_around(point, X_WG)};
          improved = improve_with_cloud(index, piece, c, true, scratch, best) || improved;
        }
      }
    }
  }
  return improved;
}

bool FclChecker::Impl::improve_with_cloud(int index, const Placed& other, std::size_t cloud,
                                          bool cloud_is_a, const Scratch& scratch,
                                          PairClearance& best) const {
  if (distance(other.box, scratch.cloud_boxes[cloud]) >= best.distance) return false;
  const Eigen::Isometry3d& X_WL = scratch.X_WL_of_cloud[cloud];
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = other.box.center;
  const FclPiece& point = clouds[cloud]->point();
  bool improved = false;
  clouds[cloud]->visit_near(
      X_WL.inverse() * X_WB, other.box.half, best.distance, [&](const Eigen::Isometry3d& X_LG) {
        const Eigen::Isometry3d X_WG = X_WL * X_LG;
        const Placed ball{point, X_WG, box_around(point, X_WG)};
        improved =
            (cloud_is_a ? improve(index, ball, other, best) : improve(index, other, ball, best)) ||
            improved;
        return best.distance;
      });
  return improved;
}

Result<std::unique_ptr<FclChecker>> FclChecker::make(std::shared_ptr<const world::Workcell> cell,
                                                     FclGeometry geometry) {
  expects(cell != nullptr, "a checker needs a cell");
  auto impl = std::make_unique<Impl>();
  FclMeshes meshes;
  for (const world::Body& body : cell->bodies()) {
    auto made = make_pieces(*cell, body, geometry, meshes);
    if (!made) return std::unexpected(made.error());
    impl->bodies.push_back({body.link, body.moved_by != 0, impl->pieces.size(), made->pieces.size(),
                            impl->clouds.size(), made->clouds.size()});
    std::ranges::move(made->pieces, std::back_inserter(impl->pieces));
    std::ranges::move(made->clouds, std::back_inserter(impl->clouds));
  }
  impl->cell = std::move(cell);
  return std::unique_ptr<FclChecker>(new FclChecker(std::move(impl)));
}

FclChecker::FclChecker(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FclChecker::~FclChecker() = default;

const world::Workcell& FclChecker::cell() const { return *impl_->cell; }

std::unique_ptr<CollisionChecker::Scratch> FclChecker::make_scratch() const {
  return std::make_unique<Impl::Scratch>(*impl_);
}

bool FclChecker::is_free(const Eigen::Ref<const Eigen::VectorXd>& q,
                         const world::PairSelection& selection,
                         CollisionChecker::Scratch& scratch) const {
  Impl::Scratch& own = impl_->place(q, scratch);
  const auto touches = [&](std::size_t i) {
    PairClearance nearest;
    nearest.distance = 1e-9;  // Above rounding: touching is not free.
    if (!impl_->improve(selection[i], own, nearest) || nearest.distance > 0) return false;
    own.last_hit = i;
    return true;
  };
  if (own.last_hit < selection.size() && touches(own.last_hit)) return false;
  for (std::size_t i = 0; i < selection.size(); ++i) {
    if (touches(i)) return false;
  }
  return true;
}

PairClearance FclChecker::least_clearance(const Eigen::Ref<const Eigen::VectorXd>& q,
                                          const world::PairSelection& selection,
                                          CollisionChecker::Scratch& scratch) const {
  Impl::Scratch& own = impl_->place(q, scratch);
  PairClearance best;
  best.distance = kInfinity;
  // On a motion the nearest pair is mostly that of the instant before.
  const std::size_t first = own.last_nearest;
  if (first < selection.size()) impl_->improve(selection[first], own, best);
  for (std::size_t i = 0; i < selection.size(); ++i) {
    if (i != first && impl_->improve(selection[i], own, best)) own.last_nearest = i;
  }
  return best;
}

void FclChecker::clearances(const Eigen::Ref<const Eigen::VectorXd>& q,
                            const world::PairSelection& selection, double within,
                            CollisionChecker::Scratch& scratch,
                            std::vector<PairClearance>& out) const {
  Impl::Scratch& own = impl_->place(q, scratch);
  out.clear();
  for (const int pair : selection) {
    PairClearance nearest;
    nearest.distance = within;
    if (impl_->improve(pair, own, nearest)) out.push_back(nearest);
  }
}

}  // namespace tandem::collision
