// Zip files by hand, as the format's description has them, without checksums (which reading does not ask for).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sandwright {

// The lowest `count` bytes, least first.
inline std::string Bytes(uint64_t value, int count) {
  std::string bytes;
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

struct ZipMember {
  std::string name, packed;
  size_t size = 0;
  int method = 0;  // 0: stored, 8: deflated
};

inline std::string Zip(const std::vector<ZipMember>& members) {
  std::string file, directory;
  for (const ZipMember& m : members) {
    const std::string sizes = Bytes(0, 4) + Bytes(m.packed.size(), 4) + Bytes(m.size, 4);
    const std::string method = Bytes(static_cast<uint64_t>(m.method), 2);
    directory += "PK\x01\x02" + Bytes(20, 2) + Bytes(20, 2) + Bytes(0, 2) + method + Bytes(0, 4) + sizes +
                 Bytes(m.name.size(), 2) + Bytes(0, 2) + Bytes(0, 2) + Bytes(0, 8) + Bytes(file.size(), 4) + m.name;
    file += "PK\x03\x04" + Bytes(20, 2) + Bytes(0, 2) + method + Bytes(0, 4) + sizes + Bytes(m.name.size(), 2) +
            Bytes(0, 2) + m.name + m.packed;
  }
  return file + directory + "PK\x05\x06" + Bytes(0, 4) + Bytes(members.size(), 2) + Bytes(members.size(), 2) +
         Bytes(directory.size(), 4) + Bytes(file.size(), 4) + Bytes(0, 2);
}

}  // namespace sandwright
