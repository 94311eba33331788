// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/version.hpp"

/// Exports a class or function from a shared library that is compiled with hidden symbols.
///
/// On Windows the macro is empty, because the build exports every symbol there (WINDOWS_EXPORT_ALL_SYMBOLS). Static
/// libraries ignore it.
#if defined(__GNUC__) && !defined(_WIN32)
#define PETZVAL_API __attribute__((visibility("default")))
#else
#define PETZVAL_API
#endif
