// Files that are written whole or not at all: beside, fsync, rename.
#pragma once

#include <filesystem>
#include <string_view>

namespace sandwright {

// A temporary path beside `target` (same folder, so rename is atomic). Write to temporary(), then
// Commit(); without Commit the destructor removes it and `target` stays as it was.
// Throws Error (kBadInput) where the folder is missing or not writable.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }
  // Syncs the temporary file and its folder to disk and moves it over the target.
  void Commit();

 private:
  std::filesystem::path target_, temporary_;
  bool committed_ = false;
};

void WriteFileAtomically(const std::filesystem::path& target, std::string_view bytes);

// Whole content of a file. Throws Error naming the file where it cannot be read.
std::string ReadFile(const std::filesystem::path& file);

}  // namespace sandwright
