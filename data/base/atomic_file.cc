#include "data/base/atomic_file.h"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "data/base/error.h"

namespace sandwright {
namespace {

[[noreturn]] void Fail(const std::string& what, const std::filesystem::path& path) {
  throw Error(what + " " + path.string() + ": " + std::strerror(errno));
}

void Sync(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags);
  if (descriptor < 0) Fail("cannot open", path);
  const int result = ::fsync(descriptor);
  ::close(descriptor);
  if (result != 0) Fail("cannot sync", path);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  static std::atomic<unsigned> serial{0};
  const auto folder = target_.has_parent_path() ? target_.parent_path() : ".";
  if (std::filesystem::is_directory(target_))
    throw Error("cannot write " + target_.string() + ": it is a folder");
  // The suffix keeps the target's extension last: writers that choose a format by it still work.
  temporary_ = folder / fmt::format(".{}.{}-{}.part{}", target_.stem().string(), ::getpid(),
                                    serial++, target_.extension().string());
  const int descriptor = ::open(temporary_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
  if (descriptor < 0) Fail("cannot write", target_);
  ::close(descriptor);
}

AtomicFile::~AtomicFile() {
  if (!committed_) ::unlink(temporary_.c_str());
}

void AtomicFile::Commit() {
  Sync(temporary_, O_RDONLY);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) Fail("cannot replace", target_);
  committed_ = true;
  Sync(target_.has_parent_path() ? target_.parent_path() : ".", O_RDONLY | O_DIRECTORY);
}

void WriteFileAtomically(const std::filesystem::path& target, std::string_view bytes) {
  AtomicFile file(target);
  {
    std::ofstream out(file.temporary(), std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) Fail("cannot write", target);
  }
  file.Commit();
}

std::string ReadFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file)) {
    if (!std::filesystem::exists(file))
      throw Error("cannot read " + file.string() + ": no such file");
    Fail("cannot read", file);
  }
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return std::move(bytes).str();
}

}  // namespace sandwright
