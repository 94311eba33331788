// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../expect_error.hpp"

using Arguments = std::vector<std::string>;

/// Runs example programs as a user does, each test in a folder of its own.
class Programs : public testing::Test {
 protected:
  struct Outcome {
    int status = -1;
    std::string out, err;
  };

  void SetUp() override;
  void TearDown() override;

  /// The start of a line of the shell that runs a program: a command of petzval, petzval itself, a program that teaches
  /// the library (teaching_test.cpp), or wu_...
  static std::string invocation(const std::string& program);
  Outcome run(const std::string& program, const Arguments& arguments) const;

  /// The program must fail with status 1, nothing on standard output, and one line on standard error that contains
  /// the tokens: the flag or the file, and the value.
  void expect_failure(const std::string& program, const Arguments& arguments,
                      const std::vector<petzval::testing::Token>& tokens, int line = __builtin_LINE()) const;

  /// Small valid input files: samples.csv, rays_in.csv, points.json, keys.json and surface.json.
  void write_inputs() const;
  /// The arguments with files for "LENS" (a double Gauss), "LENS:id" and "@name".
  Arguments expanded(Arguments arguments) const;

  std::string path(const std::string& name) const { return (folder / name).string(); }

  static std::string lens(const std::string& id) { return std::string(PETZVAL_TEST_DATA) + "/lenses/" + id + ".json"; }
  static std::string read(const std::filesystem::path& file);
  /// The number of pictures in an SVG file.
  static std::size_t pictures_in(const std::filesystem::path& file);
  static nlohmann::json read_json(const std::filesystem::path& file);
  static std::vector<std::string> lines(const std::string& text);

  void write(const std::string& name, const std::string& text) const;

  std::filesystem::path folder;
};
