// SPDX-License-Identifier: Apache-2.0
#include "allocations.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>

#include "petzval/core/error.hpp"

namespace {

constexpr long never = std::numeric_limits<long>::max() / 2;
constexpr long all_of_the_first = 200, of_the_rest = 40;

std::atomic<long> made = 0, living = 0;
/// Number of allocations until the next failure.
std::atomic<long> left = never;
/// True if all further allocations fail.
std::atomic<bool> lasting = false;

void* allocate(std::size_t size, std::size_t alignment) {
  ++made;
  const long now_left = --left;
  if (now_left == 0 || (now_left < 0 && lasting)) throw std::bad_alloc();
  void* const place =
      alignment > 0 ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment) : std::malloc(size);
  if (!place) throw std::bad_alloc();
  ++living;
  return place;
}

void release(void* place) noexcept {
  if (place) --living;
  std::free(place);
}

}  // namespace

// Not inlined, because compilers that see only one of the operators report a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) { return allocate(std::max<std::size_t>(size, 1), 0); }
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept try {
  return operator new(size);
} catch (const std::bad_alloc&) {
  return nullptr;
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(std::max<std::size_t>(size, 1), static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* place) noexcept { release(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept { release(place); }
[[gnu::noinline]] void operator delete(void* place, std::align_val_t) noexcept { release(place); }
[[gnu::noinline]] void operator delete(void* place, std::size_t, std::align_val_t) noexcept { release(place); }

namespace petzval::testing {
namespace {

using Work = std::function<std::string()>;

/// Describes the fault if one allocation fails; empty if there is no fault. once_more: repeats the work.
std::string fault(const Work& work, const std::string& whole, long allocation, bool all_that_follow, bool once_more) {
  const long before = living;
  std::string found;
  bool thrown = false;
  const char* foreign = nullptr;
  lasting = all_that_follow, left = allocation;
  try {
    found = work();
  } catch (const std::bad_alloc&) {
    thrown = true;
  } catch (const Error&) {
    thrown = true;
  } catch (...) {
    foreign = "another exception than std::bad_alloc or Error";
  }
  left = never;
  const bool same = thrown || found == whole;
  std::string().swap(found);
  const long kept = living - before;
  const std::string where =
      "allocation " + std::to_string(allocation) + (all_that_follow ? " and all that follow: " : ": ");
  if (foreign) return where + foreign;
  if (!same) return where + "no exception, and another result";
  if (kept) fprintf(stderr, "KEPT %ld\n", kept);
  if (kept != 0) return where + std::to_string(kept) + " allocations are kept";
  if (once_more && work() != whole) return where + "another result at the next call";
  return {};
}

/// The next allocation that is made to fail, out of `count`.
long next(long allocation, long count) {
  return allocation < all_of_the_first ? allocation + 1
                                       : allocation + std::max(1L, (count - all_of_the_first) / of_the_rest);
}

}  // namespace

long allocations() noexcept { return made; }

void expect_all_or_nothing(const Work& work) {
  work();  // fills caches
  const long before = made;
  const std::string whole = work();
  const long count = made - before;
  ASSERT_GT(count, 0);
  for (long n = 1; n <= count; n = next(n, count)) {
    for (const bool all_that_follow : {false, true})
      ASSERT_EQ(fault(work, whole, n, all_that_follow, n % 16 == 1), "") << count;
  }
}

void expect_all_or_nothing_at_first(const Work& work) {
  /// Status 0: the allocation failed without a fault; 1: a fault; 2: the work makes fewer allocations.
  const auto in_a_process = [&](long allocation) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
      bool thrown = false;
      left = allocation;
      std::string found;
      try {
        found = work();
      } catch (const std::bad_alloc&) {
        thrown = true;
      } catch (const Error&) {
        thrown = true;
      }
      const bool failed = left <= 0;
      left = never;
      const std::string whole = work();
      if (!thrown && found != whole) _exit(1);
      if (!fault(work, whole, never, false, false).empty()) _exit(1);
      _exit(failed ? 0 : 2);
    }
    int status = -1;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  };
  int status = 0;
  for (long n = 1; status == 0; n += n < all_of_the_first ? 1 : n / 20) {
    status = in_a_process(n);
    ASSERT_NE(status, 1) << "allocation " << n;
  }
}

}  // namespace petzval::testing
