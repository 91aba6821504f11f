#pragma once
// Seeded random numbers that are the same everywhere (the standard's distributions are not).

#include <cstdint>
#include <random>

namespace terray::test {

class Random {
  public:
    explicit Random(uint64_t seed) : engine_(seed) {}

    uint64_t bits() { return engine_(); }
    /// 0 .. bound - 1; bound > 0.
    uint64_t below(uint64_t bound) { return engine_() % bound; }
    /// From low up to, but not including, high.
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace terray::test
