// Scalars in TensorBoard's event files: TFRecords of Event protocol buffers, written by hand
// because two message types with five fields need no library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace sandwright {

// CRC-32C (Castagnoli, polynomial 0x1EDC6F41 reflected), as TFRecord frames use it.
uint32_t Crc32c(std::string_view bytes);

class TensorboardWriter {
 public:
  // Starts a new file in `folder`, named by the wall clock as TensorBoard orders files.
  // Throws Error where it cannot be written.
  explicit TensorboardWriter(const std::filesystem::path& folder);

  // One event with all `scalars` (tag, value) at `step`; on disk when the call returns.
  void Write(int64_t step, std::span<const std::pair<std::string, double>> scalars);
  // The same for a picture, PNG bytes of `width` x `height` pixels in colour.
  void WritePicture(int64_t step, const std::string& tag, int width, int height,
                    std::string_view png);

 private:
  void WriteSummary(int64_t step, const std::string& summary);
  void WriteRecord(const std::string& payload);

  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace sandwright
