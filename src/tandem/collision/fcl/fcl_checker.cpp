#include "tandem/collision/fcl/fcl_checker.h"

#include "tandem/collision/fcl/fcl_geometry.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The pieces of a body that FCL shall see.
Result<std::vector<FclPiece>> make_pieces(const world::Workcell& cell, const world::Body& body,
                                          FclGeometry geometry, FclMeshes& meshes) {
  std::vector<FclPiece> pieces;
  if (geometry == FclGeometry::kVolumes || body.kind != world::Body::Kind::kRobotLink) {
    const double padding = geometry == FclGeometry::kVolumes ? body.padding : 0.0;
    for (const geometry::Shape& shape_L : body.shapes_L) {
      pieces.push_back(make_piece(shape_L.padded(padding)));
    }
    return pieces;
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
    pieces.push_back(std::move(*piece));
  }
  return pieces;
}

}  // namespace

struct FclChecker::Impl {
  class Scratch;

  struct Body {
    int link;
    bool moves;
    std::size_t first_piece, piece_count;
  };

  std::shared_ptr<const world::Workcell> cell;
  std::vector<Body> bodies;
  std::vector<FclPiece> pieces;

  const world::BodyPair& pair(int index) const {
    expects(0 <= index && index < static_cast<int>(cell->pairs().size()),
            "a selection holds indices into pairs()");
    return cell->pairs()[static_cast<std::size_t>(index)];
  }
  Scratch& place(const Eigen::Ref<const Eigen::VectorXd>& q,
                 CollisionChecker::Scratch& scratch) const;
  bool improve(int index, const Scratch& scratch, PairClearance& best) const;
};

class FclChecker::Impl::Scratch final : public CollisionChecker::Scratch {
 public:
  explicit Scratch(const Impl& impl)
      : owner(&impl),
        X_WG(impl.pieces.size()),
        boxes(impl.pieces.size()),
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
      for (std::size_t p = body.first_piece; p < body.first_piece + body.piece_count; ++p) {
        X_WG[p] = X_WL[static_cast<std::size_t>(body.link)] * owner->pieces[p].X_LG;
        boxes[p] = box_around(owner->pieces[p], X_WG[p]);
        low = low.cwiseMin(boxes[p].center - boxes[p].half);
        high = high.cwiseMax(boxes[p].center + boxes[p].half);
      }
      body_boxes[b] = {0.5 * (low + high), 0.5 * (high - low)};
    }
  }

  const Impl* owner;
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  std::vector<Eigen::Isometry3d> X_WG;  // By piece.
  std::vector<FclBox> boxes;
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
    for (std::size_t j = bodies[b].first_piece; j < bodies[b].first_piece + bodies[b].piece_count;
         ++j) {
      const double at_least = distance(scratch.boxes[i], scratch.boxes[j]);
      if (at_least >= best.distance) continue;
      const FclPiece &piece_a = pieces[i], &piece_b = pieces[j];
      const double radii = piece_a.radius + piece_b.radius;
      const auto core_distance =
          piece_a.is_mesh() || piece_b.is_mesh() ? surface_distance : solid_distance;
      const CoreDistance core =
          core_distance(piece_a, scratch.X_WG[i], piece_b, scratch.X_WG[j], best.distance + radii);
      if (!(core.distance - radii < best.distance)) continue;
      // FCL's estimates of depth may be deeper than the boxes overlap.
      best = {index, std::max(core.distance - radii, at_least), core.nhat_BA_W,
              core.p_Wa - piece_a.radius * core.nhat_BA_W,
              core.p_Wb + piece_b.radius * core.nhat_BA_W};
      improved = true;
    }
  }
  return improved;
}

Result<std::unique_ptr<FclChecker>> FclChecker::make(std::shared_ptr<const world::Workcell> cell,
                                                     FclGeometry geometry) {
  expects(cell != nullptr, "a checker needs a cell");
  auto impl = std::make_unique<Impl>();
  FclMeshes meshes;
  for (const world::Body& body : cell->bodies()) {
    auto pieces = make_pieces(*cell, body, geometry, meshes);
    if (!pieces) return std::unexpected(pieces.error());
    impl->bodies.push_back({body.link, body.moved_by != 0, impl->pieces.size(), pieces->size()});
    impl->pieces.insert(impl->pieces.end(), pieces->begin(), pieces->end());
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
