// SPDX-License-Identifier: Apache-2.0
// The end of memory is an exception, wherever it comes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <new>

#include "petzval/media/glass.hpp"

namespace {

/// Allocations until memory ends; negative: it never does.
thread_local long allocations_left = -1;
thread_local long allocations = 0;

}  // namespace

// Not inlined: a compiler that sees only one of them takes it for a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (allocations_left == 0) throw std::bad_alloc();
  if (allocations_left > 0) --allocations_left;
  if (void* place = std::malloc(size > 0 ? size : 1)) return place;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* place) noexcept { std::free(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept { std::free(place); }

namespace {

TEST(Memory, ThatEndsIsAnExceptionForTheCatalogue) {
  const std::filesystem::path folder = std::filesystem::path(PETZVAL_TEST_DATA) / "glass";
  const long before = allocations;
  petzval::GlassCatalogue::load(folder);
  const long all = allocations - before;
  int ended = 0, loads = 0;
  for (long left = 0; left < all; left += left < 400 ? 1 : 1999, ++loads) {
    allocations_left = left;
    try {
      petzval::GlassCatalogue::load(folder);
    } catch (const std::bad_alloc&) {
      ++ended;
    }
    allocations_left = -1;
  }
  EXPECT_GT(loads, 400);
  EXPECT_EQ(ended, loads);
}

}  // namespace
