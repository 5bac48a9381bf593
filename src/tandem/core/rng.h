#pragma once
/// Seeded random numbers. Nothing in tandem draws from a global generator.

#include <cstdint>
#include <random>

namespace tandem {

/// A 64-bit Mersenne Twister with the draws tandem needs, the same on every standard library.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : engine_(mix(seed)) {}

  /// Uniform in [low, high).
  double uniform(double low = 0.0, double high = 1.0) {
    constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * kUnit);
  }

  /// Uniform in {0, ..., n-1}; n > 0.
  std::size_t index(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

  /// A new seed, for a part that needs a generator of its own.
  std::uint64_t split() { return engine_(); }

  std::mt19937_64& engine() { return engine_; }

 private:
  /// Spreads neighbouring seeds apart. Ref: Steele et al., SplitMix64 (2014).
  static std::uint64_t mix(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::mt19937_64 engine_;
};

}  // namespace tandem
