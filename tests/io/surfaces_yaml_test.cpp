// Meshes, hulls and clouds in workcell files, and robot links made of meshes.

#include <numbers>

#include "tandem/io/workcell_yaml.h"
#include "tandem/robot/urdf.h"
#include "workcell_files.h"

namespace tandem::io {
namespace {

using Eigen::Vector3d;
using test::TemporaryFolder;
using world::Workcell;

/// A closed tetrahedron with corners at the origin and at `size` on every axis.
std::string tetrahedron_obj(double size) {
  const std::string s = std::to_string(size);
  return "v 0 0 0\nv " + s + " 0 0\nv 0 " + s + " 0\nv 0 0 " + s +
         "\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

const char* const kCloud = "0 0 0\n0.1 0 0\n0.2 0 nan\n0.1 0.2 0.3\n";

/// A cell of one small robot with `obstacles` and robot keys `robot`.
class SurfaceCell : public ::testing::Test {
 protected:
  SurfaceCell() {
    folder_.write("arm.urdf", urdf("<sphere radius='0.1'/>"));
    folder_.write("tetra.obj", tetrahedron_obj(1));
    folder_.write("scan.xyz", kCloud);
    folder_.write("packages/parts/meshes/tetra.obj", tetrahedron_obj(1));
  }

  static std::string urdf(const std::string& hand) {
    return "<robot name='r'><link name='base'><collision><geometry><sphere radius='0.1'/>"
           "</geometry></collision></link><link name='hand'><collision><origin xyz='0 0 0.5'/>"
           "<geometry>" +
           hand +
           "</geometry></collision></link><joint name='j' type='revolute'><parent link='base'/>"
           "<child link='hand'/><origin xyz='3 0 0'/><limit lower='-1' upper='1' velocity='1'/>"
           "</joint></robot>";
  }

  Result<std::shared_ptr<const Workcell>> load(const std::string& more,
                                               const std::string& robot = "") {
    return load_workcell(folder_.write(
        "cell.yaml",
        "name: c\npackages: [packages]\nrobots: [{name: r, urdf: arm.urdf, limits: {j: "
        "{acceleration: 1}}" +
            robot +
            "}]\narms: [{name: a, robot: r, base: base, tip: hand, tool: {xyz: [0, 0, 1]}}]\n" +
            more));
  }

  Result<std::shared_ptr<const Workcell>> obstacle(const std::string& geometry) {
    return load("obstacles:\n  - {name: thing, " + geometry + "}\n");
  }

  const world::Body& body(const Workcell& cell, const char* name) const {
    const int index = cell.find_body(name);
    EXPECT_GE(index, 0) << name;
    return cell.bodies()[static_cast<std::size_t>(std::max(index, 0))];
  }

  void expect_refused(const Result<std::shared_ptr<const Workcell>>& loaded, ErrorCode code,
                      const std::vector<std::string>& says) {
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().code, code) << loaded.error().message;
    for (const std::string& said : says) {
      EXPECT_NE(loaded.error().message.find(said), std::string::npos)
          << "'" << said << "' is not in: " << loaded.error().message;
    }
  }

  TemporaryFolder folder_;
};

TEST_F(SurfaceCell, MeshesAreScaledMirroredAndPlaced) {
  const auto loaded = obstacle(
      "mesh: {file: tetra.obj, scale: [0.1, -0.2, 0.3], radius: 0.01, xyz: [1, 2, 3], "
      "rpy_deg: [0, 0, 90]}, pose: {xyz: [10, 0, 0]}");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const world::Body& thing = body(**loaded, "thing");
  EXPECT_TRUE(thing.shapes_L.empty());
  ASSERT_EQ(thing.surfaces_L.size(), 1u);
  const geometry::PlacedSurface& placed = thing.surfaces_L[0];
  EXPECT_EQ(placed.surface->triangles().size(), 4u);
  EXPECT_EQ(placed.surface->radius(), 0.01);
  Vector3d low = Vector3d::Constant(9), high = Vector3d::Constant(-9);
  for (const Vector3d& v : placed.surface->vertices()) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  EXPECT_TRUE(low.isApprox(Vector3d(0, -0.2, 0), 1e-6)) << low.transpose();
  EXPECT_TRUE(high.isApprox(Vector3d(0.1, 0, 0.3), 1e-6)) << high.transpose();
  EXPECT_TRUE((placed.X_FS * Vector3d(1, 0, 0)).isApprox(Vector3d(11, 3, 3), 1e-12));
}

TEST_F(SurfaceCell, HullsComeFromFilesAndPoints) {
  const auto loaded = obstacle(
      "shapes: [{convex: {file: tetra.obj, scale: 0.5, radius: 0.02, xyz: [1, 0, 0]}}, {convex: "
      "{points: [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]]}}]");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const world::Body& thing = body(**loaded, "thing");
  ASSERT_EQ(thing.shapes_L.size(), 2u);
  EXPECT_TRUE(thing.surfaces_L.empty());
  EXPECT_EQ(thing.shapes_L[0].radius(), 0.02);
  EXPECT_TRUE(thing.shapes_L[0].support({1, 0, 0}).isApprox(Vector3d(1.5, 0, 0), 1e-9));
  EXPECT_NEAR(thing.shapes_L[1].support({0, 0, 1}).z(), 1, 1e-9);
  EXPECT_NEAR(thing.shapes_L[1].volume(), 1.0 / 6, 1e-9);
}

TEST_F(SurfaceCell, CloudsKeepTheirFinitePoints) {
  const auto loaded = obstacle("cloud: {file: scan.xyz, radius: 0.03, xyz: [0, 0, 1]}");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto& placed = body(**loaded, "thing").surfaces_L.at(0);
  EXPECT_FALSE(placed.surface->is_mesh());
  ASSERT_EQ(placed.surface->vertices().size(), 3u);
  EXPECT_EQ(placed.surface->radius(), 0.03);
  EXPECT_TRUE((placed.X_FS * placed.surface->vertices()[2]).isApprox(Vector3d(0.1, 0.2, 1.3)));
}

TEST_F(SurfaceCell, AttachedSurfacesStandInTheToolFrame) {
  const auto loaded = load(
      "attached:\n  - {name: part, arm: a, mesh: {file: tetra.obj, xyz: [0.5, 0, 0]}}\n"
      "  - {name: tag, link: r/hand, cloud: {file: scan.xyz, radius: 0.01}}\n");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(
      body(**loaded, "part").surfaces_L.at(0).X_FS.translation().isApprox(Vector3d(0.5, 0, 1)));
  EXPECT_TRUE(body(**loaded, "tag").surfaces_L.at(0).X_FS.translation().isZero());
}

TEST_F(SurfaceCell, LinksWithoutVolumesUseTheirMeshes) {
  folder_.write("arm.urdf", urdf("<mesh filename='package://parts/meshes/tetra.obj' "
                                 "scale='2 2 2'/>"));
  const auto exact = load("");
  ASSERT_TRUE(exact) << exact.error().message;
  const world::Body& mesh = body(**exact, "r/hand");
  EXPECT_TRUE(mesh.shapes_L.empty());
  ASSERT_EQ(mesh.surfaces_L.size(), 1u);
  EXPECT_TRUE(mesh.surfaces_L[0].X_FS.translation().isApprox(Vector3d(0, 0, 0.5)));
  EXPECT_EQ(body(**exact, "r/base").shapes_L.size(), 1u);

  const auto convex = load("", ", meshes: convex");
  ASSERT_TRUE(convex) << convex.error().message;
  const world::Body& hull = body(**convex, "r/hand");
  EXPECT_TRUE(hull.surfaces_L.empty());
  ASSERT_EQ(hull.shapes_L.size(), 1u);
  EXPECT_NEAR(hull.shapes_L[0].volume(), 8.0 / 6, 1e-9);
  // The hull contains the mesh.
  for (const Vector3d& p_S : mesh.surfaces_L[0].surface->vertices()) {
    const Vector3d p_L = mesh.surfaces_L[0].X_FS * p_S;
    for (int k = 0; k < 6; ++k) {
      const Vector3d n = Vector3d::Unit(k % 3) * (k < 3 ? 1 : -1);
      EXPECT_LE(n.dot(p_L), n.dot(hull.shapes_L[0].support(n)) + 1e-9);
    }
  }

  folder_.write("v.yaml", "links: {hand: [{sphere: {center: [0, 0, 0], radius: 3}}]}");
  const auto volumes = load("", ", volumes: v.yaml");
  ASSERT_TRUE(volumes) << volumes.error().message;
  EXPECT_TRUE(body(**volumes, "r/hand").surfaces_L.empty());
  EXPECT_EQ(body(**volumes, "r/hand").shapes_L.size(), 1u);
}

TEST_F(SurfaceCell, OneFileIsReadOnce) {
  folder_.write("arm.urdf", urdf("<mesh filename='tetra.obj'/></geometry></collision><collision>"
                                 "<geometry><mesh filename='tetra.obj'/>"));
  const auto loaded = load("");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto& surfaces = body(**loaded, "r/hand").surfaces_L;
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_EQ(surfaces[0].surface, surfaces[1].surface);
}

TEST_F(SurfaceCell, LinkMeshesThatFailAreNamed) {
  const ErrorCode absent = ErrorCode::kNotFound;
  folder_.write("arm.urdf", urdf("<mesh filename='package://part/meshes/tetra.obj'/>"));
  expect_refused(load(""), absent,
                 {"cell.yaml:3:10: ", "link 'hand' of robot 'r'", "package://part/meshes/tetra.obj",
                  (folder_ / "packages").string(), "`packages:`", "--package-path", "`volumes:`"});
  folder_.write("arm.urdf", urdf("<mesh filename='tetrahedron.obj'/>"));
  expect_refused(load(""), absent, {"link 'hand'", "tetrahedron.obj", "no file"});
  folder_.write("arm.urdf", urdf("<mesh filename='bad.obj'/>"));
  folder_.write("bad.obj", "nothing");
  expect_refused(load(""), ErrorCode::kInvalidInput, {"link 'hand'", "bad.obj", "`volumes:`"});
  expect_refused(load("", ", meshes: hull"), ErrorCode::kInvalidInput,
                 {"cell.yaml:3:", "meshes is 'hull'", "triangles"});
}

TEST_F(SurfaceCell, MalformedPiecesAreRefusedWithPlaceAndRemedy) {
  const ErrorCode invalid = ErrorCode::kInvalidInput, absent = ErrorCode::kNotFound;
  struct Case {
    std::string geometry;
    ErrorCode code;
    std::vector<std::string> says;
  };
  const Case cases[] = {
      {"mesh: {}", invalid, {"cell.yaml:6:25: ", "'file' is missing"}},
      {"mesh: {file: tetr.obj}", absent, {"cell.yaml:6:32: ", "tetr.obj"}},
      {"mesh: {file: .}", invalid, {"a folder, not a file"}},
      {"mesh: {file: package://parts/none.obj}", absent, {"none.obj", "packages"}},
      {"mesh: {file: http://parts/none.obj}", ErrorCode::kUnsupported, {"package://"}},
      {"mesh: {file: scan.xyz}", invalid, {"cell.yaml:6:32: ", "scan.xyz"}},
      {"mesh: {file: tetra.obj, scale: 0}", invalid, {"scale", "may be 0"}},
      {"mesh: {file: tetra.obj, scale: [1, 0, 1]}", invalid, {"may be 0"}},
      {"mesh: {file: tetra.obj, scale: [1, 1]}", invalid, {"scale has 2 numbers"}},
      {"mesh: {file: tetra.obj, scale: nan}", invalid, {"'nan'", "finite"}},
      {"mesh: {file: tetra.obj, radius: -1}", invalid, {"radius is -1", "negative"}},
      {"mesh: {file: tetra.obj, radus: 1}", invalid, {"'radus'", "mean 'radius'"}},
      {"mash: {file: tetra.obj}", invalid, {"'mash'", "mean 'mesh'"}},
      {"mesh: {file: tetra.obj}, cloud: {file: scan.xyz, radius: 1}", invalid, {"keep one"}},
      {"cloud: {file: scan.xyz}", invalid, {"'radius' is missing"}},
      {"cloud: {file: scan.xyz, radius: 0}", invalid, {"radius is 0", "above 0"}},
      {"cloud: {file: scan.xyz, radius: 1, scale: 1}", invalid, {"'scale'"}},
      {"convex: {}", invalid, {"needed: file, points"}},
      {"convex: {file: tetra.obj, points: []}", invalid, {"both 'file' and 'points'"}},
      {"convex: {points: []}", invalid, {"cell.yaml:6:27: "}},
      {"convex: {points: [[0, 0]]}", invalid, {"points[0] has 2 numbers"}},
      {"convex: {points: [[0, 0, .inf]]}", invalid, {"'.inf'"}},
      {"mesh: {file: $TANDEM_TEST_UNSET/x.obj}", absent, {"TANDEM_TEST_UNSET", "export"}},
      {"mesh: {file: '${TANDEM_TEST_UNSET}/x.obj'}", absent, {"TANDEM_TEST_UNSET", "export"}},
      {"mesh: {file: '${TANDEM/x.obj'}", invalid, {"$NAME/PATH"}},
      {"mesh: {file: $/x.obj}", invalid, {"$NAME/PATH"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.geometry);
    expect_refused(obstacle(c.geometry), c.code, c.says);
  }
}

TEST_F(SurfaceCell, VolumesMayBeHullsButNoSurfaces) {
  const auto model = robot::load_urdf(folder_ / "arm.urdf");
  ASSERT_TRUE(model);
  const auto volumes = [&](const std::string& piece) {
    return load_volumes(folder_.write("v.yaml", "links: {hand: [{" + piece + "}]}"), *model);
  };
  const auto hull = volumes("convex: {file: tetra.obj}");
  ASSERT_TRUE(hull) << hull.error().message;
  EXPECT_NEAR(hull->at("hand").at(0).volume(), 1.0 / 6, 1e-9);
  for (const char* piece : {"mesh: {file: tetra.obj}", "cloud: {file: scan.xyz, radius: 1}"}) {
    const auto refused = volumes(piece);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("v.yaml:1:17: "), std::string::npos);
    EXPECT_NE(refused.error().message.find("no volume"), std::string::npos);
  }
}

TEST_F(SurfaceCell, PathsMayBeginWithAVariable) {
  ASSERT_EQ(setenv("TANDEM_TEST_FOLDER", (folder_ / "packages").c_str(), 1), 0);
  for (const char* file : {"$TANDEM_TEST_FOLDER/parts/meshes/tetra.obj",
                           "'${TANDEM_TEST_FOLDER}/parts/meshes/tetra.obj'"}) {
    const auto loaded = obstacle(std::string("mesh: {file: ") + file + "}");
    EXPECT_TRUE(loaded) << loaded.error().message;
  }
  unsetenv("TANDEM_TEST_FOLDER");
}

// In a shell, TANDEM_TEST_FOLDER=data means ./data, wherever the cell's file is.
TEST_F(SurfaceCell, RelativeVariablesAreRelativeToTheCurrentFolder) {
  folder_.write("run/elsewhere/other.obj", tetrahedron_obj(2));
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder_ / "run");
  ASSERT_EQ(setenv("TANDEM_TEST_FOLDER", "elsewhere", 1), 0);
  const auto below = obstacle("mesh: {file: $TANDEM_TEST_FOLDER/other.obj}");
  ASSERT_EQ(setenv("TANDEM_TEST_FOLDER", "../packages/parts", 1), 0);
  const auto beside = obstacle("mesh: {file: '${TANDEM_TEST_FOLDER}/meshes/tetra.obj'}");
  ASSERT_EQ(setenv("TANDEM_TEST_FOLDER", "packages", 1), 0);
  const auto missing = obstacle("mesh: {file: $TANDEM_TEST_FOLDER/parts/meshes/tetra.obj}");
  unsetenv("TANDEM_TEST_FOLDER");
  std::filesystem::current_path(before);
  EXPECT_TRUE(below) << below.error().message;
  EXPECT_TRUE(beside) << beside.error().message;
  ASSERT_FALSE(missing) << "that is relative to the cell's file";
  EXPECT_NE(missing.error().message.find((folder_ / "run/packages").string()), std::string::npos)
      << missing.error().message;
  EXPECT_NE(missing.error().message.find("current folder"), std::string::npos);
}

// The page that users read is the test's input: it cannot go stale.
TEST_F(SurfaceCell, DocumentedPiecesAreRead) {
  folder_.write("parts/housing.stl", "");
  folder_.write("data/curtain.obj", tetrahedron_obj(1));
  folder_.write("packages/cell_description/meshes/fixture.stl",
                "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                "0\nendloop\nendfacet\nendsolid s\n");
  std::string corners;
  const char* const tetrahedron[4][3] = {{"0 0 0", "0 9 0", "9 0 0"},
                                         {"0 0 0", "9 0 0", "0 0 9"},
                                         {"0 0 0", "0 0 9", "0 9 0"},
                                         {"9 0 0", "0 9 0", "0 0 9"}};
  for (const auto& facet : tetrahedron) {
    corners += "facet normal 0 0 1\nouter loop\n";
    for (const char* corner : facet) corners.append("vertex ").append(corner).append("\n");
    corners += "endloop\nendfacet\n";
  }
  folder_.write("parts/housing.stl", "solid s\n" + corners + "endsolid s\n");
  folder_.write("scans/bin.ply",
                "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                "property float z\nend_header\n0 0 0\n1 0 0\n");
  ASSERT_EQ(setenv("CELL_DATA", (folder_ / "data").c_str(), 1), 0);
  std::string block = test::documented_yaml().at(2);
  for (std::size_t at = 0; (at = block.find('\n', at)) + 1 < block.size();) {
    block.insert(++at, "    ");
  }
  const auto loaded = load("obstacles:\n  - name: thing\n    " + block);
  unsetenv("CELL_DATA");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(body(**loaded, "thing").shapes_L.size(), 2u);
  EXPECT_EQ(body(**loaded, "thing").surfaces_L.size(), 3u);
}

}  // namespace
}  // namespace tandem::io
