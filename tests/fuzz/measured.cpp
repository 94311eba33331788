// SPDX-License-Identifier: Apache-2.0
// A target for libFuzzer with the time of its slowest input; libFuzzer itself reports whole seconds.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>

extern "C" int PETZVAL_FUZZED(const std::uint8_t* data, std::size_t size);

namespace {

struct Slowest {
  double ms = 0;
  ~Slowest() { std::fprintf(stderr, "stat::slowest_ms: %.1f\n", ms); }
} slowest;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto begin = std::chrono::steady_clock::now();
  const int result = PETZVAL_FUZZED(data, size);
  slowest.ms =
      std::max(slowest.ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  return result;
}
