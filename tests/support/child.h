#pragma once

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace mocurate::test {

/// Results of work in child processes.
struct Children {
  struct Death {
    std::size_t index = 0;
    int signal = 0;  ///< 0: it ended itself
  };
  std::vector<Death> deaths;
  long most_memory_kb = 0;
};

/// Calls work(0) to work(count - 1) in a child; when that dies, another continues after the call that killed it. A
/// child that runs longer than `seconds` is killed too.
inline Children InChildren(std::size_t count, unsigned seconds, const std::function<void(std::size_t)>& work) {
  Children children;
  auto* const at = static_cast<std::size_t*>(
      ::mmap(nullptr, sizeof(std::size_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  if (at == MAP_FAILED) {
    ADD_FAILURE() << "no shared memory";
    return children;
  }
  for (*at = 0; *at < count; ++*at) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::alarm(seconds);
      for (; *at < count; ++*at) work(*at);
      ::_exit(0);
    }
    int status = 0;
    rusage usage{};
    if (child < 0 || ::wait4(child, &status, 0, &usage) != child) {
      ADD_FAILURE() << "no child";
      break;
    }
    children.most_memory_kb = std::max(children.most_memory_kb, usage.ru_maxrss);
    if (*at < count) children.deaths.push_back({*at, WIFSIGNALED(status) ? WTERMSIG(status) : 0});
  }
  ::munmap(at, sizeof(std::size_t));
  return children;
}

}  // namespace mocurate::test
