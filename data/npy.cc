#include "data/npy.h"

#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include <cstring>
#include <limits>
#include <regex>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr std::string_view kMagic{"\x93NUMPY", 6};

// Little-endian unsigned number of `size` bytes at `offset`; the caller has checked the length.
uint64_t Number(std::string_view bytes, size_t offset, size_t size) {
  uint64_t value = 0;
  for (size_t i = size; i-- > 0;)
    value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
  return value;
}

[[noreturn]] void CutOff(const std::string& where, size_t have, size_t need) {
  throw Error(fmt::format("{}: the file is cut off: {} bytes, {} needed", where, have, need));
}

template <class T>
std::vector<double> Widen(std::string_view data, size_t count) {
  std::vector<double> values(count);
  for (size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, data.data() + i * sizeof(T), sizeof(T));
    values[i] = static_cast<double>(value);
  }
  return values;
}

// The header is the text of a Python dictionary with three keys, in any order.
std::string HeaderEntry(const std::string& header, const std::string& pattern,
                        const std::string& where) {
  std::smatch match;
  if (!std::regex_search(header, match, std::regex(pattern)))
    throw Error(where + ": not a NumPy array: its header is \"" + header + "\"");
  return match[1];
}

NpyArray ParseHeader(const std::string& header, const std::string& where) {
  const std::string descr = HeaderEntry(header, "'descr'\\s*:\\s*'([^']*)'", where);
  const std::string fortran = HeaderEntry(header, "'fortran_order'\\s*:\\s*(\\w+)", where);
  std::string shape = HeaderEntry(header, "'shape'\\s*:\\s*\\(([^)]*)\\)", where);
  if (fortran != "False")
    throw Error(where +
                ": the array is in Fortran order; allowed: C order "
                "(numpy.ascontiguousarray)");
  NpyArray array;
  array.dtype = descr.size() == 3 ? descr.substr(1) : descr;
  static constexpr std::string_view kAllowed[] = {"u1", "u2", "i4", "f4", "f8"};
  if (descr.size() != 3 || descr[0] == '>' ||
      std::find(std::begin(kAllowed), std::end(kAllowed), array.dtype) == std::end(kAllowed))
    throw Error(fmt::format("{}: element type '{}' is not read; allowed: u1, <u2, <i4, <f4, <f8",
                            where, descr));
  const std::regex digits("\\d+");
  for (std::sregex_iterator it(shape.begin(), shape.end(), digits), end; it != end; ++it)
    array.shape.push_back(std::stoull(it->str()));
  return array;
}

NpyArray ParseNpy(std::string_view bytes, const std::string& where) {
  if (bytes.size() < 12) CutOff(where, bytes.size(), 12);
  if (bytes.substr(0, 6) != kMagic) throw Error(where + ": not a NumPy array file (.npy)");
  const int major = bytes[6];
  if (major < 1 || major > 3)
    throw Error(fmt::format("{}: NumPy format {}.{}; allowed: 1.0 to 3.0", where, major,
                            static_cast<int>(bytes[7])));
  const size_t size_bytes = major == 1 ? 2 : 4;
  const size_t start = 8 + size_bytes + Number(bytes, 8, size_bytes);
  if (bytes.size() < start) CutOff(where, bytes.size(), start);
  NpyArray array =
      ParseHeader(std::string(bytes.substr(8 + size_bytes, start - 8 - size_bytes)), where);

  const size_t item = static_cast<size_t>(array.dtype[1] - '0');
  size_t count = 1;
  for (size_t extent : array.shape) {
    if (extent != 0 && count > std::numeric_limits<uint32_t>::max() / extent)
      throw Error(where + ": the array is too large (more than 2^32 elements)");
    count *= extent;
  }
  if (bytes.size() < start + count * item) CutOff(where, bytes.size(), start + count * item);
  const std::string_view data = bytes.substr(start);
  if (array.dtype == "u1") array.values = Widen<uint8_t>(data, count);
  if (array.dtype == "u2") array.values = Widen<uint16_t>(data, count);
  if (array.dtype == "i4") array.values = Widen<int32_t>(data, count);
  if (array.dtype == "f4") array.values = Widen<float>(data, count);
  if (array.dtype == "f8") array.values = Widen<double>(data, count);
  return array;
}

// One entry of a zip file's central directory (APPNOTE.TXT 4.3.12).
struct ZipEntry {
  std::string name;
  uint64_t method, packed, size, header;
};

std::vector<ZipEntry> ReadDirectory(std::string_view zip, const std::string& where) {
  // The end record is 22 bytes long when, as NumPy writes it, it carries no comment.
  const size_t end = zip.rfind("PK\x05\x06");
  if (end == std::string_view::npos || end + 22 > zip.size())
    throw Error(where + ": the file is cut off or not a zip file (.npz): no end record");
  size_t at = Number(zip, end + 16, 4);
  std::vector<ZipEntry> entries;
  for (uint64_t left = Number(zip, end + 10, 2); left > 0; --left) {
    if (at + 46 > zip.size() || zip.substr(at, 4) != "PK\x01\x02")
      throw Error(where + ": the directory of the zip file is damaged");
    const size_t name = Number(zip, at + 28, 2);
    const size_t extra = Number(zip, at + 30, 2) + Number(zip, at + 32, 2);
    if (at + 46 + name > zip.size()) CutOff(where, zip.size(), at + 46 + name);
    entries.push_back({std::string(zip.substr(at + 46, name)), Number(zip, at + 10, 2),
                       Number(zip, at + 20, 4), Number(zip, at + 24, 4), Number(zip, at + 42, 4)});
    at += 46 + name + extra;
  }
  return entries;
}

std::string Inflate(std::string_view packed, size_t size, const std::string& where) {
  std::string out(size, '\0');
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw Error("zlib failed", ErrorKind::kInternal);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int status = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (status != Z_STREAM_END || stream.avail_out != 0)
    throw Error(where + ": the compressed data is damaged");
  return out;
}

std::string ExtractMember(std::string_view zip, const std::string& member,
                          const std::string& where) {
  const std::vector<ZipEntry> entries = ReadDirectory(zip, where);
  std::string wanted = member.empty() ? "arr_0.npy" : member + ".npy", names;
  if (member.empty() && entries.size() == 1) wanted = entries.front().name;
  for (const ZipEntry& entry : entries) {
    names += (names.empty() ? "" : ", ") + entry.name;
    if (entry.name != wanted) continue;
    if (entry.header + 30 > zip.size()) CutOff(where, zip.size(), entry.header + 30);
    // Name and extra field of the local header may differ from the directory's.
    const size_t data =
        entry.header + 30 + Number(zip, entry.header + 26, 2) + Number(zip, entry.header + 28, 2);
    if (data + entry.packed > zip.size()) CutOff(where, zip.size(), data + entry.packed);
    const std::string_view packed = zip.substr(data, entry.packed);
    if (entry.method == 0) return std::string(packed);
    if (entry.method == 8) return Inflate(packed, entry.size, where);
    throw Error(fmt::format("{}: {} is packed by method {}; allowed: stored (0), deflated (8)",
                            where, wanted, entry.method));
  }
  throw Error(fmt::format("{}: no array '{}'; it holds: {}", where, wanted, names));
}

template <class T>
constexpr const char* kDescr = nullptr;
template <>
constexpr const char* kDescr<uint8_t> = "|u1";
template <>
constexpr const char* kDescr<uint16_t> = "<u2";
template <>
constexpr const char* kDescr<float> = "<f4";
template <>
constexpr const char* kDescr<double> = "<f8";

}  // namespace

NpyArray ReadNumpy(const std::filesystem::path& file, const std::string& member) {
  const std::string bytes = ReadFile(file), where = file.string();
  if (bytes.starts_with("PK"))
    return ParseNpy(ExtractMember(bytes, member, where), where + " (" + member + ")");
  return ParseNpy(bytes, where);
}

template <class T>
void WriteNpy(const std::filesystem::path& file, std::span<const T> values,
              const std::vector<size_t>& shape) {
  size_t count = 1;
  std::string extents;
  for (size_t extent : shape) count *= extent, extents += fmt::format("{}, ", extent);
  SAND_CHECK(count == values.size(), count, values.size());
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", kDescr<T>, extents);
  header.append(63 - (10 + header.size()) % 64, ' ');  // the data starts at a multiple of 64
  header += '\n';
  std::string bytes(kMagic);
  bytes += {1, 0, static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  WriteFileAtomically(file, bytes);
}

template void WriteNpy(const std::filesystem::path&, std::span<const uint8_t>,
                       const std::vector<size_t>&);
template void WriteNpy(const std::filesystem::path&, std::span<const uint16_t>,
                       const std::vector<size_t>&);
template void WriteNpy(const std::filesystem::path&, std::span<const float>,
                       const std::vector<size_t>&);
template void WriteNpy(const std::filesystem::path&, std::span<const double>,
                       const std::vector<size_t>&);

}  // namespace sandwright
