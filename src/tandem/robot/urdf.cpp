#include "tandem/robot/urdf.h"

#include <map>
#include <numbers>

#include "tandem/core/bounds.h"
#include "tandem/core/file.h"
#include "tandem/core/names.h"
#include "tandem/robot/xml_reader.h"

namespace tandem::robot {

namespace {

Eigen::Isometry3d read_origin(const XmlElement& parent) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  const auto origin = parent.child("origin");
  if (!origin) return X;
  if (origin->attribute("quat_xyzw")) {
    origin->fail("quat_xyzw is not read; give the rotation as rpy", ErrorCode::kUnsupported);
  }
  const Eigen::Vector3d rpy = origin->vector3("rpy", Eigen::Vector3d::Zero());
  X.translation() = origin->vector3("xyz", Eigen::Vector3d::Zero());
  if (X.translation().cwiseAbs().maxCoeff() > kFarthest) {
    origin->fail("xyz=\"" + *origin->attribute("xyz") +
                 "\": farther than 1e8 m; are these metres?");
  }
  X.linear() = (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  return X;
}

Inertial read_inertial(const XmlElement& element) {
  const XmlElement mass = element.required_child("mass");
  const XmlElement inertia = element.required_child("inertia");
  Inertial inertial;
  inertial.mass = mass.number("value");
  if (inertial.mass < 0) mass.fail("value: a mass cannot be negative");
  inertial.X_LI = read_origin(element);
  const double ixy = inertia.number("ixy", 0), ixz = inertia.number("ixz", 0);
  const double iyz = inertia.number("iyz", 0);
  inertial.I_I << inertia.number("ixx"), ixy, ixz,  //
      ixy, inertia.number("iyy"), iyz,              //
      ixz, iyz, inertia.number("izz");
  return inertial;
}

JointType read_type(const XmlElement& element) {
  const std::string type = element.required("type");
  for (const JointType known :
       {JointType::kRevolute, JointType::kContinuous, JointType::kPrismatic, JointType::kFixed}) {
    if (type == to_string(known)) return known;
  }
  if (type == "floating" || type == "planar") {
    element.fail("type=\"" + type +
                     "\" is not supported; model it by prismatic and revolute joints, or fix it",
                 ErrorCode::kUnsupported);
  }
  element.fail("type=\"" + type + "\": expected revolute, continuous, prismatic or fixed");
}

JointLimits read_limits(const XmlElement& element, JointType type) {
  JointLimits limits;
  const auto limit = element.child("limit");
  const bool bounded = type != JointType::kContinuous;
  if (!limit) {
    if (bounded) {
      element.fail(std::string("a ") + to_string(type) +
                   " joint needs a <limit> element with lower and upper" +
                   (type == JointType::kRevolute ? "; without limits its type is continuous" : ""));
    }
    return limits;
  }
  if (bounded) {
    if (!limit->attribute("lower") && !limit->attribute("upper")) {
      limit->fail("needs lower and upper; an absent one counts as 0, so the joint could not move");
    }
    limits.lower = limit->number("lower", 0);
    limits.upper = limit->number("upper", 0);
    if (limits.lower > limits.upper) {
      limit->fail("lower=\"" + limit->attribute("lower").value_or("0") + "\" is above upper=\"" +
                  limit->attribute("upper").value_or("0") + "\"");
    }
  }
  const double velocity = limit->number("velocity", 0);
  if (velocity < 0) {
    limit->fail("velocity=\"" + *limit->attribute("velocity") + "\": expected a positive number");
  }
  if (velocity > 0) limits.velocity = velocity;
  return limits;
}

class UrdfReader {
 public:
  UrdfReader(XmlElement robot, std::filesystem::path base, const PackagePath& packages)
      : robot_(robot), base_(std::move(base)), packages_(packages) {}

  void read() {
    for (const XmlElement& element : robot_.children()) {
      if (element.tag().starts_with("xacro:")) {
        element.fail("this is a xacro file; expand it first (xacro FILE > robot.urdf)",
                     ErrorCode::kUnsupported);
      }
    }
    for (const XmlElement& element : bounded("link")) {
      add_name(element, link_index_);
      links.push_back(read_link(element));
    }
    const std::vector<XmlElement> elements = bounded("joint");
    for (const XmlElement& element : elements) {
      add_name(element, joint_index_);
      joints.push_back(read_joint(element));
    }
    for (std::size_t i = 0; i < elements.size(); ++i) read_mimic(elements[i], joints[i]);
  }

  std::vector<Link> links;
  std::vector<Joint> joints;

 private:
  struct Entry {
    int index, line;
  };
  using Names = std::map<std::string, Entry>;

  /// What is computed per link and link above it stays small; no honest robot comes near.
  std::vector<XmlElement> bounded(const char* tag) const {
    constexpr std::size_t kMost = 10'000;
    std::vector<XmlElement> elements = robot_.children(tag);
    if (elements.size() > kMost) {
      elements[kMost].fail("the file has over " + std::to_string(kMost) + " <" + tag +
                           "> elements");
    }
    return elements;
  }

  static void add_name(const XmlElement& element, Names& names) {
    const std::string name = element.required("name");
    const Entry entry{static_cast<int>(names.size()), element.line()};
    const auto [earlier, is_new] = names.emplace(name, entry);
    if (!is_new) {
      element.fail("the name exists already, in line " + std::to_string(earlier->second.line));
    }
  }

  static int find(const Names& names, const XmlElement& element, const char* attribute) {
    const std::string name = element.required(attribute);
    const auto found = names.find(name);
    if (found != names.end()) return found->second.index;
    std::vector<std::string> known;
    for (const auto& [key, entry] : names) known.push_back(key);
    element.fail("no " + std::string(attribute) + " '" + name + "'" + name_hint(name, known));
  }

  Geometry read_geometry(const XmlElement& element) const {
    Geometry geometry;
    geometry.X_LG = read_origin(element);
    const XmlElement holder = element.required_child("geometry");
    if (const auto box = holder.child("box")) {
      const Eigen::Vector3d size = box->vector3("size");
      if (!(size.minCoeff() > 0)) {
        box->fail("size=\"" + *box->attribute("size") + "\": expected three positive numbers");
      }
      geometry.shape = BoxGeometry{size};
    } else if (const auto sphere = holder.child("sphere")) {
      geometry.shape = SphereGeometry{sphere->positive("radius")};
    } else if (const auto cylinder = holder.child("cylinder")) {
      geometry.shape = CylinderGeometry{cylinder->positive("radius"), cylinder->positive("length")};
    } else if (const auto mesh = holder.child("mesh")) {
      geometry.shape = read_mesh(*mesh);
    } else {
      const auto shapes = holder.children();
      const std::string found = shapes.empty() ? "nothing" : shapes[0].tag();
      holder.fail("expected box, sphere, cylinder or mesh, found " + found,
                  shapes.empty() ? ErrorCode::kInvalidInput : ErrorCode::kUnsupported);
    }
    return geometry;
  }

  MeshGeometry read_mesh(const XmlElement& element) const {
    MeshGeometry mesh;
    mesh.uri = element.required("filename");
    mesh.scale = element.vector3("scale", Eigen::Vector3d::Ones());
    // A negative factor mirrors the mesh; zero would flatten it.
    if ((mesh.scale.array() == 0).any()) {
      element.fail("scale=\"" + *element.attribute("scale") + "\": expected no factor to be zero");
    }
    const auto path = packages_.resolve(mesh.uri, base_);
    if (path) {
      mesh.path = path->string();
    } else {
      mesh.missing = path.error().message;
    }
    return mesh;
  }

  Link read_link(const XmlElement& element) const {
    Link link;
    link.where = element.where();
    link.name = element.required("name");
    for (const XmlElement& e : element.children("collision")) {
      link.collision.push_back(read_geometry(e));
    }
    for (const XmlElement& e : element.children("visual")) link.visual.push_back(read_geometry(e));
    if (const auto inertial = element.child("inertial")) link.inertial = read_inertial(*inertial);
    return link;
  }

  Joint read_joint(const XmlElement& element) const {
    Joint joint;
    joint.where = element.where();
    joint.name = element.required("name");
    joint.type = read_type(element);
    joint.parent_link = find(link_index_, element.required_child("parent"), "link");
    joint.child_link = find(link_index_, element.required_child("child"), "link");
    joint.X_PJ = read_origin(element);
    if (joint.type == JointType::kFixed) return joint;
    if (const auto axis = element.child("axis")) {
      joint.axis_J = axis->vector3("xyz", joint.axis_J);
      if (joint.axis_J.norm() < 1e-9) {
        axis->fail("xyz=\"" + *axis->attribute("xyz") + "\": expected a direction, not zero");
      }
    }
    joint.limits = read_limits(element, joint.type);
    return joint;
  }

  void read_mimic(const XmlElement& element, Joint& joint) const {
    const auto mimic = element.child("mimic");
    if (!mimic || joint.type == JointType::kFixed) return;
    joint.mimic = Mimic{find(joint_index_, *mimic, "joint"), mimic->number("multiplier", 1),
                        mimic->number("offset", 0)};
  }

  XmlElement robot_;
  std::filesystem::path base_;
  const PackagePath& packages_;
  Names link_index_, joint_index_;
};

}  // namespace

Result<Model> load_urdf(const std::filesystem::path& file, const PackagePath& packages) {
  const auto text = read_file(file);
  if (!text) return std::unexpected(text.error());
  return parse_urdf(*text, file.string(), file.parent_path(), packages);
}

Result<Model> parse_urdf(const std::string& text, const std::string& origin,
                         const std::filesystem::path& base, const PackagePath& packages) {
  try {
    const XmlDocument document(text, origin, "robot");
    UrdfReader reader(document.root(), base, packages);
    reader.read();
    auto model = Model::make(document.root().required("name"), std::move(reader.links),
                             std::move(reader.joints));
    if (model) return model;
    const bool placed = model.error().message.starts_with(origin + ":");
    const std::string where = placed ? "" : document.root().where() + ": ";
    return fail(model.error().code, where + model.error().message);
  } catch (const ReadFailure& failure) {
    return std::unexpected(failure.error);
  }
}

}  // namespace tandem::robot
