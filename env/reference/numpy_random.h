// numpy.random.default_rng(seed) as far as Gymnasium's resets use it: SeedSequence (O'Neill, "Developing a
// seed_seq alternative", 2015) and PCG64, 128 bit XSL-RR (O'Neill, "PCG: a family of simple fast
// space-efficient statistically good algorithms for random number generation", 2014).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sandwright {

class NumpyRandom {
 public:
  explicit NumpyRandom(uint64_t seed) {
    const std::array<uint64_t, 4> words = SeedWords(seed);
    increment_ = (Wide(words[2], words[3]) << 1) | 1;
    Advance();
    state_ += Wide(words[0], words[1]);
    Advance();
  }

  uint64_t Next64() {
    Advance();
    const auto high = static_cast<uint64_t>(state_ >> 64), low = static_cast<uint64_t>(state_);
    const uint64_t mixed = high ^ low;
    const auto turn = static_cast<unsigned>(high >> 58);
    return (mixed >> turn) | (mixed << ((64 - turn) & 63));
  }
  double Uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(Next64() >> 11) * 0x1p-53);
  }

 private:
  __extension__ using uint128 = unsigned __int128;
  static uint128 Wide(uint64_t high, uint64_t low) { return static_cast<uint128>(high) << 64 | low; }

  void Advance() {
    state_ = state_ * Wide(2549297995355413924u, 4865540595714422341u) + increment_;
  }

  static std::array<uint64_t, 4> SeedWords(uint64_t seed) {
    uint32_t hash = 0x43b0d7e5;
    const auto hashed = [&hash](uint32_t value) {
      value ^= hash;
      hash *= 0x931e8875u;
      value *= hash;
      return value ^ value >> 16;
    };
    std::array<uint32_t, 4> pool = {hashed(static_cast<uint32_t>(seed)),
                                    hashed(static_cast<uint32_t>(seed >> 32)), hashed(0), hashed(0)};
    for (size_t from = 0; from < 4; ++from) {
      for (size_t to = 0; to < 4; ++to) {
        if (from == to) continue;
        const uint32_t mixed = 0xca01f9ddu * pool[to] - 0x4973f715u * hashed(pool[from]);
        pool[to] = mixed ^ mixed >> 16;
      }
    }
    std::array<uint64_t, 4> words{};
    hash = 0x8b51f9dd;
    for (size_t i = 0; i < 8; ++i) {
      uint32_t value = pool[i % 4] ^ hash;
      hash *= 0x58f38dedu;
      value *= hash;
      value ^= value >> 16;
      words[i / 2] |= static_cast<uint64_t>(value) << (32 * (i % 2));
    }
    return words;
  }

  uint128 state_ = 0, increment_ = 0;
};

}  // namespace sandwright
