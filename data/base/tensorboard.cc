#include "data/base/tensorboard.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <bit>
#include <chrono>

#include "data/base/error.h"

namespace sandwright {
namespace {

double WallTime_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

constexpr std::array<uint32_t, 256> CrcTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t i = 0; i < table.size(); ++i) {
    uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ (c & 1 ? 0x82F63B78u : 0u);
    table[i] = c;
  }
  return table;
}

// Numbers in little-endian order.
template <class T>
std::string Raw(T value) {
  static_assert(std::endian::native == std::endian::little);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string Varint(uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
  return bytes + static_cast<char>(value);
}

// Protocol buffer fields by wire type: 0 varint, 1 eight bytes, 2 length and bytes, 5 four bytes.
std::string Key(int field, int wire_type) {
  return Varint(static_cast<uint64_t>(field << 3 | wire_type));
}
std::string Bytes(int field, std::string_view value) {
  return Key(field, 2) + Varint(value.size()) + std::string(value);
}

uint32_t MaskedCrc(std::string_view bytes) {
  const uint32_t crc = Crc32c(bytes);
  return std::rotr(crc, 15) + 0xa282ead8u;
}

}  // namespace

uint32_t Crc32c(std::string_view bytes) {
  static constexpr auto kTable = CrcTable();
  uint32_t crc = ~0u;
  for (const char byte : bytes)
    crc = (crc >> 8) ^ kTable[(crc ^ static_cast<unsigned char>(byte)) & 0xff];
  return ~crc;
}

TensorboardWriter::TensorboardWriter(const std::filesystem::path& folder) {
  const auto now = static_cast<int64_t>(WallTime_s());
  for (int serial = 0; file_.empty() || std::filesystem::exists(file_); ++serial)
    file_ = folder / fmt::format("events.out.tfevents.{:010}.sandwright.{}", now, serial);
  out_.open(file_, std::ios::binary);
  // Event: wall_time = 1, step = 2, file_version = 3, summary = 5.
  WriteRecord(Key(1, 1) + Raw(WallTime_s()) + Bytes(3, "brain.Event:2"));
}

void TensorboardWriter::Write(int64_t step,
                              std::span<const std::pair<std::string, double>> scalars) {
  std::string summary;  // Summary: repeated Value = 1 {tag = 1, simple_value = 2}
  for (const auto& [tag, value] : scalars)
    summary += Bytes(1, Bytes(1, tag) + Key(2, 5) + Raw(static_cast<float>(value)));
  WriteSummary(step, summary);
}

void TensorboardWriter::WritePicture(int64_t step, const std::string& tag, int width, int height,
                                     std::string_view png) {
  constexpr uint64_t kRgb = 3;
  // Value: tag = 1, image = 4 {height = 1, width = 2, colorspace = 3, encoded_image_string = 4}
  const std::string image = Key(1, 0) + Varint(static_cast<uint64_t>(height)) + Key(2, 0) +
                            Varint(static_cast<uint64_t>(width)) + Key(3, 0) + Varint(kRgb) +
                            Bytes(4, png);
  WriteSummary(step, Bytes(1, Bytes(1, tag) + Bytes(4, image)));
}

void TensorboardWriter::WriteSummary(int64_t step, const std::string& summary) {
  WriteRecord(Key(1, 1) + Raw(WallTime_s()) + Key(2, 0) + Varint(static_cast<uint64_t>(step)) +
              Bytes(5, summary));
}

// TFRecord: length, its masked CRC, payload, its masked CRC.
void TensorboardWriter::WriteRecord(const std::string& payload) {
  const std::string length = Raw(static_cast<uint64_t>(payload.size()));
  out_ << length << Raw(MaskedCrc(length)) << payload << Raw(MaskedCrc(payload)) << std::flush;
  if (!out_) throw Error("cannot write " + file_.string());
}

}  // namespace sandwright
