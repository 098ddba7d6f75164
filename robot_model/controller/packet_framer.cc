#include "robot_model/controller/packet_framer.h"

namespace sandwright {

void PacketFramer::Feed(std::span<const uint8_t> bytes) {
  if (broken_) return;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<Packet> PacketFramer::Next() {
  const auto held = std::span<const uint8_t>(buffer_).subspan(begin_);
  const size_t header = format_.size_bytes + 1;
  if (broken_ || held.size() < header) return std::nullopt;
  BigEndianReader reader(held);
  const size_t size = format_.size_bytes == 2 ? reader.U16() : reader.U32();
  const uint8_t type = reader.U8();
  const bool known = format_.types.empty() || format_.types.find(static_cast<char>(type)) !=
                                                  std::string_view::npos;
  if (size < header || size > format_.largest || !known) {
    broken_ = true;
    buffer_.clear();
    begin_ = 0;
    return std::nullopt;
  }
  if (held.size() < size) return std::nullopt;
  begin_ += size;
  return Packet{type, held.subspan(header, size - header)};
}

}  // namespace sandwright
