#pragma once
/// Private to the readers of this folder: XML that knows where it stands.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "tandem/robot/text_reader.h"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace tandem::robot {

/// Where the elements of a document come from.
struct XmlSource {
  std::string origin;                                            ///< The file.
  std::unordered_map<const tinyxml2::XMLElement*, int> columns;  ///< From 1, in bytes.
};

/// An element and its source. Valid as long as its document.
class XmlElement {
 public:
  XmlElement(const tinyxml2::XMLElement& element, const XmlSource& source)
      : element_(&element), source_(&source) {}

  std::string tag() const;
  int line() const;
  std::string where() const;  ///< "FILE:LINE:COLUMN"
  /// Throws "FILE:LINE:COLUMN: joint 'NAME': <tag>: what", NAME being the nearest one above.
  [[noreturn]] void fail(const std::string& what, ErrorCode code = ErrorCode::kInvalidInput) const;

  std::optional<XmlElement> child(const char* tag) const;  ///< The first one.
  XmlElement required_child(const char* tag) const;
  std::vector<XmlElement> children(const char* tag = nullptr) const;

  std::optional<std::string> attribute(const char* name) const;
  std::string required(const char* name) const;  ///< Neither absent nor empty.
  double number(const char* name) const;         ///< Required.
  double number(const char* name, double absent) const;
  double positive(const char* name) const;  ///< Required.
  Eigen::Vector3d vector3(const char* name) const;
  Eigen::Vector3d vector3(const char* name, const Eigen::Vector3d& absent) const;

 private:
  [[noreturn]] void fail_value(const char* name, const std::string& expected) const;

  const tinyxml2::XMLElement* element_;
  const XmlSource* source_;
};

/// A parsed text whose root element has the tag `root`; throws ReadFailure otherwise.
class XmlDocument {
 public:
  XmlDocument(const std::string& text, const std::string& origin, const std::string& root);
  ~XmlDocument();
  XmlElement root() const;

 private:
  void find_columns(const std::string& text);

  XmlSource source_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

}  // namespace tandem::robot
