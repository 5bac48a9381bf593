#include "tandem/geometry/obj.h"

#include <algorithm>

#include "tandem/geometry/file_bytes.h"

namespace tandem::geometry::detail {

namespace {

using Eigen::Vector3d;

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::filesystem::path& file) : words_(text), file_(file) {}

  Result<TriangleMesh> read() {
    do {
      const std::string_view word = words_.next_in_line();
      if (word == "v" && !read_vertex()) return std::unexpected(error_);
      if (word == "f" && !read_face()) return std::unexpected(error_);
      if (mesh_.vertices.size() > 3 * kMostItems || mesh_.triangles.size() > kMostItems) {
        refuse("more than " + std::to_string(kMostItems) + " triangles");
        return std::unexpected(error_);
      }
    } while (words_.next_line());
    // A face may stand before its vertices.
    if (largest_ < static_cast<int>(mesh_.vertices.size())) return std::move(mesh_);
    return malformed(file_, "line " + std::to_string(largest_line_),
                     "a face names vertex " + std::to_string(largest_ + 1) +
                         ", but there are only " + std::to_string(mesh_.vertices.size()));
  }

 private:
  bool refuse(const std::string& what) {
    error_ = malformed(file_, "line " + std::to_string(words_.line()), what).error();
    return false;
  }

  /// The next word of a line that may go on behind a backslash.
  std::string_view next() {
    std::string_view word = words_.next_in_line();
    while (word == "\\" && words_.next_line()) word = words_.next_in_line();
    return word;
  }

  bool read_vertex() {
    Vector3d p;
    for (double& x : p) {
      const std::string_view word = next();
      const auto value = to_number(word);
      if (!value) return refuse(in_quotes(word) + " is no coordinate of a vertex");
      x = *value;
    }
    mesh_.vertices.push_back(p);
    return true;
  }

  bool read_face() {
    std::vector<int> corners;
    for (std::string_view word = next(); !word.empty() && word[0] != '#'; word = next()) {
      // VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or all three.
      std::string_view number = word.substr(0, word.find('/'));
      const bool from_end = number.starts_with('-');
      if (from_end) number.remove_prefix(1);
      const auto index = to_count(number);
      if (!index || *index == 0 || *index > 3 * kMostItems ||
          (from_end && *index > mesh_.vertices.size())) {
        return refuse(in_quotes(word) + " names no vertex");
      }
      const auto place = from_end ? mesh_.vertices.size() - *index : *index - 1;
      corners.push_back(static_cast<int>(place));
      if (corners.back() > largest_) {
        largest_ = corners.back();
        largest_line_ = words_.line();
      }
    }
    if (corners.size() < 3) return refuse("a face needs three vertices");
    for (std::size_t i = 2; i < corners.size(); ++i) {
      mesh_.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    return true;
  }

  Words words_;
  const std::filesystem::path& file_;
  TriangleMesh mesh_;
  Error error_{};
  int largest_ = -1, largest_line_ = 0;  // Of the indices so far.
};

}  // namespace

Result<TriangleMesh> parse_obj(std::string_view text, const std::filesystem::path& file) {
  return ObjReader(text, file).read();
}

}  // namespace tandem::geometry::detail
