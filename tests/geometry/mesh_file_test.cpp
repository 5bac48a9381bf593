#include "tandem/geometry/mesh_file.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "random_shapes.h"
#include "temporary_folder.h"
#include "test_data.h"

namespace tandem::geometry {
namespace {

using Eigen::Vector3d;

/// The bytes of values, least first or last.
template <class Value>
std::string bytes_of(Value value, bool big_endian = false) {
  std::string bytes(sizeof(Value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Value));
  if (big_endian) std::ranges::reverse(bytes);
  return bytes;
}

const std::vector<Vector3d> kCorners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<std::array<int, 3>> kFaces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

std::string stl(std::uint32_t count) {
  std::string bytes(80, ' ');
  bytes += bytes_of(count);
  for (const auto& face : kFaces) {
    bytes.append(12, '\0');
    for (const int i : face) {
      for (const double x : kCorners[static_cast<std::size_t>(i)]) bytes += bytes_of(float(x));
    }
    bytes.append(2, '\0');
  }
  return bytes;
}

std::string text_stl() {
  std::ostringstream out;
  out << "solid tetrahedron\n";
  for (const auto& face : kFaces) {
    out << " facet normal 0 0 0\n  outer loop\n";
    for (const int i : face) {
      out << "   vertex " << kCorners[static_cast<std::size_t>(i)].transpose() << "\n";
    }
    out << "  endloop\n endfacet\n";
  }
  out << "endsolid tetrahedron\n";
  return out.str();
}

std::string obj() {
  std::ostringstream out;
  out << "mtllib gone.mtl\no tetrahedron\n";
  for (const Vector3d& p : kCorners) out << "v " << p.transpose() << "\n";
  for (const auto& [i, j, k] : kFaces) out << "f " << i + 1 << " " << j + 1 << " " << k + 1 << "\n";
  return out.str();
}

std::string ply_header(const std::string& format, std::uint64_t vertices, std::uint64_t faces) {
  return "ply\nformat " + format + " 1.0\ncomment of no use\nelement vertex " +
         std::to_string(vertices) +
         "\nproperty uchar red\nproperty double x\nproperty float y\nproperty float z\n"
         "element face " +
         std::to_string(faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string text_ply() {
  std::ostringstream out;
  out << ply_header("ascii", 4, 4);
  for (const Vector3d& p : kCorners) out << "255 " << p.transpose() << "\n";
  for (const auto& [i, j, k] : kFaces) out << "3 " << i << " " << j << " " << k << "\n";
  return out.str();
}

std::string binary_ply(bool big) {
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian", 4, 4);
  for (const Vector3d& p : kCorners) {
    out +=
        '\xff' + bytes_of(p.x(), big) + bytes_of(float(p.y()), big) + bytes_of(float(p.z()), big);
  }
  for (const auto& face : kFaces) {
    out += '\3';
    for (const std::int32_t i : face) out += bytes_of(i, big);
  }
  return out;
}

std::string collada(const std::string& nodes) {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles></mesh></geometry></library_geometries>
)" + nodes +
         R"(<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

const std::string kScene =
    R"(<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes>)";

/// Valid files of every kind, all of the same tetrahedron.
std::vector<std::pair<std::string, std::string>> tetrahedra() {
  return {{"a.stl", stl(4)},         {"b.STL", text_stl()},    {"c.obj", obj()},
          {"d.ply", text_ply()},     {"e.ply", binary_ply(0)}, {"f.ply", binary_ply(1)},
          {"g.dae", collada(kScene)}};
}

double signed_volume(const TriangleMesh& mesh) {
  double six = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
    six += at(i).dot(at(j).cross(at(k)));
  }
  return six / 6;
}

void expect_refused(const std::filesystem::path& file, const std::vector<std::string>& parts) {
  const auto mesh = read_mesh(file);
  ASSERT_FALSE(mesh) << file;
  EXPECT_NE(mesh.error().message.find(file.string()), std::string::npos) << mesh.error().message;
  for (const std::string& part : parts) {
    EXPECT_NE(mesh.error().message.find(part), std::string::npos) << mesh.error().message;
  }
}

TEST(ReadMesh, ReadsEveryKindAlike) {
  const test::TemporaryFolder folder;
  for (const auto& [name, bytes] : tetrahedra()) {
    const auto mesh = read_mesh(folder.write(name, bytes), Vector3d(2, 1, 0.5));
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->vertices.size(), 4u) << name;  // Equal vertices are joined.
    EXPECT_EQ(mesh->triangles.size(), 4u) << name;
    EXPECT_NEAR(signed_volume(*mesh), 1.0 / 6, 1e-12) << name;
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : mesh->vertices) box.extend(p);
    EXPECT_TRUE(box.max().isApprox(Vector3d(2, 1, 0.5))) << name;
  }
}

TEST(ReadMesh, SplitsThePolygonsOfAPly) {
  const test::TemporaryFolder folder;
  const std::string text =
      ply_header("ascii", 5, 1) + "0 0 0 0\n0 1 0 0\n0 1 1 0\n0 0 1 0\n0 9 9 9\n4 0 1 2 3\n";
  const auto mesh = read_mesh(folder.write("a.ply", text));
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->vertices.size(), 4u) << "what no triangle has is left out";
}

TEST(ReadMesh, RefusesHostileHeadersAtOnce) {
  const test::TemporaryFolder folder;
  const std::string padding(1024 - 84, '\0');
  expect_refused(folder.write("huge.stl", std::string(80, ' ') + bytes_of(~0u) + padding),
                 {"4294967295", " 18"});
  expect_refused(
      folder.write("solid.stl", "solid" + std::string(75, ' ') + bytes_of(~0u) + padding),
      {"4294967295", " 18"});
  expect_refused(folder.write("short.stl", stl(5)), {"5 triangles", "284", "4"});
  expect_refused(folder.write("empty.stl", ""), {"84"});
  expect_refused(folder.write("stub.stl", "solid x"), {"84"});
  const auto ply = [&](const std::string& text) { return folder.write("x.ply", text); };
  expect_refused(ply(ply_header("binary_little_endian", 9'000'000, 1)), {"9000000", "0 bytes"});
  expect_refused(ply(ply_header("ascii", 99'000'000, 1)), {"99000000", "10000000"});
  expect_refused(ply(ply_header("ascii", 18446744073709551615u, 1)), {"10000000"});
  expect_refused(ply(ply_header("ascii", 1, 1) + "0 0 0 0\n200000000000 1 2 3\n"), {"list"});
  expect_refused(ply(ply_header("ascii", 1, 1) + "0 0 0 0\n-3 1 2 3\n"), {"list", "line 13"});
  expect_refused(ply(ply_header("ascii", 1, 1) + "0 0 0 0\n3 0 0 1\n"), {"face 0", "line 13"});
  expect_refused(ply(ply_header("ascii", 1, 1) + "0 0 0 0\n3 0 0 -1\n"), {"face 0"});
  expect_refused(ply(ply_header("ascii", 1, 1) + "0 0 x 0\n3 0 0 0\n"), {"'y'", "line 12"});
  expect_refused(ply("ply\nformat ascii 1.0\nelement face 1\nproperty list float int "
                     "vertex_indices\nend_header\n3 0 0 0\n"),
                 {"line 4"});
  expect_refused(ply("ply\nelement vertex 0\nend_header\n"), {"format"});
  expect_refused(ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"), {"end"});
}

TEST(ReadMesh, ReadsTheFacesOfAnObj) {
  const test::TemporaryFolder folder;
  const std::string corners = "v 0 0 0 1\nv 1 0 0\r\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\n";
  const auto read = [&](const std::string& faces) {
    return read_mesh(folder.write("a.obj", faces + corners));
  };
  for (const char* faces : {"f 1 2 3 4\n", "f 1/7 2//9 3/7/9 4 # all\n", "f 1 2 \\\n 3 4\n",
                            "# one\nvn 0 0 1\ng a b\nf 1 2 3\nf 1 3 4\nl 1 2\n"}) {
    const auto mesh = read(faces);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->triangles.size(), 2u) << faces;
    EXPECT_EQ(mesh->vertices.size(), 4u) << faces;
  }
  const auto relative = read_mesh(folder.write("b.obj", corners + "f -4 -3 -2 -1\n"));
  ASSERT_TRUE(relative) << relative.error().message;
  EXPECT_EQ(relative->triangles.size(), 2u);
  const auto obj = [&](const std::string& faces) { return folder.write("c.obj", faces + corners); };
  expect_refused(obj("\nf 1 2 5\n"), {"line 2", "vertex 5", "only 4"});
  expect_refused(obj("f 1 2\n"), {"line 1", "three vertices"});
  expect_refused(obj("f 1`2 3 4\n"), {"'1`2'"});
  expect_refused(obj("f 0 1 2\n"), {"'0'"});
  expect_refused(obj("f -1 1 2\n"), {"'-1'"});
  expect_refused(obj("f 1 2 4294967297\n"), {"'4294967297'"});
  expect_refused(obj("v 1 2\n"), {"line 1", "''"});
}

TEST(ReadMesh, RefusesWhatItCannotUse) {
  const test::TemporaryFolder folder;
  expect_refused("/nowhere/a.stl", {"not exist"});
  expect_refused(std::filesystem::temp_directory_path(), {"must end in .stl"});
  std::filesystem::create_directory(folder.write("x", "").parent_path() / "folder.stl");
  expect_refused(folder.write("x", "").parent_path() / "folder.stl", {"regular"});
  expect_refused(folder.write("a.exe", "MZ"), {".stl", ".exe"});
  expect_refused(folder.write("a.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), {});
  std::string bytes = stl(4);
  bytes.replace(96, 4, bytes_of(std::numeric_limits<float>::infinity()));
  expect_refused(folder.write("inf.stl", bytes), {"finite"});
  expect_refused(folder.write("none.stl", stl(0).substr(0, 84)), {});
}

/// Damaged files must give an answer, whatever it is; run with the sanitizers for more.
TEST(ReadMesh, SurvivesDamagedFiles) {
  const test::TemporaryFolder folder;
  Rng rng(51);
  for (const auto& [name, bytes] : tetrahedra()) {
    for (int i = 0; i < 60; ++i) {
      std::string damaged = bytes;
      if (i % 4 == 0) damaged.resize(rng.index(bytes.size()));
      const std::size_t hits = damaged.empty() ? 0 : 1 + rng.index(6);
      for (std::size_t k = 0; k < hits; ++k) {
        damaged[rng.index(damaged.size())] = static_cast<char>(rng.index(256));
      }
      const auto mesh = read_mesh(folder.write("damaged" + name, damaged));
      if (!mesh) continue;
      for (const auto& triangle : mesh->triangles) {
        for (const int v : triangle) ASSERT_LT(static_cast<std::size_t>(v), mesh->vertices.size());
      }
    }
  }
}

TEST(ReadMesh, ReadsTheMeshesOfRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  int count = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(test::data_path("robots"))) {
    const auto type = entry.path().extension();
    if (type != ".stl" && type != ".dae") continue;
    const auto mesh = read_mesh(entry.path());
    EXPECT_TRUE(mesh) << mesh.error().message;
    ++count;
  }
  EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace tandem::geometry
