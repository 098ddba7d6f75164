// The built program as a user runs it.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace sandwright {

struct Finished {
  int exit_code;
  std::string output;  // stdout and stderr
};

// One line of sh.
inline Finished Shell(const std::string& line) {
  FILE* pipe = ::popen(("{ " + line + "; } 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), output};
}

// SANDWRIGHT_PROGRAM comes from CMake.
inline Finished Invoke(const std::string& arguments, const std::string& before = "",
                       const std::string& behind = "") {
  return Shell(before + SANDWRIGHT_PROGRAM " " + arguments + behind);
}

}  // namespace sandwright
