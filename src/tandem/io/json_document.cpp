#include <algorithm>
#include <cctype>
#include <iterator>
#include <optional>
#include <set>

#include "tandem/io/json_reader.h"
#include "tandem/io/text_file.h"

namespace tandem::io {

namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr int kMostLevels = 64;

/// Reads characters for the parser, and says how far it has come.
class Reading {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Reading(const char* at, const char*& furthest) : at_(at), furthest_(&furthest) {}
  reference operator*() const { return *at_; }
  Reading& operator++() {
    *furthest_ = ++at_;
    return *this;
  }
  Reading operator++(int) {
    const Reading before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Reading& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char** furthest_;
};

/// Refuses what the parser would take: a key that stands twice in one object, of which it would
/// keep the last silently, and nesting without end.
class Guard {
 public:
  bool operator()(int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > kMostLevels) {
      throw BadJson{"lists and objects are nested more than " + std::to_string(kMostLevels) +
                    " deep"};
    }
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(parsed.get<std::string>()).second) {
      throw BadJson{"key " + parsed.dump() + " stands twice in one object; keep one of them",
                    nullptr, true};
    }
    return true;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

/// Walks a document and its text side by side to where a value begins.
class PlaceFinder {
 public:
  PlaceFinder(const std::string& text, const BadJson& wanted) : text_(text), wanted_(wanted) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  }
  std::optional<std::size_t> find(const nlohmann::json& root) {
    if (wanted_.value && visit(root)) return found_;
    return std::nullopt;
  }

 private:
  void skip_space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  void skip_string() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    ++at_;
  }
  /// The next separator, or the end of the list or object; false at the end.
  bool next(char close) {
    skip_space();
    if (at_ < text_.size() && text_[at_] == ',') ++at_;
    skip_space();
    if (at_ < text_.size() && text_[at_] != close) return true;
    ++at_;
    return false;
  }

  bool visit(const nlohmann::json& value) {
    skip_space();
    if (&value == wanted_.value && !wanted_.at_key) {
      found_ = at_;
      return true;
    }
    if (value.is_object()) return visit_members(value);
    if (value.is_array()) return visit_items(value);
    if (value.is_string()) {
      skip_string();
    } else {
      at_ = std::min(text_.find_first_of(",]} \t\r\n", at_), text_.size());
    }
    return false;
  }
  bool visit_members(const nlohmann::json& object) {
    for (++at_; next('}');) {
      const std::size_t key = at_;
      skip_string();
      const auto name = nlohmann::json::parse(text_.substr(key, at_ - key)).get<std::string>();
      const nlohmann::json& member = object.at(name);
      if (&member == wanted_.value && wanted_.at_key) {
        found_ = key;
        return true;
      }
      skip_space();
      ++at_;  // The colon.
      if (visit(member)) return true;
    }
    return false;
  }
  bool visit_items(const nlohmann::json& array) {
    ++at_;
    for (std::size_t i = 0; next(']'); ++i) {
      if (visit(array.at(i))) return true;
    }
    return false;
  }

  const std::string& text_;
  const BadJson& wanted_;
  std::size_t at_ = 0, found_ = 0;
};

/// The parser's words without its own numbers: "syntax error while parsing value - ..."
std::string words_of(const nlohmann::json::exception& bad) {
  std::string what = bad.what();  // "[json.exception.parse_error.101] parse error at ...: ..."
  if (const std::size_t id = what.find("] "); id != std::string::npos) what.erase(0, id + 2);
  if (what.starts_with("parse error at")) {
    if (const std::size_t colon = what.find(": "); colon != std::string::npos) {
      what.erase(0, colon + 2);
    }
  }
  return what;
}

}  // namespace

Result<JsonDocument> JsonDocument::load(const std::filesystem::path& file) {
  Result<std::string> text = read_text(file, kMostBytes);
  if (!text) return std::unexpected(text.error());
  JsonDocument document;
  document.file_ = file.string();
  document.text_ = std::move(*text);
  const char* const begin = document.text_.data();
  const char* at = begin;  // One past the last character that the parser has seen.
  const auto refused = [&](const std::string& message, bool at_key = false) {
    auto last = static_cast<std::size_t>(std::max<std::ptrdiff_t>(at - begin - 1, 0));
    if (at_key) last = document.text_.rfind('"', last - 1);
    return fail(ErrorCode::kInvalidInput, place_in(document.file_, document.text_, last) + message);
  };
  try {
    const Reading first(begin, at), last(begin + document.text_.size(), at);
    document.json_ = nlohmann::json::parse(first, last, Guard());
    return document;
  } catch (const nlohmann::json::exception& bad) {
    return refused(": not JSON: " + words_of(bad));
  } catch (const BadJson& bad) {
    return refused(": " + bad.message, bad.at_key);
  }
}

Error JsonDocument::error(const BadJson& bad) const {
  const auto at = PlaceFinder(text_, bad).find(json_);
  return {ErrorCode::kInvalidInput,
          (at ? place_in(file_, text_, *at) : file_) + ": " + bad.message};
}

}  // namespace tandem::io
