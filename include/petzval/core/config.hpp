// SPDX-License-Identifier: Apache-2.0
#pragma once

#if __cplusplus < 202002L && !(defined(_MSVC_LANG) && _MSVC_LANG >= 202002L)
#error "petzval needs a C++20 compiler: compile with -std=c++20 (/std:c++20)"
#endif

/// Version of these headers, as numbers for the preprocessor and as a string. The build system reads these lines.
#define PETZVAL_VERSION_MAJOR 0
#define PETZVAL_VERSION_MINOR 2
#define PETZVAL_VERSION_PATCH 0
#define PETZVAL_VERSION "0.2.0"

/// Exports a class or function from a shared library that is compiled with hidden symbols.
///
/// On Windows the macro is empty, because the build exports every symbol there (WINDOWS_EXPORT_ALL_SYMBOLS). Static
/// libraries ignore it.
#if defined(__GNUC__) && !defined(_WIN32)
#define PETZVAL_API __attribute__((visibility("default")))
#else
#define PETZVAL_API
#endif
