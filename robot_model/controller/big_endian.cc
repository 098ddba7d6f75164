#include "robot_model/controller/big_endian.h"

#include <bit>

namespace sandwright {

std::span<const uint8_t> BigEndianReader::Take(size_t length) {
  if (length > rest_.size()) {
    ok_ = false;
    rest_ = {};
    return {};
  }
  const auto taken = rest_.first(length);
  rest_ = rest_.subspan(length);
  return taken;
}

uint64_t BigEndianReader::Number(size_t bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : Take(bytes)) value = value << 8 | byte;
  return value;
}

double BigEndianReader::F64() { return std::bit_cast<double>(Number(8)); }

std::string BigEndianReader::Text(size_t length) {
  std::string text;
  for (const uint8_t byte : Take(length))
    text += byte >= 0x20 && byte < 0x7f ? static_cast<char>(byte) : '?';
  return text;
}

void BigEndianWriter::Number(uint64_t value, size_t bytes) {
  for (size_t i = bytes; i-- > 0;) bytes_.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

void BigEndianWriter::F64(double value) { Number(std::bit_cast<uint64_t>(value), 8); }

}  // namespace sandwright
