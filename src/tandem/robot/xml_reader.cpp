#include "tandem/robot/xml_reader.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cstring>

namespace tandem::robot {

namespace {

constexpr std::string_view kSpace = " \t\r\n";

std::string_view trim(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// The place behind the next `end`, or the text's end.
std::size_t after(std::string_view text, std::string_view end, std::size_t from) {
  const std::size_t at = text.find(end, from);
  return at == std::string_view::npos ? text.size() : at + end.size();
}

/// The place behind a tag that begins before `at`; its values may hold any character.
std::size_t after_tag(std::string_view text, std::size_t at) {
  while (at < text.size() && text[at] != '>') {
    const bool quote = text[at] == '"' || text[at] == '\'';
    at = quote ? after(text, text.substr(at, 1), at + 1) : at + 1;
  }
  return std::min(at + 1, text.size());
}

/// Where the elements of a well-formed text begin, in the order of the text: the parser keeps
/// lines but no columns.
std::vector<std::size_t> element_starts(std::string_view text) {
  std::vector<std::size_t> starts;
  std::size_t at = 0;
  while ((at = text.find('<', at)) < text.size()) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = after(text, "-->", at + 4);
    } else if (rest.starts_with("<![CDATA[")) {
      at = after(text, "]]>", at);
    } else if (rest.starts_with("<?")) {
      at = after(text, "?>", at);
    } else if (rest.starts_with("<!") || rest.starts_with("</")) {
      at = after(text, ">", at);
    } else {
      starts.push_back(at);
      at = after_tag(text, at);
    }
  }
  return starts;
}

int column_of(std::string_view text, std::size_t at) {
  const std::size_t line_end = at == 0 ? std::string_view::npos : text.rfind('\n', at - 1);
  return static_cast<int>(line_end == std::string_view::npos ? at + 1 : at - line_end);
}

/// The element after this one in the order of the text.
const tinyxml2::XMLElement* next_element(const tinyxml2::XMLElement* element) {
  if (const auto* child = element->FirstChildElement()) return child;
  while (element) {
    if (const auto* sibling = element->NextSiblingElement()) return sibling;
    element = element->Parent() ? element->Parent()->ToElement() : nullptr;
  }
  return nullptr;
}

/// ":LINE:COLUMN" of what the parser could not read: it tells the line only.
std::string error_place(std::string_view text, int line) {
  std::size_t begin = 0;
  for (int i = 1; i < line && begin < text.size(); ++i) begin = after(text, "\n", begin);
  const std::size_t word = std::min(text.find_first_not_of(" \t\r", begin), text.size());
  return ":" + std::to_string(std::max(line, 1)) + ":" + std::to_string(word - begin + 1);
}

}  // namespace

std::string XmlElement::tag() const { return element_->Name(); }

int XmlElement::line() const { return element_->GetLineNum(); }

std::string XmlElement::where() const {
  return source_->origin + ":" + std::to_string(line()) + ":" +
         std::to_string(source_->columns.at(element_));
}

void XmlElement::fail(const std::string& what, ErrorCode code) const {
  std::string place = where() + ": ";
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
  return XmlElement(*element, *source_);
}

XmlElement XmlElement::required_child(const char* tag) const {
  const auto element = child(tag);
  if (!element) fail(std::string("needs a <") + tag + "> element");
  return *element;
}

std::vector<XmlElement> XmlElement::children(const char* tag) const {
  std::vector<XmlElement> elements;
  for (const auto* e = element_->FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) {
    elements.emplace_back(*e, *source_);
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
    : source_{origin, {}}, document_(std::make_unique<tinyxml2::XMLDocument>()) {
  if (document_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    throw ReadFailure{
        {ErrorCode::kInvalidInput, origin + error_place(text, document_->ErrorLineNum()) +
                                       ": not well-formed XML (" + document_->ErrorName() + ")"}};
  }
  find_columns(text);
  const tinyxml2::XMLElement* element = document_->RootElement();
  if (!element || root != element->Name()) {
    throw ReadFailure{{ErrorCode::kInvalidInput,
                       origin +
                           (element ? ":" + std::to_string(element->GetLineNum()) + ":" +
                                          std::to_string(source_.columns.at(element))
                                    : ":1:1") +
                           ": expected the root element <" + root + ">, found " +
                           (element ? "<" + std::string(element->Name()) + ">" : "none")}};
  }
}

void XmlDocument::find_columns(const std::string& text) {
  const std::vector<std::size_t> starts = element_starts(text);
  std::size_t i = 0;
  for (const auto* e = document_->RootElement(); e; e = next_element(e), ++i) {
    // Both walks see the same tags of a well-formed text; the name says if ever they do not.
    const bool same =
        i < starts.size() && text.compare(starts[i] + 1, std::strlen(e->Name()), e->Name()) == 0;
    source_.columns[e] = same ? column_of(text, starts[i]) : 1;
  }
}

XmlDocument::~XmlDocument() = default;

XmlElement XmlDocument::root() const { return {*document_->RootElement(), source_}; }

}  // namespace tandem::robot
