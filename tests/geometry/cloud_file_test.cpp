#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "random_shapes.h"
#include "tandem/geometry/mesh_file.h"
#include "temporary_folder.h"

namespace tandem::geometry {
namespace {

using Eigen::Vector3d;

class ReadCloud : public testing::Test {
 protected:
  Result<std::vector<Vector3d>> read(const std::string& name, const std::string& bytes) const {
    return read_cloud(folder_.write(name, bytes));
  }
  void expect_points(const std::string& name, const std::string& bytes) const {
    const auto points = read(name, bytes);
    ASSERT_TRUE(points) << points.error().message;
    ASSERT_EQ(points->size(), 2u) << name;
    EXPECT_EQ((*points)[0], Vector3d(1, -2, 0.5)) << name;
    EXPECT_EQ((*points)[1], Vector3d(0.25, 1e3, -4)) << name;
  }
  void expect_refused(const std::string& name, const std::string& bytes,
                      const std::vector<std::string>& parts) const {
    const auto points = read(name, bytes);
    ASSERT_FALSE(points) << name << "\n" << bytes;
    for (const std::string& part : parts) {
      EXPECT_NE(points.error().message.find(part), std::string::npos) << points.error().message;
    }
    EXPECT_NE(points.error().message.find(name), std::string::npos) << points.error().message;
  }

 private:
  test::TemporaryFolder folder_;
};

template <class Value>
std::string bytes_of(Value value, bool big_endian = false) {
  std::string bytes(sizeof(Value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Value));
  if (big_endian) std::ranges::reverse(bytes);
  return bytes;
}

const float kNan = std::nanf("");
const std::vector<Eigen::Vector3f> kPoints{{1, -2, 0.5}, {kNan, kNan, kNan}, {0.25, 1e3, -4}};

std::string pcd_header(const std::string& data, const std::string& points = "3") {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS rgb x y z _\n"
         "SIZE 4 4 4 4 1\nTYPE U F F F U\nCOUNT 1 1 1 1 2\nWIDTH 3\nHEIGHT 1\n"
         "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
         points + "\nDATA " + data + "\n";
}

std::string pcd_body() {
  std::string body;
  for (const auto& p : kPoints) {
    body += "rgb_" + bytes_of(p.x()) + bytes_of(p.y()) + bytes_of(p.z()) + "__";
  }
  return body;
}

/// The fields one after the other, packed by literals and copies.
std::string packed_pcd_body() {
  std::string in = "rgb_rgb_rgb_", out;
  for (int k = 0; k < 3; ++k) {
    for (const auto& p : kPoints) in += bytes_of(p[k]);
  }
  in += "______";
  out = '\3' + in.substr(0, 4);       // Four literals,
  out += std::string{'\xc0', '\3'};   // eight bytes from four back, into themselves,
  out += '\x1f' + in.substr(12, 32);  // and literals,
  out += '\4' + in.substr(44, 5);     // the last of which is repeated
  out += std::string{'\x60', '\0'};   // five times.
  return bytes_of(std::uint32_t(out.size())) + bytes_of(std::uint32_t(in.size())) + out;
}

std::string ply(const std::string& format, const std::string& body,
                const std::string& vertices = "3") {
  return "ply\r\nformat " + format +
         " 1.0\r\nelement thing 1\r\nproperty list uchar short "
         "of\r\nelement vertex " +
         vertices +
         "\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\nend_header\r\n" + body;
}

std::string ply_body(bool big) {
  std::string body = '\2' + bytes_of(short{1}, big) + bytes_of(short{2}, big);
  for (const auto& p : kPoints) {
    for (const float x : p) body += bytes_of(x, big);
  }
  return body;
}

const std::string kText = "1 -2 0.5\nnan nan nan\n+0.25 1e3 -4\n";

TEST_F(ReadCloud, ReadsEveryKindWithoutPointsThatAreNotFinite) {
  expect_points("a.xyz", "# x y z\n\n1 -2 0.5\nnan nan nan\n// more\n+0.25,1e3,-4, 255\n");
  expect_points("b.xyz", "1\t-2\t0.5\r\n.25 1000 -4.0");
  expect_points("c.pcd",
                pcd_header("ascii") + "1 1 -2 0.5 0 0\n2 nan nan nan 0 0\n3 0.25 1e3 -4 0 0\n");
  expect_points("d.PCD", pcd_header("binary") + pcd_body());
  expect_points("e.pcd", pcd_header("binary_compressed") + packed_pcd_body());
  expect_points("f.ply", ply("ascii", "2 7 7\n" + kText));
  expect_points("g.ply", ply("binary_little_endian", ply_body(false)));
  expect_points("h.ply", ply("binary_big_endian", ply_body(true)));
}

TEST_F(ReadCloud, RefusesWithPlaceAndValue) {
  expect_refused("a.las", "LASF", {".ply", ".las"});
  expect_refused("a.xyz", "", {"no finite point"});
  expect_refused("b.xyz", "nan 0 0\n", {"no finite point"});
  expect_refused("c.xyz", "0 0 0\n1 2\n", {"line 2", "''"});
  expect_refused("d.xyz", "0 0 0x\n", {"line 1", "'0x'"});
  expect_refused("e.pcd", pcd_header("zip"), {"line 11", "zip"});
  expect_refused("f.pcd", pcd_header("ascii") + "1 1 -2 0.5 0 0\n2 a", {"line 13", "point 1"});
  expect_refused("g.pcd", pcd_header("ascii"), {"ends", "point 0"});
  expect_refused("h.pcd", pcd_header("binary") + "short", {"3 points of 18 bytes", "5 bytes"});
  expect_refused("i.pcd", pcd_header("binary", "9999999") + "x", {"9999999", "1 bytes"});
  expect_refused("j.pcd", pcd_header("binary", "99999999999"), {"99999999999", "10000000"});
  expect_refused("k.pcd", pcd_header("binary_compressed") + packed_pcd_body().substr(0, 30),
                 {"22", "54"});
  expect_refused("l.pcd", "FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 1\n", {"'z'"});
  expect_refused("m.pcd", "FIELDS x y z\nSIZE 4 4\n", {"line 2", "'z'"});
  expect_refused("n.pcd", "FIELDS x y z\nSIZE 2 2 2\nTYPE F F F\n", {"line 3", "'F'"});
  expect_refused("o.pcd", "nothing\n", {"line 1", "nothing"});
  expect_refused("p.pcd", "VERSION 0.7\n", {"DATA"});
  expect_refused("q.ply", ply("ascii", "0\n1 20000 x", "1"), {"vertex 0", "'z'"});
  expect_refused("r.ply", ply("binary_little_endian", ply_body(false).substr(0, 20)), {"byte"});
  expect_refused("s.ply", ply("ascii", "0\n", "123456789"), {"123456789"});
  expect_refused("t.ply", "solid\n", {"line 1"});
  EXPECT_FALSE(read_cloud("/dev/zero.xyz"));
}

TEST_F(ReadCloud, SurvivesDamagedFiles) {
  Rng rng(52);
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.xyz", kText},
      {"b.pcd", pcd_header("binary") + pcd_body()},
      {"c.pcd", pcd_header("binary_compressed") + packed_pcd_body()},
      {"d.ply", ply("ascii", "2 7 7\n" + kText)},
      {"e.ply", ply("binary_big_endian", ply_body(true))}};
  for (const auto& [name, bytes] : files) {
    for (int i = 0; i < 100; ++i) {
      std::string damaged = bytes;
      if (i % 4 == 0) damaged.resize(1 + rng.index(bytes.size() - 1));
      for (std::size_t k = rng.index(6); k < 6; ++k) {
        damaged[rng.index(damaged.size())] = static_cast<char>(rng.index(256));
      }
      const auto points = read(name, damaged);
      if (!points) continue;
      EXPECT_TRUE(std::ranges::all_of(*points, [](auto& p) { return p.allFinite(); }));
    }
  }
}

}  // namespace
}  // namespace tandem::geometry
