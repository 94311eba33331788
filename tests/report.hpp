// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "petzval/core/text.hpp"

/// Cells of the tables that `sh tests/run.sh --report` prints: the worst that a test met. They travel as properties of
/// the test in the XML of GoogleTest; cells of one row meet there by its name, whatever tests they come from.
namespace testing_report {

template <class T>
inline constexpr const char* one_ray = sizeof(T) == 4 ? "float" : "double";
template <class T>
inline constexpr const char* batch = sizeof(T) == 4 ? "batch float" : "batch double";

/// row, column: no " | " in them. bound: with its unit, which is that of the value too.
inline void put(const std::string& row, const std::string& column, const std::string& value, const std::string& bound) {
  testing::Test::RecordProperty(row + " | " + column + " | " + bound, value);
}

inline void put(const std::string& row, const std::string& column, double value, const std::string& bound) {
  put(row, column, petzval::number(value, 2), bound);
}

}  // namespace testing_report
