#pragma once
/// Objects that change hands between motions: what a query attaches and detaches, and where the
/// objects are then.

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tandem::world {

/// The link that carries what stands still.
inline constexpr const char* kWorldLink = "world";

/// Bodies that may touch, by body name: "left/panda_link5", an obstacle or an attached object.
struct AllowedPair {
  std::string a, b;
  std::string reason;
  std::string where = {};
};

/// A link takes an object that nothing carries. The object may touch what moves rigidly with the
/// link (the hand, and fingers that no arm moves) and the bodies in `touching`.
struct Attach {
  std::string object;     ///< An obstacle, or an attached object that was let go.
  std::string arm = {};   ///< The tip of this arm takes it, or
  std::string link = {};  ///< this link does: a cell name, "left/panda_hand".
  /// Pose of the object in the arm's tool frame E (with `arm`) or in L; none: where it is.
  std::optional<Eigen::Isometry3d> pose = {};
  std::vector<std::string> touching = {};  ///< As long as it is carried.
  std::string where = {};
};

/// What is carried is let go.
struct Detach {
  std::string object;
  std::optional<Eigen::Isometry3d> X_WO = {};  ///< Where it comes to rest; none: where it is.
  std::string where = {};
};

/// What happens before a motion, with the arms at its start: first `detach`, then `attach`.
struct SceneChanges {
  std::vector<Detach> detach = {};
  std::vector<Attach> attach = {};
  std::vector<AllowedPair> allowed = {};  ///< During this motion only.
  bool empty() const { return detach.empty() && attach.empty() && allowed.empty(); }
};

/// Where an object is, and what carries it.
struct ObjectState {
  std::string link = kWorldLink;  ///< Cell name; the world's if nothing carries it.
  Eigen::Isometry3d X_LO = Eigen::Isometry3d::Identity();
  std::vector<std::string> touching = {};  ///< Bodies it may touch besides.
  std::string where = {};
  bool carried() const { return link != kWorldLink; }
};

/// What distinguishes the cell during one motion from the cell of its file.
struct SceneState {
  std::map<std::string, ObjectState> objects = {};  ///< Those that are not where the file has them.
  std::vector<AllowedPair> allowed = {};            ///< During this motion only.
};

}  // namespace tandem::world
