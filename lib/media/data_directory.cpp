// SPDX-License-Identifier: Apache-2.0
#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

#include <system_error>

#include "petzval/core/error.hpp"
#include "petzval/media/glass.hpp"

namespace petzval::inline v0 {
namespace {

/// The file this code was loaded from: the shared library, or the program it was linked into.
std::filesystem::path own_module() {
  std::string name;
#if __has_include(<dlfcn.h>)
  static const char anchor = 0;
  Dl_info info{};
  if (dladdr(&anchor, &info) != 0 && info.dli_fname != nullptr) name = info.dli_fname;
#endif
  // A bare name was looked up in PATH; the kernel knows the result.
  if (name.find('/') == std::string::npos) name = "/proc/self/exe";
  std::error_code failed;
  const auto file = std::filesystem::canonical(name, failed);
  if (failed)
    throw Error("data directory: " + name + ": " + failed.message() + ", wanted the file of the loaded library");
  return file;
}

}  // namespace

std::filesystem::path data_directory() {
  constexpr int levels = 5;
  const std::filesystem::path module = own_module();
  std::filesystem::path folder = module.parent_path();
  for (int level = 0; level < levels; ++level, folder = folder.parent_path()) {
    const auto candidate = folder / "share" / "petzval";
    std::error_code missing;
    if (std::filesystem::is_directory(candidate / "glass", missing)) return candidate;
  }
  throw Error("data directory: none of the " + std::to_string(levels) + " folders above " + module.string() +
              " holds share/petzval/glass, wanted the data beside the library");
}

}  // namespace petzval::inline v0
