#include "tandem/robot/joint_limits.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "tandem/core/file.h"
#include "tandem/core/names.h"
#include "tandem/robot/text_reader.h"

namespace tandem::robot {

namespace {

/// ":LINE:COLUMN", or nothing where there is no place.
std::string place(const YAML::Mark& mark) {
  if (mark.is_null()) return "";
  return std::string(":")
      .append(std::to_string(mark.line + 1))
      .append(":")
      .append(std::to_string(mark.column + 1));
}

constexpr double kNone = std::numeric_limits<double>::infinity();

/// One joint's entry, its keys checked on the way.
class Entry {
 public:
  Entry(const std::string& origin, std::string joint, const YAML::Node& node)
      : origin_(origin), joint_(std::move(joint)), node_(node) {
    static const std::vector<std::string> kKeys = {
        "has_position_limits", "min_position",    "max_position",
        "has_velocity_limits", "max_velocity",    "has_acceleration_limits",
        "max_acceleration",    "has_jerk_limits", "max_jerk",
        "has_effort_limits",   "max_effort"};
    if (!node.IsMap()) fail(node, "expected keys like max_velocity below the joint");
    std::set<std::string> seen;
    for (const auto& item : node) {
      const std::string key = item.first.Scalar();
      if (std::ranges::find(kKeys, key) == kKeys.end()) {
        fail(item.first, "unknown key '" + key + "'" + name_hint(key, kKeys));
      }
      if (!seen.insert(key).second) fail(item.first, "key '" + key + "' exists twice");
    }
  }

  [[noreturn]] void fail(const YAML::Node& at, const std::string& what) const {
    throw ReadFailure{{ErrorCode::kInvalidInput,
                       origin_ + place(at.Mark()) + ": joint '" + joint_ + "': " + what}};
  }
  [[noreturn]] void fail(const std::string& what) const { fail(node_, what); }

  std::optional<bool> flag(const std::string& key) const {
    const YAML::Node node = node_[key];
    if (!node) return std::nullopt;
    bool value = false;
    if (!YAML::convert<bool>::decode(node, value)) fail_value(key, node, "true or false");
    return value;
  }

  std::optional<double> number(const std::string& key) const {
    const YAML::Node node = node_[key];
    if (!node) return std::nullopt;
    const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
    if (!value) fail_value(key, node, "a finite number");
    return value;
  }

  /// The limit of `quantity` after this entry, where `old` is the one before.
  double limit(const std::string& quantity, double old) const {
    const std::string has = "has_" + quantity + "_limits", max = "max_" + quantity;
    const auto on = flag(has);
    const auto value = number(max);
    if (on && !*on) return kNone;
    if (!value && on && !std::isfinite(old)) fail(node_[has], has + " is true: needs " + max);
    if (!value) return old;
    if (*value <= 0) fail_value(max, node_[max], "a positive number");
    return *value;
  }

 private:
  [[noreturn]] void fail_value(const std::string& key, const YAML::Node& node,
                               const std::string& expected) const {
    const std::string value = node.IsScalar() ? "'" + node.Scalar() + "'" : "a list or map";
    fail(node, key + ": expected " + expected + ", found " + value);
  }

  const std::string& origin_;
  std::string joint_;
  YAML::Node node_;
};

void overlay_position(const Entry& entry, const Joint& joint, JointLimits& limits) {
  const auto on = entry.flag("has_position_limits");
  const auto lower = entry.number("min_position"), upper = entry.number("max_position");
  if (on && !*on) {
    if (joint.type == JointType::kPrismatic) {
      entry.fail("has_position_limits: false, but only a joint that turns can do without limits");
    }
    limits.lower = -kNone;
    limits.upper = kNone;
    return;
  }
  if (lower) limits.lower = *lower;
  if (upper) limits.upper = *upper;
  const bool bounded = std::isfinite(limits.lower) && std::isfinite(limits.upper);
  if ((on || lower || upper) && !bounded) {
    entry.fail("needs min_position and max_position, as the model has no position limits");
  }
  if (limits.lower > limits.upper) {
    entry.fail("min_position " + std::to_string(limits.lower) + " is above max_position " +
               std::to_string(limits.upper));
  }
}

/// Notes where a document begins.
class DocumentMark final : public YAML::EventHandler {
 public:
  YAML::Mark mark;

  void OnDocumentStart(const YAML::Mark& at) override { mark = at; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Where a second document begins, if one does. No more are looked for: from some texts, such as
/// ", a", the parser takes empty documents without end.
std::optional<YAML::Mark> second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentMark document;
  if (!parser.HandleNextDocument(document) || !parser.HandleNextDocument(document)) {
    return std::nullopt;
  }
  return document.mark;
}

std::vector<std::string> joint_names(const Model& model) {
  std::vector<std::string> names;
  for (const Joint& joint : model.joints()) names.push_back(joint.name);
  return names;
}

/// Limits by joint index, all checked.
std::vector<std::pair<int, JointLimits>> read_overlay(const YAML::Node& root,
                                                      const std::string& origin,
                                                      const Model& model) {
  const auto fail_at = [&](const YAML::Node& at, const std::string& what) {
    throw ReadFailure{{ErrorCode::kInvalidInput, origin + place(at.Mark()) + ": " + what}};
  };
  if (!root.IsMap() || !root["joint_limits"]) {
    const std::vector<std::string> keys = {"joint_limits"};
    std::string hint;
    for (const auto& item : root.IsMap() ? root : YAML::Node()) {
      const std::string near = nearest_name(item.first.Scalar(), keys);
      if (!near.empty()) hint = ", found '" + item.first.Scalar() + "'";
    }
    throw ReadFailure{{ErrorCode::kInvalidInput,
                       origin + place(root.Mark()) + ": expected the key joint_limits" + hint}};
  }
  for (const auto& item : root) {
    static const std::vector<std::string> kKeys = {
        "joint_limits", "default_velocity_scaling_factor", "default_acceleration_scaling_factor"};
    const std::string key = item.first.Scalar();
    if (std::ranges::find(kKeys, key) == kKeys.end()) {
      fail_at(item.first, "unknown key '" + key + "'" + name_hint(key, kKeys));
    }
  }
  std::vector<std::pair<int, JointLimits>> overlay;
  const YAML::Node entries = root["joint_limits"];
  if (entries.IsNull()) return overlay;
  if (!entries.IsMap()) fail_at(entries, "joint_limits: expected joint names with their limits");
  for (const auto& item : entries) {
    const std::string name = item.first.Scalar();
    const int index = model.find_joint(name);
    if (index < 0) {
      fail_at(item.first, "no joint '" + name + "' in robot '" + model.name() + "'" +
                              name_hint(name, joint_names(model)));
    }
    if (std::ranges::find(overlay, index, &std::pair<int, JointLimits>::first) != overlay.end()) {
      fail_at(item.first, "joint '" + name + "' exists twice");
    }
    const Joint& joint = model.joints()[static_cast<std::size_t>(index)];
    const Entry entry(origin, name, item.second);
    JointLimits limits = joint.limits;
    overlay_position(entry, joint, limits);
    limits.velocity = entry.limit("velocity", limits.velocity);
    limits.acceleration = entry.limit("acceleration", limits.acceleration);
    limits.jerk = entry.limit("jerk", limits.jerk);
    overlay.emplace_back(index, limits);
  }
  return overlay;
}

}  // namespace

Result<void> overlay_joint_limits(const std::filesystem::path& file, Model& model) {
  const auto text = read_file(file);
  if (!text) return std::unexpected(text.error());
  return parse_joint_limits(*text, file.string(), model);
}

Result<void> parse_joint_limits(const std::string& text, const std::string& origin, Model& model) {
  try {
    if (const auto second = second_document(text)) {
      return fail(ErrorCode::kInvalidInput,
                  origin + place(*second) + ": a second document begins; keep one per file");
    }
    const YAML::Node root = YAML::Load(text);
    for (const auto& [joint, limits] : read_overlay(root, origin, model)) {
      model.set_limits(joint, limits);
    }
    return {};
  } catch (const ReadFailure& failure) {
    return std::unexpected(failure.error);
  } catch (const YAML::Exception& failure) {
    return fail(ErrorCode::kInvalidInput,
                origin + place(failure.mark) + ": not well-formed YAML: " + failure.msg);
  }
}

}  // namespace tandem::robot
