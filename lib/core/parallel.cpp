// SPDX-License-Identifier: Apache-2.0
#include "petzval/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "petzval/core/error.hpp"

namespace petzval {

int processor_threads() noexcept { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void parallel_for(std::size_t count, std::size_t block, int threads,
                  const std::function<void(std::size_t, std::size_t)>& work) {
  if (block == 0) throw Error("parallel_for: block = 0; must be at least 1");
  if (threads < 1) throw Error("parallel_for: threads = " + std::to_string(threads) + "; must be at least 1");
  if (!work) throw Error("parallel_for: work is empty; must be a function");
  const std::size_t blocks = count / block + (count % block != 0);
  const auto do_block = [&](std::size_t k) { work(k * block, k * block + std::min(block, count - k * block)); };
  const std::size_t workers = std::min(static_cast<std::size_t>(threads), blocks);
  if (workers < 2) {
    for (std::size_t k = 0; k < blocks; ++k) do_block(k);
    return;
  }

  // Blocks start in order, so that all blocks before a throwing block have started and will end. The first throwing
  // block is therefore the same for any number of threads.
  std::atomic<std::size_t> next = 0;
  std::mutex keeping;
  std::size_t thrown_by = blocks;
  std::exception_ptr thrown;
  const auto do_blocks = [&]() noexcept {
    for (std::size_t k; (k = next++) < blocks;) {
      try {
        do_block(k);
      } catch (...) {
        next = blocks;
        const std::lock_guard guard(keeping);
        if (k < thrown_by) thrown_by = k, thrown = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> team;
    try {
      while (team.size() + 1 < workers) team.emplace_back(do_blocks);
    } catch (const std::system_error&) {
      // The system has no more threads: the running threads do the work.
    }
    do_blocks();
  }
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace petzval
