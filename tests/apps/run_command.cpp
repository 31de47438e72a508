#include "run_command.h"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace zwidth::testing {

namespace {

int memory_file(const std::string& contents) {
  const int fd = memfd_create("stream", MFD_CLOEXEC);
  if (fd < 0 || ::write(fd, contents.data(), contents.size()) != static_cast<ssize_t>(contents.size())) {
    throw std::runtime_error("no memory file");
  }
  lseek(fd, 0, SEEK_SET);
  return fd;
}

std::string contents_of(int fd) {
  std::string text;
  char buffer[65536];
  lseek(fd, 0, SEEK_SET);
  for (ssize_t count = 0; (count = ::read(fd, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<size_t>(count));
  return text;
}

}  // namespace

Outcome run(const std::vector<std::string>& arguments, const RunOptions& options) {
  const int in = memory_file(options.input);
  const int out =
      options.output_file.empty() ? memory_file("") : open(options.output_file.c_str(), O_WRONLY | O_CLOEXEC);
  const int err = memory_file("");
  std::vector<std::string> words = options.launcher;
  words.emplace_back(ZWIDTH_COMMAND);
  words.insert(words.end(), arguments.begin(), arguments.end());
  // The first of two variables with one name counts.
  std::vector<std::string> variables = options.environment;
  variables.push_back("LANG=C.UTF-8");
  for (const char* name : {"PATH", "HOME", "ASAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"}) {
    if (const char* value = std::getenv(name)) variables.push_back(std::string(name) + "=" + value);
  }
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::vector<char*> environment;
  for (std::string& variable : variables) environment.push_back(variable.data());
  environment.push_back(nullptr);
  const pid_t pid = fork();
  if (pid == 0) {
    dup2(in, 0);
    dup2(out, 1);
    dup2(err, 2);
    if (!options.directory.empty() && chdir(options.directory.c_str()) != 0) _exit(126);
    execve(argv.front(), argv.data(), environment.data());
    _exit(127);
  }
  int status = 0;
  bool ended = false;
  while (options.signal != 0 && !ended) {
    ended = waitpid(pid, &status, WNOHANG) == pid;
    if (!ended && options.signal_when()) {
      kill(pid, options.signal);
      break;
    }
    if (!ended) usleep(1000);
  }
  if (!ended) waitpid(pid, &status, 0);
  Outcome outcome;
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (options.output_file.empty()) outcome.out = contents_of(out);
  outcome.err = contents_of(err);
  close(in);
  close(out);
  close(err);
  return outcome;
}

ScratchDirectory::ScratchDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "zwidth-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  path_ = name;
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string ScratchDirectory::file(const std::string& name, const std::string& contents) const {
  const auto path = path_ / name;
  std::ofstream(path, std::ios::binary) << contents;
  return path.string();
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace zwidth::testing
