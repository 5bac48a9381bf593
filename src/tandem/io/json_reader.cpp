#include "tandem/io/json_reader.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <set>

#include "tandem/core/names.h"

namespace tandem::io {

namespace {

/// The value as in the file, cut to a length that fits a message.
std::string shown(const nlohmann::json& value) {
  constexpr std::size_t kMost = 60;
  if (value.is_structured()) {
    return (value.is_array() ? "a list of " : "an object of ") + std::to_string(value.size());
  }
  const std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text.size() > kMost ? text.substr(0, kMost) + "..." : text;
}

/// Refuses a key that stands twice in one object: the parser would keep the last one silently.
class RepeatedKeys {
 public:
  bool operator()(int, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(parsed.get<std::string>()).second) {
      throw BadJson{"key " + parsed.dump() + " stands twice in one object; keep one of them"};
    }
    return true;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

}  // namespace

void JsonReader::refuse(const std::string& expected) const {
  throw BadJson{(where_.empty() ? "the document" : where_) + " is " + shown(*value_) +
                ", expected " + expected};
}

void JsonReader::complain(const std::string& message) const {
  throw BadJson{where_ + ": " + message};
}

void JsonReader::expect_keys(const std::vector<std::string>& expected) const {
  for (const std::string& key : keys()) {
    if (std::find(expected.begin(), expected.end(), key) == expected.end()) {
      throw BadJson{"unknown key " + (where_.empty() ? key : where_ + "." + key) +
                    name_hint(key, expected)};
    }
  }
  for (const std::string& key : expected) {
    if (!value_->contains(key)) {
      throw BadJson{"key " + (where_.empty() ? key : where_ + "." + key) + " is missing"};
    }
  }
}

JsonReader JsonReader::operator[](const std::string& key) const {
  if (!value_->is_object()) refuse("an object");
  const auto member = value_->find(key);
  const std::string where = where_.empty() ? key : where_ + "." + key;
  if (member == value_->end()) throw BadJson{"key " + where + " is missing"};
  return {*member, where};
}

std::vector<JsonReader> JsonReader::items() const {
  if (!value_->is_array()) refuse("a list");
  std::vector<JsonReader> readers;
  for (const nlohmann::json& item : *value_) {
    readers.emplace_back(item, where_ + "[" + std::to_string(readers.size()) + "]");
  }
  return readers;
}

std::vector<std::string> JsonReader::keys() const {
  if (!value_->is_object()) refuse("an object");
  std::vector<std::string> names;
  for (const auto& [key, value] : value_->items()) names.push_back(key);
  return names;
}

double JsonReader::number() const {
  if (!value_->is_number()) refuse("a number");
  return value_->get<double>();
}

double JsonReader::non_negative() const {
  const double value = number();
  if (value < 0) refuse("a number that is not negative");
  return value;
}

std::uint64_t JsonReader::count(std::uint64_t most) const {
  if (!value_->is_number_unsigned() || value_->get<std::uint64_t>() > most) {
    refuse("a whole number from 0 to " + std::to_string(most));
  }
  return value_->get<std::uint64_t>();
}

std::string JsonReader::text() const {
  if (!value_->is_string()) refuse("a text");
  return value_->get<std::string>();
}

std::string JsonReader::name() const {
  std::string value = text();
  if (value.empty()) refuse("a name that is not empty");
  return value;
}

std::vector<double> JsonReader::numbers() const {
  std::vector<double> values;
  for (const JsonReader& item : items()) values.push_back(item.number());
  return values;
}

Eigen::VectorXd JsonReader::vector(Eigen::Index size, const std::string& what) const {
  const std::vector<double> values = numbers();
  if (static_cast<Eigen::Index>(values.size()) != size) {
    refuse(std::to_string(size) + " numbers: " + what);
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), size);
}

Result<nlohmann::json> parse_json_file(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    return fail(ErrorCode::kNotFound, file.string() + ": does not exist");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file, error)) {
    return fail(ErrorCode::kIo, file.string() + ": cannot be read; is it a file you may read?");
  }
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  try {
    return nlohmann::json::parse(text, RepeatedKeys());
  } catch (const nlohmann::json::exception& bad) {
    const std::string what = bad.what();  // "[json.exception.parse_error.101] parse error at ..."
    const std::size_t id = what.find("] ");
    return fail(
        ErrorCode::kInvalidInput,
        file.string() + ": not JSON: " + (id == std::string::npos ? what : what.substr(id + 2)));
  } catch (const BadJson& bad) {
    return fail(ErrorCode::kInvalidInput, file.string() + ": " + bad.message);
  }
}

}  // namespace tandem::io
