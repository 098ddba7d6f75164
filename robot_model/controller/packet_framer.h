// A byte stream cut into packets that begin with their own size and a type.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "robot_model/controller/big_endian.h"

namespace sandwright {

// What the sizes and types of a protocol may be; all else means that the stream is not that
// protocol, or that its reader has lost step.
struct PacketFormat {
  size_t size_bytes;       // of the size field, 2 or 4; the type is the byte behind it
  size_t largest;          // packet with its header [bytes]
  std::string_view types;  // that exist; empty: any
};

struct Packet {
  uint8_t type = 0;
  std::span<const uint8_t> payload;  // valid until the framer's next Feed()
};

// Takes the stream in pieces of any size, down to single bytes. Holds at most one unfinished packet
// and what was fed since.
class PacketFramer {
 public:
  explicit PacketFramer(const PacketFormat& format) : format_(format) {}

  void Feed(std::span<const uint8_t> bytes);
  // The next whole packet; none until more is fed, and for good once `broken()`.
  std::optional<Packet> Next();
  // A size or type that cannot be: nothing behind it can be trusted.
  bool broken() const { return broken_; }
  size_t held_bytes() const { return buffer_.size() - begin_; }

 private:
  PacketFormat format_;
  Bytes buffer_;
  size_t begin_ = 0;  // of what has not been handed out
  bool broken_ = false;
};

}  // namespace sandwright
