#include "data/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <limits>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "tests/support/zip.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

auto Fails(const std::string& text) {
  return ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr(text)));
}
std::string Temp(const std::string& name) { return ::testing::TempDir() + "npy_" + name; }

// An array file by hand, as the format's description has it.
std::string Npy(const std::string& header, const std::string& data, int major = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(major);
  bytes += '\0';
  return bytes + Bytes(header.size(), major == 1 ? 2 : 4) + header + data;
}

std::string Zip(const std::string& name, const std::string& packed, size_t size, int method) {
  return sandwright::Zip(std::vector<ZipMember>{{name, packed, size, method}});
}

std::string Deflate(const std::string& plain) {
  std::string packed(plain.size() + 100, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(plain.data()));
  stream.avail_in = static_cast<uInt>(plain.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  deflateEnd(&stream);
  packed.resize(stream.total_out);
  return packed;
}

const std::string kHeader = "{'descr': '<u2', 'fortran_order': False, 'shape': (2, 3), }\n";
const std::string kData("\x01\x00\x02\x00\x03\x00\x04\x00\x05\x00\x00\x01", 12);

TEST(Npy, ReadsHandMadeFilesOfAllVersions) {
  for (int major = 1; major <= 3; ++major) {
    WriteFileAtomically(Temp("hand.npy"), Npy(kHeader, kData, major));
    const NpyArray array = ReadNumpy(Temp("hand.npy"));
    EXPECT_EQ(array.dtype, "u2");
    EXPECT_THAT(array.shape, ElementsAre(2, 3));
    EXPECT_THAT(array.values, ElementsAre(1, 2, 3, 4, 5, 256));
  }
}

TEST(Npy, ReadsWhatItWrites) {
  const std::vector<double> doubles = {0.1, -1e300, std::numeric_limits<double>::infinity()};
  WriteNpy<double>(Temp("f8.npy"), doubles, {3});
  EXPECT_EQ(ReadNumpy(Temp("f8.npy")).values, doubles);
  const std::vector<float> floats = {0.1f, 2, 3, 4};
  WriteNpy<float>(Temp("f4.npy"), floats, {2, 2});
  EXPECT_EQ(ReadNumpy(Temp("f4.npy")).values[0], static_cast<double>(0.1f));
  const std::vector<uint8_t> bytes = {255};
  WriteNpy<uint8_t>(Temp("u1.npy"), bytes, {1, 1});
  EXPECT_THAT(ReadNumpy(Temp("u1.npy")).values, ElementsAre(255));
  // NumPy asks that the data begin at a multiple of 64.
  EXPECT_EQ((ReadFile(Temp("f4.npy")).size() - 16) % 64, 0u);
}

TEST(Npy, ReadsSignedNumbers) {
  WriteFileAtomically(Temp("i4.npy"), Npy("{'shape': (1,), 'fortran_order': False, 'descr': '<i4'}",
                                          "\xfe\xff\xff\xff"));
  EXPECT_THAT(ReadNumpy(Temp("i4.npy")).values, ElementsAre(-2));
}

TEST(Npy, ReadsArchivesStoredAndDeflated) {
  const std::string npy = Npy(kHeader, kData);
  WriteFileAtomically(Temp("stored.npz"), Zip("arr_0.npy", npy, npy.size(), 0));
  WriteFileAtomically(Temp("packed.npz"), Zip("heights.npy", Deflate(npy), npy.size(), 8));
  EXPECT_THAT(ReadNumpy(Temp("stored.npz")).values, ElementsAre(1, 2, 3, 4, 5, 256));
  EXPECT_THAT(ReadNumpy(Temp("packed.npz"), "heights").values, ElementsAre(1, 2, 3, 4, 5, 256));
  EXPECT_THAT(ReadNumpy(Temp("packed.npz")).values,
              ElementsAre(1, 2, 3, 4, 5, 256));  // the only member
}

TEST(Npy, NamesTheFaultOfBadFiles) {
  const auto read = [](const std::string& bytes) {
    WriteFileAtomically(Temp("bad"), bytes);
    return [] { ReadNumpy(Temp("bad")); };
  };
  const std::string npy = Npy(kHeader, kData);
  EXPECT_THAT([] { ReadNumpy(Temp("missing.npy")); }, Fails("missing.npy"));
  EXPECT_THAT(read("hello, this is text"), Fails("not a NumPy array file"));
  EXPECT_THAT(read(""), Fails("cut off"));
  EXPECT_THAT(read(npy.substr(0, npy.size() - 1)), Fails("cut off"));
  EXPECT_THAT(read(npy.substr(0, 40)), Fails("cut off"));
  EXPECT_THAT(read(Npy(kHeader, kData, 4)), Fails("format 4.0"));
  EXPECT_THAT(read(Npy("{'descr': '<c16', 'fortran_order': False, 'shape': (1,)}", kData)),
              Fails("'<c16'"));
  EXPECT_THAT(read(Npy("{'descr': '>u2', 'fortran_order': False, 'shape': (1,)}", kData)),
              Fails("'>u2'"));
  EXPECT_THAT(read(Npy("{'descr': '<u2', 'fortran_order': True, 'shape': (2, 3)}", kData)),
              Fails("Fortran"));
  EXPECT_THAT(read(Npy("{'descr': '<u2', 'fortran_order': False, 'shape': (99999, 99999)}", kData)),
              Fails("too large"));
  EXPECT_THAT(read(Npy("[]", kData)), Fails("header"));

  const std::string zip = Zip("arr_0.npy", npy, npy.size(), 0), deflated = Deflate(npy);
  EXPECT_THAT(read(zip.substr(0, zip.size() - 30)), Fails("cut off"));
  EXPECT_THAT(read(Zip("arr_0.npy", deflated.substr(0, deflated.size() / 2), npy.size(), 8)),
              Fails("damaged"));
  EXPECT_THAT(read(Zip("arr_0.npy", npy, npy.size(), 12)), Fails("method 12"));
  WriteFileAtomically(Temp("other.npz"), Zip("other.npy", npy, npy.size(), 0));
  EXPECT_THAT([] { ReadNumpy(Temp("other.npz"), "arr_0"); }, Fails("it holds: other.npy"));
}

}  // namespace
}  // namespace sandwright
