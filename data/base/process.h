// Another program, run as a child and waited for.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sandwright {

// Full path of a program on PATH; none where it is not installed.
std::optional<std::filesystem::path> FindProgram(const std::string& name);

// Runs words[0] with its arguments in `folder` until it ends; its output goes to `folder`/output.txt.
// Returns its exit status (128 + signal where a signal ended it). Where `stop` says so, the program
// and its own children are killed and Error (kInterrupted) is thrown.
// Throws Error where it cannot be started.
int RunProgram(const std::vector<std::string>& words, const std::filesystem::path& folder,
               const std::function<bool()>& stop);

// A folder of its own under the system's place for temporary files, removed with all it holds.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace sandwright
