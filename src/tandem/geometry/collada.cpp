#include "tandem/geometry/collada.h"

#include <tinyxml2.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "tandem/geometry/file_bytes.h"

namespace tandem::geometry::detail {

namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;
using tinyxml2::XMLElement;
using Count = std::uint64_t;

constexpr std::size_t kMostLevels = 200;       // Of nodes in nodes.
constexpr std::size_t kMostShown = 1'000'000;  // Elements of the scene's nodes.
constexpr std::size_t kLongestNumber = 100;    // [bytes] with the space around it.

/// A refusal on its way from inside the document to parse_collada.
struct Malformed {
  int line;
  std::string what;
  ErrorCode code = ErrorCode::kInvalidInput;
};

[[noreturn]] void refuse(const XMLElement& element, const std::string& what,
                         ErrorCode code = ErrorCode::kInvalidInput) {
  throw Malformed{element.GetLineNum(), "element " + in_quotes(element.Name()) + " " + what, code};
}

[[noreturn]] void refuse_kind(const XMLElement& element, const std::string& remedy) {
  refuse(element, "is not supported; " + remedy, ErrorCode::kUnsupported);
}

const XMLElement& child(const XMLElement& element, const char* tag) {
  const XMLElement* found = element.FirstChildElement(tag);
  if (!found) refuse(element, "needs a <" + std::string(tag) + ">");
  return *found;
}

std::string_view attribute(const XMLElement& element, const char* name) {
  const char* value = element.Attribute(name);
  if (!value) refuse(element, "needs the attribute " + std::string(name));
  return value;
}

Count count_in(const XMLElement& element, const char* name) {
  const std::string_view value = attribute(element, name);
  const auto count = to_count(value);
  if (!count || *count > kMostBytes) {
    refuse(element, std::string(name) + " is " + in_quotes(value) + ", it must be a count up to " +
                        std::to_string(kMostBytes));
  }
  return *count;
}

Count count_in(const XMLElement& element, const char* name, Count absent) {
  return element.Attribute(name) ? count_in(element, name) : absent;
}

void check_count(const XMLElement& element, Count there) {
  const Count said = count_in(element, "count");
  if (said == there) return;
  refuse(element, "says count " + std::to_string(said) + ", but has " + std::to_string(there));
}

/// The id that a reference such as "#id" names.
std::string_view target(const XMLElement& element, const char* name) {
  const std::string_view url = attribute(element, name);
  if (!url.starts_with('#')) {
    refuse(element, std::string(name) + " is " + in_quotes(url) +
                        ", it must be '#' and an id of the same file");
  }
  return url.substr(1);
}

/// Calls `take` with every number of the element's text.
template <class Read, class Take>
void for_numbers(const XMLElement& element, const Read& read, const char* kind, const Take& take) {
  const char* text = element.GetText();
  Words words(text ? text : "", " \t\r", element.GetLineNum());
  for (auto word = words.next(); !word.empty(); word = words.next()) {
    const auto value = read(word);
    if (!value) refuse(element, "has " + in_quotes(word) + ", expected " + kind);
    take(*value);
  }
}

std::vector<double> numbers(const XMLElement& element) {
  std::vector<double> values;
  for_numbers(element, to_number, "a number", [&](double value) { values.push_back(value); });
  return values;
}

/// The numbers of an element that may be shown many times.
std::vector<double> numbers(const XMLElement& element, std::size_t count) {
  const char* text = element.GetText();
  if (text && std::string_view(text).size() > count * kLongestNumber) {
    refuse(element, "has too long a text for " + std::to_string(count) + " numbers");
  }
  std::vector<double> values = numbers(element);
  if (values.size() != count) {
    refuse(element, "has " + std::to_string(values.size()) + " numbers, it must have " +
                        std::to_string(count));
  }
  return values;
}

std::vector<Count> counts(const XMLElement& element) {
  std::vector<Count> values;
  for_numbers(element, to_count, "an index or count",
              [&](Count value) { values.push_back(value); });
  return values;
}

const XMLElement* input_of(const XMLElement& element, std::string_view semantic) {
  const XMLElement* input = element.FirstChildElement("input");
  while (input && attribute(*input, "semantic") != semantic) {
    input = input->NextSiblingElement("input");
  }
  return input;
}

/// Where x, y and z stand within a stride.
std::array<Count, 3> axes_of(const XMLElement& accessor) {
  std::array<Count, 3> axes{0, 1, 2};
  Count place = 0;
  const auto* param = accessor.FirstChildElement("param");
  for (; param; param = param->NextSiblingElement("param"), ++place) {
    const char* name = param->Attribute("name");
    const std::string_view known = "XYZ";
    const std::size_t axis =
        name && std::string_view(name).size() == 1 ? known.find(*name) : known.npos;
    if (axis != known.npos) axes[axis] = place;
  }
  return axes;
}

std::vector<Vector3d> points_of(const XMLElement& source) {
  const XMLElement& array = child(source, "float_array");
  const std::vector<double> values = numbers(array);
  check_count(array, values.size());
  const XMLElement& accessor = child(child(source, "technique_common"), "accessor");
  const Count count = count_in(accessor, "count"), stride = count_in(accessor, "stride", 1);
  const Count offset = count_in(accessor, "offset", 0);
  const std::array<Count, 3> axes = axes_of(accessor);
  const Count reach = *std::ranges::max_element(axes);
  if (stride <= reach) refuse(accessor, "has a stride too small for x, y and z");
  // None of them exceeds kMostBytes, so the product is exact.
  if (count > 0 && offset + (count - 1) * stride + reach >= values.size()) {
    refuse(accessor,
           "reaches beyond the " + std::to_string(values.size()) + " numbers of its array");
  }
  std::vector<Vector3d> points;
  for (Count i = 0; i < count; ++i) {
    const Count first = offset + i * stride;
    points.emplace_back(values[first + axes[0]], values[first + axes[1]], values[first + axes[2]]);
  }
  return points;
}

/// Reads one <mesh>, in its own frame.
class MeshReader {
 public:
  explicit MeshReader(const XMLElement& mesh) : mesh_(mesh) {}

  TriangleMesh read() {
    const XMLElement& vertices = child(mesh_, "vertices");
    const XMLElement* input = input_of(vertices, "POSITION");
    if (!input) refuse(vertices, "needs an input POSITION");
    const std::string_view id = target(*input, "source");
    const XMLElement* source = mesh_.FirstChildElement("source");
    while (source && attribute(*source, "id") != id) source = source->NextSiblingElement("source");
    if (!source) refuse(*input, "names " + in_quotes(id) + ", which is no source of its mesh");
    result_.vertices = points_of(*source);
    for (const auto* e = mesh_.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view kind = e->Name();
      if (kind == "triangles") add_triangles(*e);
      if (kind == "polylist") add_polygon_list(*e);
      if (kind == "polygons" || kind == "trifans") add_each(*e, &MeshReader::add_fan);
      if (kind == "tristrips") add_each(*e, &MeshReader::add_strip);
    }
    return std::move(result_);
  }

 private:
  using Corners = std::span<const int>;

  void add(int a, int b, int c) { result_.triangles.push_back({a, b, c}); }

  void add_fan(Corners corners) {
    for (std::size_t i = 2; i < corners.size(); ++i) add(corners[0], corners[i - 1], corners[i]);
  }

  void add_strip(Corners corners) {
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const bool odd = i % 2 == 1;  // Every other triangle of a strip is turned round.
      add(corners[i - (odd ? 1 : 2)], corners[i - (odd ? 2 : 1)], corners[i]);
    }
  }

  /// How many indices a corner has, and which of them is its vertex.
  struct Layout {
    Count stride = 0, vertex = 0;
  };

  static Layout layout_of(const XMLElement& primitive) {
    const XMLElement* vertex = input_of(primitive, "VERTEX");
    if (!vertex) refuse(primitive, "needs an input VERTEX");
    Layout layout{0, count_in(*vertex, "offset")};
    const auto* input = primitive.FirstChildElement("input");
    for (; input; input = input->NextSiblingElement("input")) {
      layout.stride = std::max(layout.stride, count_in(*input, "offset") + 1);
    }
    return layout;
  }

  /// The vertices that a <p> names.
  std::vector<int> corners(const XMLElement& p, const Layout& layout) const {
    const std::vector<Count> all = counts(p);
    if (all.size() % layout.stride != 0) {
      refuse(p, "has " + std::to_string(all.size()) + " indices, no multiple of the " +
                    std::to_string(layout.stride) + " of a corner");
    }
    std::vector<int> corners;
    for (std::size_t i = layout.vertex; i < all.size(); i += layout.stride) {
      if (all[i] >= result_.vertices.size()) {
        refuse(p, "has the index " + std::to_string(all[i]) + ", but there are only " +
                      std::to_string(result_.vertices.size()) + " vertices");
      }
      corners.push_back(static_cast<int>(all[i]));
    }
    return corners;
  }

  std::vector<int> only_corners(const XMLElement& primitive) const {
    const XMLElement* p = primitive.FirstChildElement("p");
    return p ? corners(*p, layout_of(primitive)) : std::vector<int>();
  }

  void add_triangles(const XMLElement& primitive) {
    const std::vector<int> all = only_corners(primitive);
    if (all.size() % 3 != 0) refuse(primitive, "ends within a triangle");
    check_count(primitive, all.size() / 3);
    for (std::size_t i = 0; i < all.size(); i += 3) add(all[i], all[i + 1], all[i + 2]);
  }

  void add_polygon_list(const XMLElement& primitive) {
    const XMLElement* vcount = primitive.FirstChildElement("vcount");
    const std::vector<int> all = only_corners(primitive);
    const std::vector<Count> sizes = vcount ? counts(*vcount) : std::vector<Count>();
    check_count(primitive, sizes.size());
    Corners rest(all);
    for (const Count size : sizes) {
      if (size > rest.size()) refuse(primitive, "has fewer corners than its vcount says");
      add_fan(rest.first(size));
      rest = rest.subspan(size);
    }
    if (!rest.empty()) refuse(primitive, "has more corners than its vcount says");
  }

  /// One piece for every <p>.
  void add_each(const XMLElement& primitive, void (MeshReader::*add_piece)(Corners)) {
    if (const auto* holes = primitive.FirstChildElement("ph")) {
      refuse_kind(*holes, "export polygons without holes, or triangles");
    }
    const auto* p = primitive.FirstChildElement("p");
    const Layout layout = p ? layout_of(primitive) : Layout();
    Count pieces = 0;
    for (; p; p = p->NextSiblingElement("p"), ++pieces) (this->*add_piece)(corners(*p, layout));
    check_count(primitive, pieces);
  }

  const XMLElement& mesh_;
  TriangleMesh result_;
};

Affine3d transform(const XMLElement& element, std::string_view kind) {
  if (kind == "matrix") {
    const std::vector<double> m = numbers(element, 16);
    const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> matrix(m.data());
    constexpr double kRounding = 1e-6;
    if (!(matrix.row(3) - Eigen::RowVector4d::UnitW()).isZero(kRounding)) {
      refuse(element, "must have the last row 0 0 0 1");
    }
    return Affine3d(Eigen::AffineCompact3d(matrix.topRows<3>()));
  }
  if (kind == "rotate") {
    const std::vector<double> r = numbers(element, 4);
    const Vector3d axis = Vector3d(r[0], r[1], r[2]).stableNormalized();
    if (!(std::abs(axis.norm() - 1) < 1e-9)) refuse(element, "needs an axis that is not zero");
    return Affine3d(Eigen::AngleAxisd(r[3] * std::numbers::pi / 180, axis));
  }
  const std::vector<double> v = numbers(element, 3);
  if (kind == "scale") return Affine3d(Eigen::Scaling(v[0], v[1], v[2]));
  return Affine3d(Eigen::Translation3d(v[0], v[1], v[2]));
}

/// Puts together what the scene of a document shows.
class SceneReader {
 public:
  explicit SceneReader(const XMLElement& root) : root_(root) { collect(root_, 0); }

  TriangleMesh read() {
    const XMLElement& scene = child(child(root_, "scene"), "instance_visual_scene");
    const XMLElement& visual = find(scene, "visual_scene");
    const Affine3d X_WS(Eigen::Scaling(unit()));
    for (const auto* n = visual.FirstChildElement("node"); n; n = n->NextSiblingElement("node")) {
      add_node(*n, X_WS);
    }
    return std::move(result_);
  }

 private:
  /// Notes what may be referred to.
  void collect(const XMLElement& parent, std::size_t level) {
    for (const auto* e = parent.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string_view kind = e->Name();
      const char* id = e->Attribute("id");
      if (id && (kind == "geometry" || kind == "node" || kind == "visual_scene")) {
        by_id_.emplace(std::pair(kind, std::string_view(id)), e);
      }
      // The XML parser bounds the levels.
      if (kind == "node" || kind == "visual_scene" || level == 0) collect(*e, level + 1);
    }
  }

  const XMLElement& find(const XMLElement& reference, std::string_view kind) const {
    const std::string_view id = target(reference, "url");
    const auto [first, end] = by_id_.equal_range(std::pair(kind, id));
    if (first == end) refuse(reference, "names " + in_quotes(id) + ", which is not there");
    if (std::next(first) != end)
      refuse(reference, "names " + in_quotes(id) + ", which is there twice");
    return *first->second;
  }

  /// Metres in the unit of the file.
  double unit() const {
    const XMLElement* asset = root_.FirstChildElement("asset");
    const XMLElement* unit = asset ? asset->FirstChildElement("unit") : nullptr;
    if (!unit || !unit->Attribute("meter")) return 1;
    const auto meter = to_number(attribute(*unit, "meter"));
    if (!meter || !(*meter > 0) || !std::isfinite(*meter)) {
      refuse(*unit,
             "meter is " + in_quotes(attribute(*unit, "meter")) + ", it must be a positive number");
    }
    return *meter;
  }

  void add_node(const XMLElement& node, Affine3d X_WN) {
    if (std::ranges::find(open_, &node) != open_.end()) refuse(node, "contains itself");
    if (open_.size() >= kMostLevels) refuse(node, "is nested too deeply");
    open_.push_back(&node);
    for (const auto* e = node.FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (++shown_ > kMostShown) refuse(node, "is shown too often; simplify the scene");
      const std::string_view kind = e->Name();
      if (kind == "matrix" || kind == "rotate" || kind == "scale" || kind == "translate") {
        X_WN = X_WN * transform(*e, kind);
      }
      if (kind == "lookat" || kind == "skew") refuse_kind(*e, "export matrices");
      if (kind == "instance_controller") refuse_kind(*e, "export the mesh without its skeleton");
      if (kind == "node") add_node(*e, X_WN);
      if (kind == "instance_node") add_node(find(*e, "node"), X_WN);
      if (kind == "instance_geometry") add_geometry(*e, find(*e, "geometry"), X_WN);
    }
    open_.pop_back();
  }

  void add_geometry(const XMLElement& instance, const XMLElement& geometry, const Affine3d& X_WG) {
    const XMLElement* element = geometry.FirstChildElement("mesh");
    if (!element) return;
    auto known = meshes_.find(element);
    if (known == meshes_.end()) known = meshes_.emplace(element, MeshReader(*element).read()).first;
    const TriangleMesh& mesh = known->second;
    if (result_.vertices.size() + mesh.vertices.size() > 3 * kMostItems ||
        result_.triangles.size() + mesh.triangles.size() > kMostItems) {
      refuse(instance, "makes more than " + std::to_string(kMostItems) + " triangles");
    }
    const int first = static_cast<int>(result_.vertices.size());
    for (const Vector3d& p : mesh.vertices) result_.vertices.push_back(X_WG * p);
    // A mirror image would show its inside.
    const bool mirrored = X_WG.linear().determinant() < 0;
    for (const auto& [i, j, k] : mesh.triangles) {
      result_.triangles.push_back(
          {first + i, first + (mirrored ? k : j), first + (mirrored ? j : k)});
    }
  }

  const XMLElement& root_;
  std::multimap<std::pair<std::string_view, std::string_view>, const XMLElement*> by_id_;
  std::map<const XMLElement*, TriangleMesh> meshes_;
  std::vector<const XMLElement*> open_;  // From the scene's node down to the one being added.
  std::size_t shown_ = 0;                // Elements of the scene's nodes so far.
  TriangleMesh result_;
};

}  // namespace

Result<TriangleMesh> parse_collada(const std::string& bytes, const std::filesystem::path& file) {
  // An element or attribute takes about a hundred bytes of memory, but four in a file.
  const auto marks = std::ranges::count(bytes, '<') + std::ranges::count(bytes, '=');
  if (static_cast<Count>(marks) > kMostItems) {
    return malformed(file, "line 1",
                     "more than " + std::to_string(kMostItems) +
                         " elements and attributes; simplify what is in it");
  }
  tinyxml2::XMLDocument document;
  if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    return malformed(file, "line " + std::to_string(document.ErrorLineNum()),
                     std::string("not well-formed XML (") + document.ErrorName() + ")");
  }
  const XMLElement* root = document.RootElement();
  if (!root || std::string_view(root->Name()) != "COLLADA") {
    return malformed(file, "line 1", "expected the root element <COLLADA>");
  }
  try {
    return SceneReader(*root).read();
  } catch (const Malformed& bad) {
    auto error = malformed(file, "line " + std::to_string(bad.line), bad.what);
    error.error().code = bad.code;
    return error;
  }
}

}  // namespace tandem::geometry::detail
