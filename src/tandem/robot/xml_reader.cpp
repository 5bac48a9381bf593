#include "tandem/robot/xml_reader.h"

#include <tinyxml2.h>

#include <algorithm>

namespace tandem::robot {

namespace {

constexpr std::string_view kSpace = " \t\r\n";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace

std::string XmlElement::tag() const { return element_->Name(); }

int XmlElement::line() const { return element_->GetLineNum(); }

void XmlElement::fail(const std::string& what, ErrorCode code) const {
  std::string place = *origin_ + ":" + std::to_string(line()) + ": ";
  const tinyxml2::XMLElement* named = element_;
  while (named && !named->Attribute("name")) {
    const tinyxml2::XMLNode* parent = named->Parent();
    named = parent ? parent->ToElement() : nullptr;
  }
  if (named) place += std::string(named->Name()) + " '" + named->Attribute("name") + "': ";
  if (named != element_) place += "<" + tag() + ">: ";
  throw ReadFailure{{code, place + what}};
}

void XmlElement::fail_value(const char* name, const std::string& expected) const {
  fail(std::string(name) + "=\"" + attribute(name).value_or("") + "\": expected " + expected);
}

std::optional<XmlElement> XmlElement::child(const char* tag) const {
  const tinyxml2::XMLElement* element = element_->FirstChildElement(tag);
  if (!element) return std::nullopt;
  return XmlElement(*element, *origin_);
}

XmlElement XmlElement::required_child(const char* tag) const {
  const auto element = child(tag);
  if (!element) fail(std::string("needs a <") + tag + "> element");
  return *element;
}

std::vector<XmlElement> XmlElement::children(const char* tag) const {
  std::vector<XmlElement> elements;
  for (const auto* e = element_->FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) {
    elements.emplace_back(*e, *origin_);
  }
  return elements;
}

std::optional<std::string> XmlElement::attribute(const char* name) const {
  const char* value = element_->Attribute(name);
  if (!value) return std::nullopt;
  return value;
}

std::string XmlElement::required(const char* name) const {
  const auto value = attribute(name);
  if (!value || value->empty()) fail(std::string("needs the attribute ") + name);
  return *value;
}

double XmlElement::number(const char* name) const {
  const auto value = parse_number(trim(required(name)));
  if (!value) fail_value(name, "a finite number");
  return *value;
}

double XmlElement::number(const char* name, double absent) const {
  return attribute(name) ? number(name) : absent;
}

double XmlElement::positive(const char* name) const {
  const double value = number(name);
  if (!(value > 0)) fail_value(name, "a positive number");
  return value;
}

Eigen::Vector3d XmlElement::vector3(const char* name) const {
  const std::string text = required(name);
  Eigen::Vector3d vector;
  int count = 0;
  std::string_view rest = trim(text);
  while (!rest.empty()) {
    const std::size_t length = std::min(rest.find_first_of(kSpace), rest.size());
    const auto value = parse_number(rest.substr(0, length));
    if (!value || count == 3) fail_value(name, "three finite numbers");
    vector[count++] = *value;
    rest = trim(rest.substr(length));
  }
  if (count != 3) fail_value(name, "three finite numbers");
  return vector;
}

Eigen::Vector3d XmlElement::vector3(const char* name, const Eigen::Vector3d& absent) const {
  return attribute(name) ? vector3(name) : absent;
}

XmlDocument::XmlDocument(const std::string& text, const std::string& origin,
                         const std::string& root)
    : origin_(origin), document_(std::make_unique<tinyxml2::XMLDocument>()) {
  if (document_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw ReadFailure{
        {ErrorCode::kInvalidInput, origin + ":" + std::to_string(document_->ErrorLineNum()) +
                                       ": not well-formed XML (" + document_->ErrorName() + ")"}};
  }
  const tinyxml2::XMLElement* element = document_->RootElement();
  if (!element || root != element->Name()) {
    throw ReadFailure{{ErrorCode::kInvalidInput,
                       origin + ": expected the root element <" + root + ">, found " +
                           (element ? "<" + std::string(element->Name()) + ">" : "none")}};
  }
}

XmlDocument::~XmlDocument() = default;

XmlElement XmlDocument::root() const { return {*document_->RootElement(), origin_}; }

}  // namespace tandem::robot
