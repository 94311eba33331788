// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks what the shared libraries export; everything else is hidden.
#define PETZVAL_API __attribute__((visibility("default")))
