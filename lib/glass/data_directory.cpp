// SPDX-License-Identifier: Apache-2.0
#if defined(_WIN32)
#include <windows.h>
#elif __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

#include <array>
#include <system_error>

#include "petzval/core/error.hpp"
#include "petzval/glass/glass.hpp"

namespace petzval {
namespace {

const char anchor = 0;  ///< an address in the file from which this code was loaded

/// The name of this file as reported by the system.
#if defined(_WIN32)
std::filesystem::path loaded_from() {
  HMODULE module = nullptr;
  GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
                     reinterpret_cast<LPCWSTR>(&anchor), &module);
  std::array<wchar_t, 32768> name{};  // the longest path in Windows
  return std::wstring(name.data(), GetModuleFileNameW(module, name.data(), static_cast<DWORD>(name.size())));
}
#else
std::filesystem::path loaded_from() {
  std::string name;
#if __has_include(<dlfcn.h>)
  Dl_info info{};
  if (dladdr(&anchor, &info) != 0 && info.dli_fname != nullptr) name = info.dli_fname;
#endif
  // The shell looked up a bare name in PATH; the kernel knows the result.
  return name.find('/') == std::string::npos ? "/proc/self/exe" : name;
}
#endif

/// The shared library, or the program into which this code was linked.
std::filesystem::path own_module() {
  const std::filesystem::path name = loaded_from();
  std::error_code failed;
  const auto file = std::filesystem::canonical(name, failed);
  if (failed) {
    throw Error("data directory: " + name.string() + ": " + failed.message() +
                "; must be the file of the loaded library");
  }
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
  throw Error("data directory: the " + std::to_string(levels) + " folders above " + module.string() +
              " lack share/petzval/glass; must be installed in one of them");
}

}  // namespace petzval
