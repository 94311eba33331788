// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "petzval/core/export.hpp"

namespace petzval {

/// How many threads the processor runs at once, at least 1: what a program may give to functions that take `threads`.
PETZVAL_API int processor_threads() noexcept;

/// Does `work(begin, end)` for the blocks [0, block), [block, 2 block), ... of `count` things, the last one shorter, on
/// `threads` threads (the calling one among them), and returns when all are done.
///
/// Blocks do not depend on the number of threads, and neither do results that each block writes to a place of its own.
/// If `work` throws, no further block begins and the exception of the first block that threw is rethrown: the same one
/// for any number of threads. If the system cannot start all threads, those that run do the work. Throws Error for a
/// block of 0, for fewer than 1 thread and for an empty `work`.
PETZVAL_API void parallel_for(std::size_t count, std::size_t block, int threads,
                              const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace petzval
