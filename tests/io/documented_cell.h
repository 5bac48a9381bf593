#pragma once
/// The workcell of docs/workcell.md, and ways to spoil it.

#include "tandem/io/workcell_yaml.h"
#include "workcell_files.h"

namespace tandem::test {

/// Replaces the only occurrence of `from`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "no '" << from << "'";
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "'" << from << "' is not unique";
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline std::string line_of(const std::string& text, const std::string& what) {
  const auto at = static_cast<std::ptrdiff_t>(text.find(what));
  return std::to_string(1 + std::count(text.begin(), text.begin() + at, '\n'));
}

struct Fault {
  std::string from, to;  ///< Spoils the documented cell.
  std::string at;        ///< Its line has the fault; empty: no line is asked for.
  std::vector<std::string> says;
  ErrorCode code = ErrorCode::kInvalidInput;
};

inline constexpr ErrorCode kAbsent = ErrorCode::kNotFound;

// The page that users read is the test's input: it cannot go stale.
class DocumentedCell : public ::testing::Test {
 protected:
  DocumentedCell() : text_(documented_yaml().at(0)) { write_robots(folder_); }

  Result<std::shared_ptr<const world::Workcell>> load(const std::string& text) {
    return io::load_workcell(folder_.write("cell.yaml", text));
  }

  void expect_refused(const Fault& fault) {
    SCOPED_TRACE(fault.from + " -> " + fault.to);
    const std::string text = with(text_, fault.from, fault.to);
    const auto loaded = load(text);
    ASSERT_FALSE(loaded);
    const std::string& message = loaded.error().message;
    EXPECT_EQ(loaded.error().code, fault.code) << message;
    std::string place = (folder_ / "cell.yaml").string();
    if (!fault.at.empty()) place.append(":").append(line_of(text, fault.at)).append(":");
    EXPECT_EQ(message.find(place), 0u) << message << "\n  expected at " << place;
    for (const std::string& said : fault.says) {
      EXPECT_NE(message.find(said), std::string::npos) << "'" << said << "' is not in: " << message;
    }
  }

  TemporaryFolder folder_;
  std::string text_;
};

}  // namespace tandem::test
