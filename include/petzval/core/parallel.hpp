// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "petzval/core/export.hpp"

namespace petzval::inline v0 {

/// How many threads the processor runs at once, at least 1: what a program may give to functions that take `threads`.
PETZVAL_API int processor_threads() noexcept;

/// Does `work(begin, end)` for the blocks [0, block), [block, 2 block), ... of `count` things, the last one shorter, on
/// `threads` threads (the calling one among them), and returns when all are done.
///
/// Blocks do not depend on the number of threads; whoever gives each block its own place for results gets results that
/// do not either. An exception of the work ends the blocks that have not begun, and leaves here (that of the first
/// block, where several threw: the same for any number of threads). Where the system has fewer threads to give, these
/// do the work. Throws Error for a block of 0 or less than one thread.
PETZVAL_API void parallel_for(std::size_t count, std::size_t block, int threads,
                              const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace petzval::inline v0
