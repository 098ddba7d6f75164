// Numbers and texts in the byte order of the controller's packets, read and written within bounds.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sandwright {

using Bytes = std::vector<uint8_t>;

// Reads values one after another. What would lie beyond the end is read as zero or as an empty text
// and ends `ok()` for good, so that a whole structure is read first and judged once.
class BigEndianReader {
 public:
  explicit BigEndianReader(std::span<const uint8_t> bytes) : rest_(bytes) {}

  uint8_t U8() { return static_cast<uint8_t>(Number(1)); }
  int8_t I8() { return static_cast<int8_t>(Number(1)); }
  uint16_t U16() { return static_cast<uint16_t>(Number(2)); }
  uint32_t U32() { return static_cast<uint32_t>(Number(4)); }
  int32_t I32() { return static_cast<int32_t>(Number(4)); }
  uint64_t U64() { return Number(8); }
  double F64();
  // `length` bytes; ones that are not printable ASCII become '?', as these texts end up in
  // terminals and logs.
  std::string Text(size_t length);
  std::string TextRest() { return Text(rest_.size()); }
  std::span<const uint8_t> Take(size_t length);

  size_t remaining() const { return rest_.size(); }
  bool ok() const { return ok_; }
  // Everything was there and nothing is left.
  bool complete() const { return ok_ && rest_.empty(); }

 private:
  uint64_t Number(size_t bytes);

  std::span<const uint8_t> rest_;
  bool ok_ = true;
};

class BigEndianWriter {
 public:
  void U8(uint8_t value) { Number(value, 1); }
  void U16(uint16_t value) { Number(value, 2); }
  void U32(uint32_t value) { Number(value, 4); }
  void I32(int32_t value) { Number(static_cast<uint32_t>(value), 4); }
  void U64(uint64_t value) { Number(value, 8); }
  void F64(double value);
  void Text(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }

  const Bytes& bytes() const { return bytes_; }

 private:
  void Number(uint64_t value, size_t bytes);

  Bytes bytes_;
};

}  // namespace sandwright
