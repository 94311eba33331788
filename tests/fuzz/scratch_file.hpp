// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace petzval::fuzz {

/// A file of this process for readers that take paths only; in memory if the system has such a file system.
class ScratchFile {
 public:
  explicit ScratchFile(std::string_view ending) {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    std::error_code none;
    path_ = (fs::is_directory(memory, none) ? memory : fs::temp_directory_path()) /
            ("petzval_fuzz_" + std::to_string(getpid()) + std::string(ending));
  }
  ~ScratchFile() {
    std::error_code none;
    std::filesystem::remove(path_, none);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }
  const std::filesystem::path& holding(std::string_view bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    return path_;
  }
  std::string bytes() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private:
  std::filesystem::path path_;
};

}  // namespace petzval::fuzz
