// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "petzval/core/version.hpp"

/// Marks what the shared libraries export where symbols are hidden unless marked. Windows has no such default: there
/// the build exports every symbol (WINDOWS_EXPORT_ALL_SYMBOLS). Static libraries ignore the mark.
#if defined(__GNUC__) && !defined(_WIN32)
#define PETZVAL_API __attribute__((visibility("default")))
#else
#define PETZVAL_API
#endif
