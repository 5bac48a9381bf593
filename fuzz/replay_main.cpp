// Runs a fuzz target without libFuzzer: every file of a corpus, then seeded mutations of them.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstring>
#include <iterator>
#include <span>
#include <vector>

#include "support.h"
#include "tandem/core/rng.h"

namespace {

namespace fs = std::filesystem;
using tandem::Rng;

constexpr unsigned kLongest = 20;  // [s] for one input.
constexpr const char* kCrashFile = "fuzz_crash_input";

// What runs now, for the handler of signals: it may not ask anyone.
std::string_view running;

extern "C" void keep_input(int signal) {
  const int file = open(kCrashFile, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0) {
    [[maybe_unused]] const auto written = write(file, running.data(), running.size());
    close(file);
  }
  const char text[] = "fuzz replay: this input crashed or took too long: ./fuzz_crash_input\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof(text) - 1);
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void run(const std::string& input) {
  running = input;
  alarm(kLongest);
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  alarm(0);
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> read_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);  // So that a seed means the same everywhere.
  std::vector<std::string> inputs;
  for (const fs::path& file : files) inputs.push_back(read(file));
  return inputs;
}

/// Puts a number that somebody did not think of in place of one of the text.
void replace_number(std::string& text, Rng& rng) {
  const char* const odd[] = {"nan",
                             "inf",
                             "-1",
                             "0",
                             "1e308",
                             "-1e-320",
                             "1e999",
                             "1.5",
                             "4294967295",
                             "2147483648",
                             "18446744073709551616",
                             "-0",
                             "",
                             "0x10"};
  constexpr const char* kDigits = "0123456789.+-eE";
  const std::size_t from = text.find_first_of("0123456789", rng.index(text.size()));
  if (from == std::string::npos) return;
  const std::size_t end = std::min(text.find_first_not_of(kDigits, from), text.size());
  text.replace(from, end - from, odd[rng.index(std::size(odd))]);
}

void mutate(std::string& input, const std::vector<std::string>& corpus, Rng& rng) {
  if (input.empty()) return;
  const std::size_t at = rng.index(input.size());
  const std::size_t length = 1 + rng.index(std::min<std::size_t>(input.size() - at, 64));
  switch (rng.index(6)) {
    case 0:
      input[at] = static_cast<char>(rng.index(256));
      break;
    case 1:
      input[at] = static_cast<char>(input[at] ^ (1 << rng.index(8)));
      break;
    case 2:
      input.resize(at);
      break;
    case 3:
      input.insert(rng.index(input.size()), input.substr(at, length));
      break;
    case 4:
      input.erase(at, length);
      break;
    default:
      replace_number(input, rng);
  }
  const std::string& other = corpus[rng.index(corpus.size())];
  if (rng.index(12) == 0 && !other.empty()) input += other.substr(rng.index(other.size()));
}

}  // namespace

int main(int count, char** values) {
  const std::span<char*> arguments(values, static_cast<std::size_t>(count));
  std::size_t mutations = 0;
  if (arguments.size() == 3) {
    const char* end = arguments[2] + std::strlen(arguments[2]);
    if (std::from_chars(arguments[2], end, mutations).ptr != end) mutations = 0;
  }
  if (arguments.size() != 3 || !fs::is_directory(arguments[1])) {
    std::fprintf(stderr, "usage: %s CORPUS_FOLDER MUTATIONS\n", arguments[0]);
    return 2;
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGFPE, SIGBUS, SIGALRM}) {
    std::signal(signal, keep_input);
  }
  const std::vector<std::string> corpus = read_folder(arguments[1]);
  if (corpus.empty()) {
    std::fprintf(stderr, "%s: no files\n", arguments[1]);
    return 2;
  }
  for (const std::string& input : corpus) run(input);
  Rng rng(77);
  for (std::size_t i = 0; i < mutations; ++i) {
    std::string input = corpus[i % corpus.size()];
    for (std::size_t k = 1 + rng.index(4); k > 0; --k) mutate(input, corpus, rng);
    run(input);
  }
  std::printf("%zu files and %zu mutations of them\n", corpus.size(), mutations);
  return 0;
}
