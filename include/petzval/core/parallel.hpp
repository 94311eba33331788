// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "petzval/core/config.hpp"

namespace petzval {

/// Number of threads that the processor runs at once, at least 1. A good value for parameters named `threads`.
PETZVAL_API int processor_threads() noexcept;

/// Splits a range into blocks and processes them on several threads. Returns when all blocks are done.
///
/// The blocks are [0, block), [block, 2 block), ...; the last block may be shorter. Blocks do not depend on the number
/// of threads, nor do results if each block writes to its own memory. If `work` throws, no further block begins, and
/// the exception of the first block that threw is rethrown: the same exception for any number of threads.
///
/// @param count    number of items
/// @param block    number of items in a block, at least 1
/// @param threads  number of threads including the calling thread, at least 1; fewer if the system lacks threads
/// @param work     the function to call for each block
/// @throws Error if `block` or `threads` is below 1, or if `work` is empty
PETZVAL_API void parallel_for(std::size_t count, std::size_t block, int threads,
                              const std::function<void(std::size_t begin, std::size_t end)>& work);

}  // namespace petzval
