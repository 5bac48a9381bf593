#include "tandem/io/named_path.h"

#include <cstdlib>

namespace tandem::io {

namespace fs = std::filesystem;

Result<std::string> expand_variable(const std::string& text) {
  if (!text.starts_with('$')) return text;
  const bool braced = text.starts_with("${");
  const std::size_t begin = braced ? 2 : 1;
  const std::size_t end = text.find(braced ? '}' : '/', begin);
  const std::string name = text.substr(begin, end == std::string::npos ? end : end - begin);
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
  if (name.empty() || name.find_first_not_of(kLetters) != std::string::npos ||
      (braced && end == std::string::npos)) {
    return fail(ErrorCode::kInvalidInput,
                "'" + text +
                    "' begins with '$' but with no variable; "
                    "write $NAME/PATH, or ./$... for a folder of that name");
  }
  const char* value = std::getenv(name.c_str());
  if (!value || !*value) {
    return fail(ErrorCode::kNotFound, "'" + text + "' begins with the environment variable " +
                                          name + ", which is not set; set it to the folder that " +
                                          "is meant (export " + name + "=FOLDER)");
  }
  if (end == std::string::npos) return std::string(value);
  return value + text.substr(end + (braced ? 1 : 0));
}

fs::path NamedPaths::find(const YamlNode& node, bool folder) const {
  const std::string text = node.check(expand_variable(node.text()));
  const bool variable = node.text().starts_with('$');
  std::error_code ignored;
  fs::path path;
  if (text.find("://") != std::string::npos) {
    path = node.check(packages_.resolve(text, folder_));
  } else {
    // A variable is set in a shell: what it says holds from the current folder, as for any program.
    path = ((variable ? fs::current_path(ignored) : folder_) / text).lexically_normal();
  }
  if (!fs::exists(path, ignored)) {
    node.refuse(
        node.label() + ": there is no '" + path.string() +
            (variable ? "' (a relative value of a variable is relative to the current folder)"
                      : "' (paths are relative to the file that names them)"),
        ErrorCode::kNotFound);
  }
  if (fs::is_directory(path, ignored) != folder) {
    node.refuse(node.label() + ": '" + path.string() + "' is " +
                (folder ? "not a folder" : "a folder, not a file"));
  }
  return path;
}

}  // namespace tandem::io
