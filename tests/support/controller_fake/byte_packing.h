// Big-endian packing of the fake's own: it shares no codec with the client it tests.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace sandwright::fake {

class ByteWriter {
 public:
  ByteWriter& U8(uint8_t value) { return Unsigned(value, 1); }
  ByteWriter& U16(uint16_t value) { return Unsigned(value, 2); }
  ByteWriter& U32(uint32_t value) { return Unsigned(value, 4); }
  ByteWriter& I32(int32_t value) { return Unsigned(static_cast<uint32_t>(value), 4); }
  ByteWriter& U64(uint64_t value) { return Unsigned(value, 8); }
  ByteWriter& F32(float value) { return Unsigned(std::bit_cast<uint32_t>(value), 4); }
  ByteWriter& F64(double value) { return Unsigned(std::bit_cast<uint64_t>(value), 8); }
  template <class Vector>
  ByteWriter& F64s(const Vector& values) {
    for (const double value : values) F64(value);
    return *this;
  }
  ByteWriter& Text(std::string_view text) {
    bytes_ += text;
    return *this;
  }
  // One length byte before the text, which is cut at 255.
  ByteWriter& ShortText(std::string_view text) {
    const auto cut = text.substr(0, 255);
    return U8(static_cast<uint8_t>(cut.size())).Text(cut);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  ByteWriter& Unsigned(uint64_t value, int size) {
    for (int shift = 8 * (size - 1); shift >= 0; shift -= 8)
      bytes_ += static_cast<char>(value >> shift & 0xff);
    return *this;
  }

  std::string bytes_;
};

// Reads what is there; behind the end all values are zero and ok() is false.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  uint8_t U8() { return static_cast<uint8_t>(Unsigned(1)); }
  uint16_t U16() { return static_cast<uint16_t>(Unsigned(2)); }
  uint32_t U32() { return static_cast<uint32_t>(Unsigned(4)); }
  int32_t I32() { return static_cast<int32_t>(U32()); }
  double F64() { return std::bit_cast<double>(Unsigned(8)); }
  std::string_view Rest() { return std::exchange(bytes_, {}); }
  bool ok() const { return ok_; }
  bool AtEnd() const { return bytes_.empty(); }

 private:
  uint64_t Unsigned(size_t size) {
    if (bytes_.size() < size) {
      ok_ = false;
      return 0;
    }
    uint64_t value = 0;
    for (size_t i = 0; i < size; ++i) value = value << 8 | static_cast<uint8_t>(bytes_[i]);
    bytes_.remove_prefix(size);
    return value;
  }

  std::string_view bytes_;
  bool ok_ = true;
};

}  // namespace sandwright::fake
