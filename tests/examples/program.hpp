// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

/// Runs example programs as a user does, each test in a folder of its own.
class Programs : public testing::Test {
 protected:
  struct Outcome {
    int status = -1;
    std::string out, err;
  };

  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder = std::filesystem::path(testing::TempDir()) /
             ("petzval_" + std::string(test->test_suite_name()) + '_' + test->name());
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  Outcome run(const std::string& program, const std::vector<std::string>& arguments) const {
    std::string command = quoted(std::string(PETZVAL_TEST_PROGRAMS) + '/' + program);
    for (const std::string& argument : arguments) command += ' ' + quoted(argument);
    command += " > " + quoted(path("stdout")) + " 2> " + quoted(path("stderr"));
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("stdout")), read(path("stderr"))};
  }

  /// The program must fail with status 1, nothing on standard output, and one line on standard error that contains
  /// `reason`.
  void expect_failure(const std::string& program, const std::vector<std::string>& arguments,
                      const std::string& reason) const {
    const Outcome outcome = run(program, arguments);
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << "wanted " << reason << ", found " << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
  }

  std::string path(const std::string& name) const { return (folder / name).string(); }

  static std::string lens(const std::string& id) { return std::string(PETZVAL_TEST_DATA) + "/lenses/" + id + ".json"; }

  static std::string read(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    EXPECT_TRUE(in) << file;
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  static nlohmann::json read_json(const std::filesystem::path& file) { return nlohmann::json::parse(read(file)); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }

  static std::vector<std::string> lines(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);) result.push_back(line);
    return result;
  }

  std::filesystem::path folder;

 private:
  static std::string quoted(const std::string& text) { return '\'' + text + '\''; }
};
