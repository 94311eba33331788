// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>

namespace petzval::testing {

/// Repeats `work` with failing allocations of operator new in any thread: each of the first 200 allocations and some
/// later ones, failing once or together with all further allocations.
///
/// Checks that only std::bad_alloc or Error is thrown, that work that does not throw returns the complete result, that
/// no memory leaks, and that repeated work gives the complete result. `work` returns its result as text, which must not
/// depend on previous calls.
void expect_all_or_nothing(const std::function<std::string()>& work);

/// Like expect_all_or_nothing(), but each repetition runs as the first work of a new process.
void expect_all_or_nothing_at_first(const std::function<std::string()>& work);

/// Number of allocations of operator new so far, in all threads.
long allocations() noexcept;

/// Numbers as text, to the bit.
template <class T>
std::string bits(std::span<const T> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

}  // namespace petzval::testing
