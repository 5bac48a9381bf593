#include "tandem/geometry/ply.h"

#include <cmath>
#include <map>
#include <string>

#include "tandem/geometry/file_bytes.h"

namespace tandem::geometry::detail {

namespace {

using Path = std::filesystem::path;

struct Property {
  std::string name;
  ScalarType type;
  std::optional<ScalarType> count;  ///< Of a list.
};

struct Element {
  std::string name;
  std::uint64_t count;
  std::vector<Property> properties;
};

struct Header {
  enum class Format { kNone, kAscii, kLittleEndian, kBigEndian } format = Format::kNone;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< [bytes]
  int lines = 0;
};

std::optional<ScalarType> scalar_type(std::string_view word) {
  using enum ScalarType::Kind;
  static const std::map<std::string_view, ScalarType> kTypes{
      {"char", {kSigned, 1}},     {"int8", {kSigned, 1}},     {"uchar", {kUnsigned, 1}},
      {"uint8", {kUnsigned, 1}},  {"short", {kSigned, 2}},    {"int16", {kSigned, 2}},
      {"ushort", {kUnsigned, 2}}, {"uint16", {kUnsigned, 2}}, {"int", {kSigned, 4}},
      {"int32", {kSigned, 4}},    {"uint", {kUnsigned, 4}},   {"uint32", {kUnsigned, 4}},
      {"float", {kFloat, 4}},     {"float32", {kFloat, 4}},   {"double", {kFloat, 8}},
      {"float64", {kFloat, 8}}};
  const auto found = kTypes.find(word);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

Header::Format format_of(std::string_view word) {
  if (word == "ascii") return Header::Format::kAscii;
  if (word == "binary_little_endian") return Header::Format::kLittleEndian;
  if (word == "binary_big_endian") return Header::Format::kBigEndian;
  return Header::Format::kNone;
}

/// @return what is wrong with the line, or nothing.
std::string read_element(Words& words, Header& header) {
  const std::string name(words.next_in_line());
  const auto count = to_count(words.next_in_line());
  if (name.empty() || !count) return "'element' needs a name and a count";
  header.elements.push_back({name, *count, {}});
  return {};
}

std::string read_property(Words& words, Header& header) {
  if (header.elements.empty()) return "a property before any element";
  Property property;
  std::string_view type = words.next_in_line();
  if (type == "list") {
    property.count = scalar_type(words.next_in_line());
    if (!property.count || property.count->kind == ScalarType::Kind::kFloat) {
      return "the count of a list must have a whole type, such as uchar";
    }
    type = words.next_in_line();
  }
  const auto scalar = scalar_type(type);
  property.name = words.next_in_line();
  if (!scalar) return in_quotes(type) + " is not a type";
  if (property.name.empty()) return "a property without a name";
  property.type = *scalar;
  header.elements.back().properties.push_back(property);
  return {};
}

Result<Header> read_header(std::string_view bytes, const Path& file) {
  Words words(bytes);
  if (words.next_in_line() != "ply") return malformed(file, "line 1", "a PLY starts with 'ply'");
  Header header;
  while (words.next_line()) {
    const std::string_view key = words.next_in_line();
    std::string complaint;
    if (key == "end_header") {
      if (header.format == Header::Format::kNone) complaint = "no format before the end";
      if (complaint.empty() && !words.next_line()) header.size = bytes.size();
      if (header.size == 0) header.size = words.offset();
      header.lines = words.line() - 1;
      if (complaint.empty()) return header;
    } else if (key == "format") {
      const std::string_view word = words.next_in_line();
      header.format = format_of(word);
      if (header.format == Header::Format::kNone) {
        complaint = in_quotes(word) + " is not a format";
      }
    } else if (key == "element") {
      complaint = read_element(words, header);
    } else if (key == "property") {
      complaint = read_property(words, header);
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      complaint = in_quotes(key) + " is not a key of a PLY's header";
    }
    if (!complaint.empty()) {
      return malformed(file, "line " + std::to_string(words.line()), complaint);
    }
  }
  return malformed(file, "line " + std::to_string(words.line()), "the header does not end");
}

/// The numbers of a body, one after the other.
class Body {
 public:
  Body(std::string_view bytes, const Header& header)
      : bytes_(bytes.substr(header.size)),
        header_(header),
        words_(bytes_, " \t\r", header.lines + 1) {}

  std::optional<double> next(ScalarType type) {
    if (is_ascii()) return to_number(words_.next());
    const std::size_t size = static_cast<std::size_t>(type.size);
    if (bytes_.size() - at_ < size) return std::nullopt;
    at_ += size;
    return decode(&bytes_[at_ - size], type, header_.format == Header::Format::kBigEndian);
  }

  bool is_ascii() const { return header_.format == Header::Format::kAscii; }
  std::string where() const {
    return is_ascii() ? "line " + std::to_string(words_.line())
                      : "byte " + std::to_string(header_.size + at_);
  }
  /// [bytes]
  std::uint64_t left() const { return bytes_.size() - (is_ascii() ? words_.offset() : at_); }
  /// The least that an element can take [bytes].
  std::uint64_t least_size(const Element& element) const {
    std::uint64_t size = 0;
    for (const Property& property : element.properties) {
      size += is_ascii() ? 2u : static_cast<unsigned>(property.count.value_or(property.type).size);
    }
    return size;
  }

 private:
  std::string_view bytes_;
  const Header& header_;
  Words words_;
  std::size_t at_ = 0;
};

/// Reads the elements of a file.
class Reader {
 public:
  Reader(Body body, const Path& file) : body_(std::move(body)), file_(file) {}

  /// @return what is wrong and where, or nothing.
  Result<void> read(const Element& element);
  Ply& result() { return ply_; }

 private:
  Result<void> read_row(const Element& element);
  Result<void> read_list(const Element& element, const Property& property);
  Result<void> add_face(const Element& element);
  std::unexpected<Error> complain(const std::string& what) const {
    return malformed(file_, body_.where(), what);
  }

  Body body_;
  const Path& file_;
  Ply ply_;
  Eigen::Vector3d vertex_;
  std::vector<double> list_;
  std::uint64_t row_ = 0;
};

bool is_corner_list(const Element& element, const Property& property) {
  return element.name == "face" &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

Result<void> Reader::read(const Element& element) {
  const bool vertices = element.name == "vertex";
  const std::uint64_t least = body_.least_size(element);
  const bool used = vertices || element.name == "face";
  if (used && element.count > kMostItems) {
    return complain("the header says " + std::to_string(element.count) + " of element '" +
                    element.name + "', more than " + std::to_string(kMostItems));
  }
  if (least == 0) return {};  // Nothing to read, however many.
  // Text may lack the last separator.
  if (element.count > (body_.left() + 1) / least) {
    return complain("the header says " + std::to_string(element.count) + " of element '" +
                    element.name + "', but only " + std::to_string(body_.left()) +
                    " bytes are left");
  }
  if (vertices) {
    for (const char* axis : {"x", "y", "z"}) {
      const auto is_axis = [&](const Property& p) { return p.name == axis && !p.count; };
      if (std::ranges::none_of(element.properties, is_axis)) {
        return complain(std::string("the vertices have no '") + axis + "'");
      }
    }
    ply_.vertices.reserve(element.count);
  }
  for (row_ = 0; row_ < element.count; ++row_) {
    if (auto done = read_row(element); !done) return done;
    if (vertices) ply_.vertices.push_back(vertex_);
  }
  return {};
}

Result<void> Reader::read_row(const Element& element) {
  for (const Property& property : element.properties) {
    if (property.count) {
      if (auto done = read_list(element, property); !done) return done;
      continue;
    }
    const auto value = body_.next(property.type);
    if (!value) {
      return complain("no number for '" + property.name + "' of " + element.name + " " +
                      std::to_string(row_));
    }
    if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
      vertex_[property.name[0] - 'x'] = *value;
    }
  }
  return {};
}

Result<void> Reader::read_list(const Element& element, const Property& property) {
  const std::string row = element.name + " " + std::to_string(row_);
  const auto count = body_.next(*property.count);
  // Also refuses what is not a number; `left` bounds what a hostile count can ask for.
  if (!count || !(*count >= 0 && *count <= static_cast<double>(body_.left()) &&
                  *count == std::floor(*count))) {
    return complain("no valid length of the list '" + property.name + "' of " + row);
  }
  list_.clear();
  for (double i = 0; i < *count; ++i) {
    const auto value = body_.next(property.type);
    if (!value) return complain("the list '" + property.name + "' of " + row + " ends early");
    list_.push_back(*value);
  }
  return is_corner_list(element, property) ? add_face(element) : Result<void>();
}

Result<void> Reader::add_face(const Element& element) {
  const double end = static_cast<double>(ply_.vertices.size());
  for (const double index : list_) {
    if (index >= 0 && index < end && index == std::floor(index)) continue;
    return complain(element.name + " " + std::to_string(row_) + " has the vertex " +
                    std::to_string(index) + ", but vertices 0 to " +
                    std::to_string(ply_.vertices.size()) + " - 1 come before it");
  }
  for (std::size_t i = 2; i < list_.size(); ++i) {
    ply_.triangles.push_back(
        {static_cast<int>(list_[0]), static_cast<int>(list_[i - 1]), static_cast<int>(list_[i])});
    if (ply_.triangles.size() > kMostItems) {
      return complain("more than " + std::to_string(kMostItems) + " triangles");
    }
  }
  return {};
}

}  // namespace

Result<Ply> parse_ply(std::string_view bytes, const Path& file) {
  const Result<Header> header = read_header(bytes, file);
  if (!header) return std::unexpected(header.error());
  Reader reader(Body(bytes, *header), file);
  for (const Element& element : header->elements) {
    if (auto done = reader.read(element); !done) return std::unexpected(done.error());
  }
  return std::move(reader.result());
}

}  // namespace tandem::geometry::detail
