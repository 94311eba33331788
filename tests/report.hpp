// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "digits.hpp"

/// Cells of the tables that `sh tests/run.sh --report` prints: the worst case of a test. They are properties of the
/// test in the XML of GoogleTest. Cells with the name of one row may come from several tests.
namespace testing_report {

template <class T>
inline constexpr const char* one_ray = sizeof(T) == 4 ? "float" : "double";
template <class T>
inline constexpr const char* batch = sizeof(T) == 4 ? "batch float" : "batch double";

/// row, column: without " | ". bound: with the unit of the value.
inline void put(const std::string& row, const std::string& column, const std::string& value, const std::string& bound) {
  testing::Test::RecordProperty(row + " | " + column + " | " + bound, value);
}

inline void put(const std::string& row, const std::string& column, double value, const std::string& bound) {
  put(row, column, petzval::testing::digits(value, 2), bound);
}

}  // namespace testing_report
