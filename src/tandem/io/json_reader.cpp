#include "tandem/io/json_reader.h"

#include <algorithm>
#include <cstdint>

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

}  // namespace

void JsonReader::refuse(const std::string& expected) const {
  throw BadJson{(where_.empty() ? "the document" : where_) + " is " + shown(*value_) +
                    ", expected " + expected,
                value_};
}

void JsonReader::complain(const std::string& message) const {
  throw BadJson{where_.empty() ? message : where_ + ": " + message, value_};
}

void JsonReader::expect_keys(const std::vector<std::string>& required,
                             const std::vector<std::string>& optional) const {
  const std::string prefix = where_.empty() ? "" : where_ + ".";
  std::vector<std::string> known = required;
  known.insert(known.end(), optional.begin(), optional.end());
  for (const std::string& key : keys()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    throw BadJson{"unknown key " + prefix + key + name_hint(key, known), &value_->at(key), true};
  }
  for (const std::string& key : required) {
    if (!has(key)) throw BadJson{"key " + prefix + key + " is missing", value_};
  }
}

void JsonReader::expect_keys(const std::vector<std::string>& keys) const { expect_keys(keys, {}); }

bool JsonReader::has(const std::string& key) const { return value_->contains(key); }

JsonReader JsonReader::operator[](const std::string& key) const {
  if (!value_->is_object()) refuse("an object");
  const auto member = value_->find(key);
  const std::string where = where_.empty() ? key : where_ + "." + key;
  if (member == value_->end()) throw BadJson{"key " + where + " is missing", value_};
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

double JsonReader::positive() const {
  const double value = number();
  if (value <= 0) refuse("a number above 0");
  return value;
}

bool JsonReader::boolean() const {
  if (!value_->is_boolean()) refuse("true or false");
  return value_->get<bool>();
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

}  // namespace tandem::io
