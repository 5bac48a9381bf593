#include "tandem/io/moveit_scene.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>

#include "tandem/io/text_file.h"

namespace tandem::io {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::Shape;
using world::ObstacleSpec;

constexpr std::size_t kMostBytes = std::size_t{256} << 20;
constexpr std::size_t kMostEntries = 10'000'000;  // Of any list.

/// A refusal on its way to the reading function.
struct BadScene {
  Error error;
};

/// Words and lines of the file, and where they stand.
class Words {
 public:
  Words(const std::string& text, const std::string& origin) : text_(text), origin_(origin) {}

  [[noreturn]] void refuse(std::size_t at, const std::string& message,
                           ErrorCode code = ErrorCode::kInvalidInput) const {
    throw BadScene{{code, place_in(origin_, text_, at) + ": " + message}};
  }
  /// Where the last word began.
  std::size_t last() const { return last_; }
  [[noreturn]] void refuse_last(const std::string& message,
                                ErrorCode code = ErrorCode::kInvalidInput) const {
    refuse(last_, message, code);
  }

  /// What is left of the line, without spaces around it.
  std::string_view rest_of_line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line(text_.data() + at_, end - at_);
    last_ = at_;
    at_ = std::min(end + 1, text_.size());
    const std::size_t first = line.find_first_not_of(kSpace);
    if (first == std::string_view::npos) return {};
    last_ += first;
    return line.substr(first, line.find_last_not_of(kSpace) + 1 - first);
  }
  std::string_view word(const char* expected) {
    at_ = text_.find_first_not_of(kSpace, at_);
    if (at_ == std::string::npos) {
      at_ = text_.size();
      refuse(at_, std::string("the file ends before ") + expected + "; is it whole?");
    }
    last_ = at_;
    at_ = std::min(text_.find_first_of(kSpace, at_), text_.size());
    return std::string_view(text_).substr(last_, at_ - last_);
  }
  double number(const char* what) {
    const std::string_view text = word(what);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      refuse_last(std::string(what) + " is " + quoted(text) + ", expected a finite number");
    }
    return value;
  }
  Vector3d vector(const char* what) {
    Vector3d v;
    for (double& x : v) x = number(what);
    return v;
  }
  /// A count of entries that take at least `bytes` of text each, so that a short file cannot ask
  /// for much memory.
  std::size_t count(const char* what, std::size_t bytes) {
    const std::string_view text = word(what);
    std::size_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value > kMostEntries) {
      refuse_last(std::string(what) + " is " + quoted(text) +
                  ", expected a whole number from 0 to " + std::to_string(kMostEntries));
    }
    if (value * bytes > text_.size() - at_) {
      refuse_last(std::string(what) + " is " + std::to_string(value) +
                  ", more than the rest of the file holds; is it whole?");
    }
    return value;
  }
  /// Whether the next line that is not empty has several words; nothing is read.
  bool line_has_several_words() const {
    const std::size_t first = text_.find_first_not_of(kSpace, at_);
    if (first == std::string::npos) return false;
    const std::size_t end = std::min(text_.find('\n', first), text_.size());
    const std::string_view line(text_.data() + first, end - first);
    const std::size_t space = line.find_first_of(kSpace);
    return space != std::string_view::npos &&
           line.find_first_not_of(kSpace, space) != std::string_view::npos;
  }

  static std::string quoted(std::string_view text) {
    constexpr std::size_t kMost = 40;
    std::string quoted(1, '\'');
    quoted.append(text.substr(0, kMost)).append(text.size() > kMost ? "...'" : "'");
    return quoted;
  }

 private:
  static constexpr const char* kSpace = " \t\r\n\v\f";

  const std::string& text_;
  const std::string& origin_;
  std::size_t at_ = 0, last_ = 0;
};

struct Triangles {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

Triangles read_mesh(Words& words) {
  constexpr std::size_t kTriple = 6;  // "0 0 0\n"
  Triangles mesh;
  const std::size_t vertices = words.count("the number of vertices", kTriple);
  const std::size_t triangles = words.count("the number of triangles", kTriple);
  mesh.vertices.reserve(vertices);
  mesh.triangles.reserve(triangles);
  for (std::size_t i = 0; i < vertices; ++i) mesh.vertices.push_back(words.vector("a vertex"));
  for (std::size_t i = 0; i < triangles; ++i) {
    std::array<int, 3>& triangle = mesh.triangles.emplace_back();
    for (int& corner : triangle) {
      const std::size_t index = words.count("an index into the vertices", 0);
      if (index >= vertices) {
        words.refuse_last("the triangle's corner " + std::to_string(index) +
                          " does not exist; the "
                          "mesh has " +
                          std::to_string(vertices) + " vertices, counted from 0");
      }
      corner = static_cast<int>(index);
    }
  }
  return mesh;
}

/// A pyramid around the cone with its tip on +z of C and Co half-way up.
Result<Shape> pyramid_around(const Isometry3d& X_WC, double radius, double length) {
  constexpr int kSides = 32;
  const double reach = radius / std::cos(std::numbers::pi / kSides);
  std::vector<Vector3d> corners{X_WC * Vector3d(0, 0, length / 2)};
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    corners.push_back(X_WC *
                      Vector3d(reach * std::cos(angle), reach * std::sin(angle), -length / 2));
  }
  return Shape::convex(corners);
}

/// Reads one file.
class SceneReader {
 public:
  SceneReader(const std::string& text, const std::string& origin)
      : words_(text, origin), text_(text), origin_(origin) {}

  MoveitScene read() {
    MoveitScene scene;
    scene.name = std::string(words_.rest_of_line());
    bool first = true;
    while (true) {
      const std::string_view marker = words_.word("an object ('* NAME') or the end ('.')");
      if (marker == ".") return scene;
      if (marker != "*") {
        words_.refuse_last(Words::quoted(marker) +
                           " stands where an object ('* NAME') or the end ('.') is expected");
      }
      const std::string name(words_.rest_of_line());
      const std::size_t at = words_.last();
      if (name.empty()) words_.refuse(at, "the object has no name; write '* NAME'");
      if (std::ranges::find(scene.obstacles, name, &ObstacleSpec::name) != scene.obstacles.end()) {
        words_.refuse(at, "there are two objects called '" + name + "'; rename one");
      }
      // As in MoveIt, the first object decides for all: a pose has several words, a count one.
      if (first) has_poses_ = words_.line_has_several_words();
      first = false;
      ObstacleSpec obstacle = read_object(name, at);
      if (!obstacle.shapes_W.empty() || !obstacle.surfaces_W.empty()) {
        scene.obstacles.push_back(std::move(obstacle));
      }
    }
  }

 private:
  Isometry3d read_pose() {
    constexpr double kUnitTolerance = 1e-3;
    Isometry3d X = Isometry3d::Identity();
    X.translation() = words_.vector("a position");
    Eigen::Vector4d q;
    for (double& x : q) x = words_.number("a quaternion (x, y, z, w)");
    if (!(std::abs(q.norm() - 1) <= kUnitTolerance)) {
      words_.refuse_last("the quaternion that ends here has length " + std::to_string(q.norm()) +
                         ", it must be 1");
    }
    X.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
    return X;
  }

  ObstacleSpec read_object(const std::string& name, std::size_t at) {
    constexpr std::size_t kShape = 30, kSubframe = 16;  // Bytes of the shortest.
    ObstacleSpec obstacle{name, {}, place_in(origin_, text_, at)};
    const Isometry3d X_WO = has_poses_ ? read_pose() : Isometry3d::Identity();
    const std::size_t shapes = words_.count("the number of shapes", kShape);
    for (std::size_t i = 0; i < shapes; ++i) read_shape(X_WO, obstacle);
    if (!has_poses_) return obstacle;
    const std::size_t subframes = words_.count("the number of subframes", kSubframe);
    for (std::size_t i = 0; i < subframes; ++i) {
      words_.word("the name of a subframe");
      read_pose();
    }
    return obstacle;
  }

  /// What a shape's sizes say; it becomes geometry once its pose is known.
  using Place = std::function<Result<void>(const Isometry3d& X_WS, ObstacleSpec& obstacle)>;

  void read_shape(const Isometry3d& X_WO, ObstacleSpec& obstacle) {
    const std::string kind(words_.word("a shape"));
    const std::size_t at = words_.last();
    const Place place = read_sizes(kind);
    const Isometry3d X_WS = X_WO * read_pose();
    for (int i = 0; i < 4; ++i) words_.number("a colour (r, g, b, a)");
    if (const auto placed = place(X_WS, obstacle); !placed) {
      words_.refuse(at, kind + ": " + placed.error().message, placed.error().code);
    }
  }

  Place read_sizes(const std::string& kind) {
    const auto size = [this] { return words_.number("a size"); };
    if (kind == "sphere") {
      return shape([r = size()](const Isometry3d& X) { return Shape::sphere(X.translation(), r); });
    }
    if (kind == "box") {
      return shape(
          [edges = words_.vector("a size")](const Isometry3d& X) { return Shape::box(X, edges); });
    }
    if (kind == "mesh") return surface(read_mesh(words_));
    if (kind != "cylinder" && kind != "cone") {
      words_.refuse_last(std::string("the shape ") + Words::quoted(kind) +
                             " is not supported; known are sphere, box, cylinder, cone and mesh "
                             "(replace a plane by a box)",
                         ErrorCode::kUnsupported);
    }
    const double radius = size();
    if (!(radius > 0)) words_.refuse_last("the radius must be above 0");
    const double length = size();
    if (!(length > 0)) words_.refuse_last("the length must be above 0");
    if (kind == "cone") {
      return shape([=](const Isometry3d& X) { return pyramid_around(X, radius, length); });
    }
    return shape([=](const Isometry3d& X) { return Shape::cylinder(X, radius, length); });
  }

  template <class Make>
  static Place shape(Make make) {
    return [make](const Isometry3d& X_WS, ObstacleSpec& obstacle) -> Result<void> {
      Result<Shape> made = make(X_WS);
      if (!made) return std::unexpected(made.error());
      obstacle.shapes_W.push_back(std::move(*made));
      return {};
    };
  }
  static Place surface(Triangles mesh) {
    return [mesh = std::move(mesh)](const Isometry3d& X_WS,
                                    ObstacleSpec& obstacle) mutable -> Result<void> {
      auto made = geometry::Surface::mesh(std::move(mesh.vertices), std::move(mesh.triangles));
      if (!made) return std::unexpected(made.error());
      obstacle.surfaces_W.push_back({std::move(*made), X_WS});
      return {};
    };
  }

  Words words_;
  const std::string& text_;
  const std::string& origin_;
  bool has_poses_ = false;  ///< The new format.
};

}  // namespace

Result<MoveitScene> parse_moveit_scene(const std::string& text, const std::string& origin) {
  try {
    return SceneReader(text, origin).read();
  } catch (const BadScene& bad) {
    return std::unexpected(bad.error);
  }
}

Result<MoveitScene> load_moveit_scene(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, kMostBytes);
  if (!text) return std::unexpected(text.error());
  return parse_moveit_scene(*text, file.string());
}

}  // namespace tandem::io
