// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>

namespace petzval::testing {

/// Does `work` again and again, each time with another allocation of operator new that fails, in whichever thread it
/// comes: alone, and with all that follow. The first 200 allocations fail in turn, and some of the later ones.
///
/// Expects that nothing but std::bad_alloc or Error comes out; that where nothing comes out, the result is the whole
/// one; that nothing is left allocated; and that the work done once more, every now and then, gives the whole result.
/// `work` returns what it made as text, and must not depend on what it did before, apart from caches.
void expect_all_or_nothing(const std::function<std::string()>& work);

/// The same where the process does the work for the first time: each in a process of its own.
void expect_all_or_nothing_at_first(const std::function<std::string()>& work);

/// Numbers as text, to the bit.
template <class T>
std::string bits(std::span<const T> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

}  // namespace petzval::testing
