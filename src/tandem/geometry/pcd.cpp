#include "tandem/geometry/pcd.h"

#include <array>
#include <cstring>
#include <optional>
#include <string>

#include "tandem/geometry/file_bytes.h"

namespace tandem::geometry::detail {

namespace {

using Eigen::Vector3d;
using Path = std::filesystem::path;

struct Field {
  std::string name;
  ScalarType type;
  std::uint64_t count = 1;   ///< Numbers of this name in one point.
  std::uint64_t offset = 0;  ///< [bytes] in a point.

  std::uint64_t bytes() const { return count * static_cast<std::uint64_t>(type.size); }
};

struct Header {
  std::vector<Field> fields;
  std::array<std::size_t, 3> xyz{};  ///< Their indices in `fields`.
  std::uint64_t points = 0;
  std::uint64_t point_bytes = 0;
  std::string data;
  std::size_t size = 0;  ///< [bytes]
  int lines = 0;
};

constexpr std::uint64_t kMostNumbers = 1000;  ///< Of one point.

/// Sets one property of every field from the words of a line.
template <class Set>
std::string for_fields(Words& words, Header& header, const Set& set) {
  for (Field& field : header.fields) {
    const std::string_view word = words.next_in_line();
    if (!set(field, word)) {
      return in_quotes(word) + " does not fit the field " + in_quotes(field.name);
    }
  }
  return {};
}

bool set_size(Field& field, std::string_view word) {
  const auto size = to_count(word);
  if (!size || (*size != 1 && *size != 2 && *size != 4 && *size != 8)) return false;
  field.type.size = static_cast<int>(*size);
  return true;
}

bool set_kind(Field& field, std::string_view word) {
  using enum ScalarType::Kind;
  if (word != "F" && word != "I" && word != "U") return false;
  field.type.kind = word == "F" ? kFloat : word == "I" ? kSigned : kUnsigned;
  return field.type.kind != kFloat || field.type.size >= 4;
}

bool set_count(Field& field, std::string_view word) {
  const auto count = to_count(word);
  if (!count || *count > kMostNumbers) return false;
  field.count = *count;
  return true;
}

/// @return what is wrong with the line, or nothing.
std::string read_line(std::string_view key, Words& words, Header& header) {
  if (key == "FIELDS") {
    for (auto word = words.next_in_line(); !word.empty(); word = words.next_in_line()) {
      if (header.fields.size() == kMostNumbers) return "too many fields";
      header.fields.push_back({std::string(word), {}});
    }
    return {};
  }
  if (key == "SIZE") return for_fields(words, header, set_size);
  if (key == "TYPE") return for_fields(words, header, set_kind);
  if (key == "COUNT") return for_fields(words, header, set_count);
  if (key == "POINTS") {
    const auto count = to_count(words.next_in_line());
    if (!count) return "POINTS needs a count";
    header.points = *count;
    return {};
  }
  if (key == "DATA") {
    header.data = words.next_in_line();
    const bool known =
        header.data == "ascii" || header.data == "binary" || header.data == "binary_compressed";
    return known ? "" : "DATA '" + header.data + "' must be ascii, binary or binary_compressed";
  }
  const bool known = key == "VERSION" || key == "WIDTH" || key == "HEIGHT" || key == "VIEWPOINT";
  if (known || key.empty() || key.starts_with('#')) return {};
  return in_quotes(key) + " is not a key of a PCD's header";
}

/// Where the fields lie; @return what is wrong, or nothing.
std::string lay_out(Header& header) {
  for (Field& field : header.fields) {
    field.offset = header.point_bytes;
    header.point_bytes += field.bytes();
  }
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t i = 0;
    while (i < header.fields.size() && header.fields[i].name != kAxes[k]) ++i;
    if (i == header.fields.size() || header.fields[i].count != 1) {
      return std::string("the points have no field '") + kAxes[k] + "'";
    }
    header.xyz[k] = i;
  }
  if (header.points > kMostItems) {
    return "the header says " + std::to_string(header.points) + " points, more than " +
           std::to_string(kMostItems);
  }
  return {};
}

Result<Header> read_header(std::string_view bytes, const Path& file) {
  Words words(bytes);
  Header header;
  do {
    const std::string_view key = words.next_in_line();
    std::string complaint = read_line(key, words, header);
    const std::string where = "line " + std::to_string(words.line());
    if (complaint.empty() && key == "DATA") complaint = lay_out(header);
    if (!complaint.empty()) return malformed(file, where, complaint);
    if (key == "DATA") {
      header.lines = words.line();
      words.next_line();
      header.size = words.offset();
      return header;
    }
  } while (words.next_line());
  return malformed(file, "line " + std::to_string(words.line()), "the header has no DATA");
}

Result<std::vector<Vector3d>> read_ascii(std::string_view body, const Header& header,
                                         const Path& file) {
  Words words(body, " \t\r", header.lines + 1);
  std::vector<Vector3d> points;
  for (std::uint64_t i = 0; i < header.points; ++i) {
    Vector3d point = Vector3d::Zero();
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      for (std::uint64_t k = 0; k < header.fields[f].count; ++k) {
        const std::string_view word = words.next();
        const auto value = to_number(word);
        if (!value) {
          return malformed(file, "line " + std::to_string(words.line()),
                           (word.empty() ? "the file ends in" : "no number in") +
                               std::string(" point ") + std::to_string(i) + " of " +
                               std::to_string(header.points));
        }
        for (int axis = 0; axis < 3; ++axis) {
          if (header.xyz[static_cast<std::size_t>(axis)] == f) point[axis] = *value;
        }
      }
    }
    points.push_back(point);
  }
  return points;
}

/// Points from binary data: one after the other, or field after field.
std::vector<Vector3d> decode_points(std::string_view data, const Header& header, bool by_field) {
  std::vector<Vector3d> points(header.points);
  for (int axis = 0; axis < 3; ++axis) {
    const Field& field = header.fields[header.xyz[static_cast<std::size_t>(axis)]];
    const std::uint64_t first = field.offset * (by_field ? header.points : 1);
    const std::uint64_t step = by_field ? field.bytes() : header.point_bytes;
    for (std::uint64_t i = 0; i < header.points; ++i) {
      points[i][axis] = decode(&data[first + i * step], field.type, false);
    }
  }
  return points;
}

/// Undoes LZF: runs of literals, and copies of what came before. None if it does not give `size`
/// bytes.
std::optional<std::string> decompress(std::string_view in, std::uint64_t size) {
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] { return static_cast<unsigned char>(in[at++]); };
  while (at < in.size()) {
    const unsigned control = byte();
    if (control < 32) {  // A run of literals.
      const std::size_t length = control + 1;
      if (in.size() - at < length || size - out.size() < length) return std::nullopt;
      out.append(in.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (in.size() - at < (length == 7 ? 2u : 1u)) return std::nullopt;
    if (length == 7) length += byte();
    const std::size_t back = ((control & 31u) << 8) + byte() + 1;
    length += 2;
    if (back > out.size() || size - out.size() < length) return std::nullopt;
    // One by one: a copy may reach into itself.
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);
  }
  if (out.size() != size) return std::nullopt;
  return out;
}

Result<std::vector<Vector3d>> read_compressed(std::string_view body, const Header& header,
                                              const Path& file) {
  constexpr std::size_t kSizes = 8;  // [bytes] Two numbers come first.
  constexpr ScalarType kSize{ScalarType::Kind::kUnsigned, 4};
  const std::string where = "byte " + std::to_string(header.size);
  if (body.size() < kSizes) return malformed(file, where, "the file ends before its data");
  const auto packed = static_cast<std::uint64_t>(decode(&body[0], kSize, false));
  const auto unpacked = static_cast<std::uint64_t>(decode(&body[4], kSize, false));
  if (packed > body.size() - kSizes || unpacked != header.points * header.point_bytes ||
      unpacked > kMostBytes) {
    return malformed(file, where,
                     std::to_string(packed) + " compressed bytes for " + std::to_string(unpacked) +
                         " were announced, but " + std::to_string(body.size() - kSizes) +
                         " follow and the header asks for " +
                         std::to_string(header.points * header.point_bytes));
  }
  const auto data = decompress(body.substr(kSizes, packed), unpacked);
  if (!data) return malformed(file, where, "the compressed data is damaged");
  return decode_points(*data, header, true);
}

}  // namespace

Result<std::vector<Vector3d>> parse_pcd(std::string_view bytes, const Path& file) {
  const Result<Header> header = read_header(bytes, file);
  if (!header) return std::unexpected(header.error());
  const std::string_view body = bytes.substr(header->size);
  if (header->data == "ascii") return read_ascii(body, *header, file);
  if (header->data == "binary_compressed") return read_compressed(body, *header, file);
  if (header->points * header->point_bytes > body.size()) {
    return malformed(file, "byte " + std::to_string(header->size),
                     "the header says " + std::to_string(header->points) + " points of " +
                         std::to_string(header->point_bytes) + " bytes, but only " +
                         std::to_string(body.size()) + " bytes follow");
  }
  return decode_points(body, *header, false);
}

}  // namespace tandem::geometry::detail
