// Explicit counter-based random streams: Philox4x32-10 (Salmon et al., "Parallel random numbers:
// as easy as 1, 2, 3", SC 2011). A stream is a value; copying it copies its future.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>
#include <string_view>

namespace sandwright {

// Names what a stream is drawn for, so that streams of one seed never meet.
// FNV-1a, 64 bit: stable across compilers, unlike std::hash.
constexpr uint64_t StreamId(std::string_view name) {
  uint64_t hash = 14695981039346656037ull;
  for (char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

// One stream of random numbers, fixed by (seed, purpose, index): for example
// RandomStream(seed, StreamId("episode"), environment * 2^32 + episode).
class RandomStream {
 public:
  // The whole state: enough to save and continue a stream bit for bit.
  struct State {
    std::array<uint32_t, 2> key;
    std::array<uint32_t, 4> counter;
    std::array<uint32_t, 4> block;
    uint32_t used;  // words of `block` already drawn, 0..4
  };

  explicit RandomStream(uint64_t seed, uint64_t purpose = 0, uint64_t index = 0) {
    const uint64_t mixed = Mix(seed + 0x9e3779b97f4a7c15ull * Mix(purpose));
    state_.key = {static_cast<uint32_t>(mixed), static_cast<uint32_t>(mixed >> 32)};
    state_.counter = {0, 0, static_cast<uint32_t>(index), static_cast<uint32_t>(index >> 32)};
    state_.used = 4;
  }
  explicit RandomStream(const State& state) : state_(state) {}

  const State& state() const { return state_; }

  uint32_t Next32() {
    if (state_.used == 4) {
      state_.block = Philox(state_.counter, state_.key);
      if (++state_.counter[0] == 0) ++state_.counter[1];
      state_.used = 0;
    }
    return state_.block[state_.used++];
  }
  uint64_t Next64() {
    const uint64_t low = Next32();
    return low | static_cast<uint64_t>(Next32()) << 32;
  }

  // Uniform in [0, 1), 53 bits.
  double Uniform() { return static_cast<double>(Next64() >> 11) * 0x1p-53; }
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  // Uniform in 0..count-1 without bias (Lemire 2019). count > 0.
  uint64_t Index(uint64_t count) {
    const uint64_t threshold = (0 - count) % count;
    for (;;) {
      const auto product = static_cast<Wide>(Next64()) * count;
      if (static_cast<uint64_t>(product) >= threshold) return static_cast<uint64_t>(product >> 64);
    }
  }

  // Standard normal (Box-Muller, one of the pair: no hidden state).
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log1p(-Uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * Uniform());
  }

 private:
  __extension__ using Wide = unsigned __int128;

  static constexpr uint64_t Mix(uint64_t x) {  // splitmix64 finaliser
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
  }
  static std::array<uint32_t, 4> Philox(std::array<uint32_t, 4> c, std::array<uint32_t, 2> k) {
    for (int round = 0; round < 10; ++round) {
      const uint64_t p0 = 0xD2511F53ull * c[0], p1 = 0xCD9E8D57ull * c[2];
      c = {static_cast<uint32_t>(p1 >> 32) ^ c[1] ^ k[0], static_cast<uint32_t>(p1),
           static_cast<uint32_t>(p0 >> 32) ^ c[3] ^ k[1], static_cast<uint32_t>(p0)};
      k = {k[0] + 0x9E3779B9u, k[1] + 0xBB67AE85u};
    }
    return c;
  }

  State state_;
};

}  // namespace sandwright
