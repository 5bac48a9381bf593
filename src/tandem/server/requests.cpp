#include "tandem/server/requests.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "tandem/core/names.h"

namespace tandem::server {

namespace {

using Json = nlohmann::json;
using pipeline::Preset;
using pipeline::Strategy;

/// Far beyond any cell, and far from where squares overflow [rad or m].
constexpr double kLargestValue = 1e6;
constexpr double kLongestDistance = 1e3;    // [m]
constexpr double kUnitTolerance = 1e-3;     // [-] of a quaternion's norm.
constexpr double kShortestDeadline = 1e-3;  // [s]

/// A refusal on its way from inside a document to the reading function's boundary.
struct BadRequest {
  std::string message;
};

/// One value of a request and the way to it. All accessors throw BadRequest.
class Reader {
 public:
  Reader(const Json& value, std::string where) : value_(value), where_(std::move(where)) {}

  /// This is an object, with all `needed` keys and no others than these and the `optional` ones.
  void expect_keys(const std::vector<std::string>& needed,
                   const std::vector<std::string>& optional = {}) const {
    if (!value_.is_object()) refuse("an object");
    std::vector<std::string> known = needed;
    known.insert(known.end(), optional.begin(), optional.end());
    for (const auto& [key, value] : value_.items()) {
      if (std::find(known.begin(), known.end(), key) == known.end()) {
        throw BadRequest{"unknown key " + inside(shown(key)) + name_hint(key, known)};
      }
    }
    for (const std::string& key : needed) {
      if (!has(key)) throw BadRequest{"key " + inside(key) + " is missing"};
    }
  }

  bool has(const std::string& key) const { return value_.contains(key); }
  Reader operator[](const std::string& key) const { return {value_.at(key), inside(key)}; }

  /// A number from `least` to `most`.
  double number(double least, double most) const {
    const double value = value_.is_number() ? value_.get<double>() : least - 1;
    if (!(value >= least && value <= most)) {
      refuse("a number from " + Json(least).dump() + " to " + Json(most).dump());
    }
    return value;
  }

  std::uint64_t count() const {
    if (!value_.is_number_unsigned()) refuse("a whole number from 0 to 2^64 - 1");
    return value_.get<std::uint64_t>();
  }

  std::string text() const {
    if (!value_.is_string()) refuse("a text");
    return value_.get<std::string>();
  }

  Eigen::VectorXd vector(Eigen::Index size, double largest, const std::string& what) const {
    if (!value_.is_array() || std::ssize(value_) != size) {
      refuse(std::to_string(size) + " numbers: " + what);
    }
    Eigen::VectorXd values(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const auto k = static_cast<std::size_t>(i);
      values[i] =
          Reader(value_[k], where_ + "[" + std::to_string(k) + "]").number(-largest, largest);
    }
    return values;
  }

  [[noreturn]] void refuse(const std::string& expected) const {
    throw BadRequest{(where_.empty() ? "the request" : where_) + " is " + shown(value_) +
                     ", expected " + expected};
  }

 private:
  std::string inside(const std::string& key) const {
    return where_.empty() ? key : where_ + "." + key;
  }

  /// The value as it was sent, cut to a length that fits a message.
  static std::string shown(const Json& value) {
    constexpr std::size_t kMost = 60;
    if (value.is_structured()) {
      return (value.is_array() ? "a list of " : "an object of ") + std::to_string(value.size());
    }
    const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return text.size() > kMost ? text.substr(0, kMost) + "..." : text;
  }

  const Json& value_;
  std::string where_;
};

/// What `read` makes of the document in `body`.
template <class Request, class Read>
Result<Request> parsed(const std::string& body, const Read& read) {
  try {
    const Json json = Json::parse(body);
    return read(Reader(json, ""));
  } catch (const Json::exception& bad) {
    const std::string what = bad.what();  // "[json.exception.parse_error.101] parse error at ..."
    const std::size_t id = what.find("] ");
    return fail(
        ErrorCode::kInvalidInput,
        "the request is not JSON: " + (id == std::string::npos ? what : what.substr(id + 2)));
  } catch (const BadRequest& bad) {
    return fail(ErrorCode::kInvalidInput, bad.message);
  }
}

/// One of the options in `known`, by name.
template <class Option>
Option read_option(const Reader& value, const std::vector<Option>& known) {
  const std::string name = value.text();
  std::string names;
  for (const Option option : known) {
    if (name == to_string(option)) return option;
    if (!names.empty()) names += option == known.back() ? " or " : ", ";
    names.append("\"").append(to_string(option)).append("\"");
  }
  value.refuse(names);
}

Eigen::VectorXd read_joints(const Reader& q, int dof) {
  return q.vector(dof, kLargestValue, "one per joint of the cell");
}

Eigen::Isometry3d read_pose(const Reader& pose) {
  pose.expect_keys({"xyz", "quat_wxyz"});
  const Eigen::Vector4d u = pose["quat_wxyz"].vector(4, 1 + kUnitTolerance, "w, x, y, z");
  if (std::abs(u.norm() - 1) > kUnitTolerance) {
    pose["quat_wxyz"].refuse("a unit quaternion, its norm is " + std::to_string(u.norm()));
  }
  Eigen::Isometry3d X_WE = Eigen::Isometry3d::Identity();
  X_WE.linear() = Eigen::Quaterniond(u[0], u[1], u[2], u[3]).normalized().toRotationMatrix();
  X_WE.translation() = pose["xyz"].vector(3, kLongestDistance, "x, y, z [m]");
  return X_WE;
}

}  // namespace

Result<PlanRequest> read_plan_request(const std::string& body, int dof) {
  return parsed<PlanRequest>(body, [&](const Reader& json) {
    json.expect_keys({}, {"query", "start", "goal", "seed", "preset", "strategy", "deadline"});
    PlanRequest request;
    if (json.has("query")) {
      json.expect_keys({"query"}, {"seed", "preset", "strategy", "deadline"});
      request.query = json["query"].text();
    } else {
      json.expect_keys({"start", "goal"}, {"seed", "preset", "strategy", "deadline"});
      request.ends = {"live", read_joints(json["start"], dof), read_joints(json["goal"], dof)};
    }
    if (json.has("seed")) request.options.seed = json["seed"].count();
    if (json.has("preset")) {
      request.options.preset =
          read_option<Preset>(json["preset"], {Preset::kDefault, Preset::kPaper});
    }
    if (json.has("strategy")) {
      request.options.strategy = read_option<Strategy>(
          json["strategy"], {Strategy::kCentralized, Strategy::kDecoupled, Strategy::kAuto});
    }
    if (json.has("deadline")) {
      request.options.deadline =
          std::min(kLongestDeadline, json["deadline"].number(kShortestDeadline, kLargestValue));
    }
    return request;
  });
}

Result<IkRequest> read_ik_request(const std::string& body, int dof) {
  return parsed<IkRequest>(body, [&](const Reader& json) {
    json.expect_keys({"arm", "q", "pose"});
    return IkRequest{json["arm"].text(), read_joints(json["q"], dof), read_pose(json["pose"])};
  });
}

}  // namespace tandem::server
