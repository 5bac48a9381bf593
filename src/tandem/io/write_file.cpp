#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "tandem/io/plan_file.h"

namespace tandem::io {

namespace fs = std::filesystem;

namespace {

std::unexpected<Error> io_error(const fs::path& file, int code) {
  return fail(ErrorCode::kIo,
              "cannot write " + file.string() + ": " + std::generic_category().message(code));
}

/// Writes and syncs everything, or returns errno.
int write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return ::fsync(descriptor) == 0 ? 0 : errno;
}

/// `file`, or what it points to: a rename would replace the link itself.
fs::path behind_links(const fs::path& file) {
  std::error_code ignored;  // A link that points nowhere is answered by the checks.
  const fs::path target = fs::is_symlink(file, ignored) ? fs::canonical(file, ignored) : file;
  return target.empty() ? file : target;
}

}  // namespace

Result<void> check_writable(const fs::path& file, bool overwrite) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (status.type() == fs::file_type::none) return io_error(file, error.value());
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return fail(ErrorCode::kInvalidInput, file.string() + " is not a regular file; name another");
  }
  if (fs::exists(status) && !overwrite) {
    return fail(ErrorCode::kInvalidInput,
                file.string() + " exists; name another file, or allow overwriting (--force)");
  }
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::kIo, "cannot write " + file.string() + ": there is no folder " +
                                    folder.string() + "; create it first");
  }
  return {};
}

Result<void> write_file(const fs::path& file, const std::string& text, bool overwrite) {
  if (auto writable = check_writable(file, overwrite); !writable) return writable;
  const fs::path target = behind_links(file);
  fs::path temporary = target;
  temporary += ".tmp" + std::to_string(::getpid());
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return io_error(temporary, errno);
  int error = write_all(descriptor, text);
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error == 0) return {};
  ::unlink(temporary.c_str());
  return io_error(file, error);
}

}  // namespace tandem::io
