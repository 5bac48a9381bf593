#include <charconv>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/io/plan_file.h"

namespace tandem::io {

namespace {

/// Shortest text that reads back as the same double.
void append(std::string& text, double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof(digits), value);
  text.append(digits, end.ptr);
}

/// A field of the header; quoted where RFC 4180 asks for it.
std::string field(const std::string& name) {
  if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

void append_row(std::string& text, double t, const motion::JointState& state) {
  append(text, t);
  for (Eigen::Index j = 0; j < state.q.size(); ++j) {
    for (const double value : {state.q[j], state.qd[j], state.qdd[j]}) {
      text += ',';
      append(text, value);
    }
  }
  text += '\n';
}

}  // namespace

Result<void> save_csv(const std::filesystem::path& file, const motion::Motion& motion,
                      const std::vector<std::string>& joint_names, double rate, bool overwrite) {
  expects(static_cast<int>(joint_names.size()) == motion.dof(), "one name per joint");
  constexpr double kHighestRate = 1e6;
  if (!(rate > 0 && rate <= kHighestRate)) {
    std::string message = "rate ";
    append(message, rate);
    return fail(ErrorCode::kInvalidInput, message + " Hz: must be above 0 and at most 1e6");
  }
  if (auto writable = check_writable(file, overwrite); !writable) return writable;
  std::string text = "t";
  for (const std::string& name : joint_names) {
    for (const char* quantity : {".q", ".qd", ".qdd"}) text += ',' + field(name + quantity);
  }
  text += '\n';
  // A sample that rounding puts just before the end would double the last row.
  const double samples = std::ceil(motion.duration() * rate - 1e-9);
  for (double k = 0; k < samples; ++k) append_row(text, k / rate, motion.at(k / rate));
  append_row(text, motion.duration(), motion.at(motion.duration()));
  return write_file(file, text, overwrite);
}

}  // namespace tandem::io
