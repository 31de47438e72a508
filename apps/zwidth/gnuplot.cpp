#include "gnuplot.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "context.h"

extern char** environ;

namespace zwidth {

namespace {

/// A file in memory, closed at the end.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : fd_(memfd_create(name, MFD_CLOEXEC)) {
    if (fd_ < 0) throw MachineError(fmt::format("cannot make a file in memory: {}", std::strerror(errno)));
  }
  ~MemoryFile() { close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int fd() const { return fd_; }

  void write(const std::string& text) const {
    for (size_t done = 0; done < text.size();) {
      const ssize_t count = ::write(fd_, text.data() + done, text.size() - done);
      if (count <= 0) throw MachineError(fmt::format("cannot write to memory: {}", std::strerror(errno)));
      done += static_cast<size_t>(count);
    }
    lseek(fd_, 0, SEEK_SET);
  }

  std::string read() const {
    std::string text;
    char buffer[4096];
    lseek(fd_, 0, SEEK_SET);
    for (ssize_t count = 0; (count = ::read(fd_, buffer, sizeof buffer)) > 0;)
      text.append(buffer, static_cast<size_t>(count));
    return text;
  }

 private:
  int fd_;
};

}  // namespace

void run_gnuplot(const std::string& script) {
  const MemoryFile input("gnuplot script");
  const MemoryFile messages("gnuplot messages");
  input.write(script);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.fd(), 0);
  posix_spawn_file_actions_adddup2(&actions, messages.fd(), 1);
  posix_spawn_file_actions_adddup2(&actions, messages.fd(), 2);
  std::string name = "gnuplot";
  char* argv[] = {name.data(), nullptr};
  pid_t pid = 0;
  const int failure = posix_spawnp(&pid, "gnuplot", &actions, nullptr, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure == ENOENT) throw MachineError("gnuplot is missing; install it with: apt-get install gnuplot-nox");
  if (failure != 0) throw MachineError(fmt::format("cannot start gnuplot: {}", std::strerror(failure)));
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw MachineError(fmt::format("gnuplot failed: {}", messages.read()));
  }
}

}  // namespace zwidth
