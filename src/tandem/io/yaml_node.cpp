#include "tandem/io/yaml_node.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "tandem/core/contract.h"
#include "tandem/core/file.h"
#include "tandem/core/names.h"

namespace tandem::io {

namespace {

/// Aliases of aliases grow exponentially, and destruction recurses; no honest file comes near.
constexpr std::size_t kMostNodes = 1'000'000;
constexpr std::size_t kMostLevels = 100;

std::string quote(std::string_view text) { return std::string("'").append(text).append("'"); }

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

/// Builds the tree from the parser's events.
class YamlTreeBuilder final : public YAML::EventHandler {
 public:
  explicit YamlTreeBuilder(const std::string& file)
      : file_(std::make_shared<const std::string>(file)) {}

  /// The tree, once the parser is done.
  YamlNode finish() {
    label(root_, "the file");
    return std::move(root_);
  }
  const YamlNode& root() const { return root_; }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(mark, "", YamlNode::Kind::kNull), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode node = make(mark, tag, YamlNode::Kind::kScalar);
    node.scalar_ = value;
    add(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    const YamlNode here = make(mark, "", YamlNode::Kind::kNull);
    if (found == anchors_.end()) here.refuse("an alias inside its own anchor; write the value out");
    total_ += found->second.size_;
    if (total_ > kMostNodes) here.refuse("the aliases expand to over a million entries");
    add(found->second, 0);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back({make(mark, tag, YamlNode::Kind::kList), anchor, {}});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back({make(mark, tag, YamlNode::Kind::kMap), anchor, {}});
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YamlNode node;
    YAML::anchor_t anchor;
    std::vector<YamlNode::Key> key;  // The one that waits for its value.
  };

  YamlNode make(const YAML::Mark& mark, const std::string& tag, YamlNode::Kind kind) {
    YamlNode node;
    node.kind_ = kind;
    node.file_ = file_;
    node.line_ = mark.line + 1;
    node.column_ = mark.column + 1;
    // "?" is a plain and "!" a quoted scalar without a tag.
    if (!tag.empty() && tag != "?" && tag != "!") {
      node.refuse("the tag " + quote(tag) + " is not supported; remove it");
    }
    if (++total_ > kMostNodes) node.refuse("the file has over a million entries");
    return node;
  }

  void close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    add(std::move(done.node), done.anchor);
  }

  void add(YamlNode node, YAML::anchor_t anchor) {
    if (anchor != 0) anchors_[anchor] = node;
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    if (open_.size() + node.levels_ > kMostLevels) node.refuse("the file is nested too deeply");
    Open& parent = open_.back();
    if (parent.node.kind_ == YamlNode::Kind::kMap && parent.key.empty()) {
      parent.key.push_back(as_key(parent.node, node));
      return;
    }
    if (parent.node.kind_ == YamlNode::Kind::kMap) {
      const YamlNode::Key& key = parent.key.back();
      // The parser places what is absent at the next token, lines below.
      if (node.kind_ == YamlNode::Kind::kNull) {
        node.line_ = key.line;
        node.column_ = key.column;
      }
      parent.node.keys_.push_back(key);
      parent.key.clear();
    }
    parent.node.size_ += node.size_;
    parent.node.levels_ = std::max(parent.node.levels_, node.levels_ + 1);
    parent.node.children_.push_back(std::move(node));
  }

  static YamlNode::Key as_key(const YamlNode& map, const YamlNode& node) {
    if (node.kind_ != YamlNode::Kind::kScalar || node.scalar_.empty()) {
      node.refuse("a key must be a word");
    }
    const auto same = std::ranges::find(map.keys_, node.scalar_, &YamlNode::Key::name);
    if (same != map.keys_.end()) {
      node.refuse("the key " + quote(node.scalar_) + " is repeated (first in line " +
                  std::to_string(same->line) + "); keep one");
    }
    return {node.scalar_, node.line_, node.column_};
  }

  static void label(YamlNode& node, const std::string& name) {
    node.label_ = name;
    for (std::size_t i = 0; i < node.children_.size(); ++i) {
      label(node.children_[i], node.kind_ == YamlNode::Kind::kMap
                                   ? node.keys_[i].name
                                   : name + '[' + std::to_string(i) + ']');
    }
  }

  YamlNode root_;
  std::shared_ptr<const std::string> file_;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNode> anchors_;
  std::size_t total_ = 0;
};

YamlNode YamlNode::load(const std::filesystem::path& file) {
  const auto stop = [&](ErrorCode code, const std::string& message) {
    throw YamlError{{code, file.string() + ": " + message}};
  };
  std::istringstream content(take(read_file(file)));
  YamlTreeBuilder builder(file.string());
  try {
    YAML::Parser parser(content);
    if (!parser.HandleNextDocument(builder)) stop(ErrorCode::kInvalidInput, "the file is empty");
    YamlTreeBuilder second(file.string());
    if (parser.HandleNextDocument(second)) {
      second.root().refuse("a second document begins; keep one per file");
    }
  } catch (const YAML::Exception& error) {
    std::string place;
    if (!error.mark.is_null()) {
      place.append(":").append(std::to_string(error.mark.line + 1));
      place.append(":").append(std::to_string(error.mark.column + 1));
    }
    throw YamlError{{ErrorCode::kInvalidInput, file.string() + place + ": not YAML: " + error.msg}};
  }
  return builder.finish();
}

std::string YamlNode::place(int line, int column) const {
  return *file_ + ":" + std::to_string(line) + ":" + std::to_string(column);
}

std::string YamlNode::where() const { return place(line_, column_); }

void YamlNode::refuse(const std::string& message, ErrorCode code) const {
  throw YamlError{{code, where() + ": " + message}};
}

void YamlNode::refuse_key(std::string_view key, const std::string& message, ErrorCode code) const {
  const auto found = std::ranges::find(keys_, key, &Key::name);
  expects(found != keys_.end(), "the key is one of the map's");
  throw YamlError{{code, place(found->line, found->column) + ": " + message}};
}

const char* YamlNode::kind_name() const {
  switch (kind_) {
    case Kind::kNull:
      return "nothing";
    case Kind::kScalar:
      return "a single value";
    case Kind::kList:
      return "a list";
    case Kind::kMap:
      return "a map of keys";
  }
  return "unknown";
}

void YamlNode::expect(Kind kind, const char* name) const {
  if (kind_ != kind) refuse(label_ + " must be " + name + ", it is " + kind_name());
}

void YamlNode::only(const std::vector<std::string>& known) const {
  expect(Kind::kMap, "a map of keys");
  for (const Key& key : keys_) {
    if (std::ranges::find(known, key.name) != known.end()) continue;
    refuse_key(key.name, "unknown key " + quote(key.name) + name_hint(key.name, known));
  }
}

const YamlNode* YamlNode::find(std::string_view key) const {
  expect(Kind::kMap, "a map of keys");
  const auto found = std::ranges::find(keys_, key, &Key::name);
  return found == keys_.end() ? nullptr
                              : &children_[static_cast<std::size_t>(found - keys_.begin())];
}

const YamlNode& YamlNode::at(std::string_view key) const {
  if (const YamlNode* child = find(key)) return *child;
  refuse("the key " + quote(key) + " is missing; add it");
}

const std::string& YamlNode::one_of(const std::vector<std::string>& choices) const {
  const std::string* chosen = nullptr;
  for (const std::string& choice : choices) {
    if (!find(choice)) continue;
    if (chosen) {
      refuse_key(choice,
                 "both " + quote(*chosen) + " and " + quote(choice) + " are given; keep one");
    }
    chosen = &choice;
  }
  if (!chosen) refuse("one of these keys is needed: " + listed(choices));
  return *chosen;
}

std::vector<std::pair<std::string, const YamlNode*>> YamlNode::entries() const {
  expect(Kind::kMap, "a map of keys");
  std::vector<std::pair<std::string, const YamlNode*>> all;
  for (std::size_t i = 0; i < keys_.size(); ++i) all.emplace_back(keys_[i].name, &children_[i]);
  return all;
}

const std::vector<YamlNode>& YamlNode::items() const {
  expect(Kind::kList, "a list");
  return children_;
}

std::string YamlNode::text() const {
  expect(Kind::kScalar, "a word");
  if (scalar_.empty()) refuse(label_ + " must not be empty");
  return scalar_;
}

double YamlNode::number() const {
  expect(Kind::kScalar, "a number");
  // std::from_chars reads the same in every locale; it knows no leading plus.
  const char* begin = scalar_.data();
  const char* end = begin + scalar_.size();
  if (begin + 1 < end && *begin == '+' && begin[1] != '-') ++begin;
  double value = 0;
  const auto [rest, error] = std::from_chars(begin, end, value);
  if (error != std::errc{} || rest != end) {
    refuse(label_ + " is " + quote(scalar_) + ", it must be a number");
  }
  if (!std::isfinite(value)) refuse(label_ + " is " + quote(scalar_) + ", it must be finite");
  return value;
}

double YamlNode::positive() const {
  const double value = number();
  if (value <= 0) refuse(label_ + " is " + scalar_ + ", it must be above 0");
  return value;
}

double YamlNode::not_negative() const {
  const double value = number();
  if (value < 0) refuse(label_ + " is " + scalar_ + ", it must not be negative");
  return value;
}

Eigen::VectorXd YamlNode::numbers() const {
  expect(Kind::kList, "a list of numbers");
  Eigen::VectorXd values(static_cast<Eigen::Index>(children_.size()));
  for (std::size_t i = 0; i < children_.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] = children_[i].number();
  }
  return values;
}

Eigen::VectorXd YamlNode::numbers(Eigen::Index count) const {
  const Eigen::VectorXd values = numbers();
  if (values.size() != count) {
    refuse(label_ + " has " + std::to_string(values.size()) + " numbers, it must have " +
           std::to_string(count));
  }
  return values;
}

}  // namespace tandem::io
