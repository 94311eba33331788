// SPDX-License-Identifier: Apache-2.0
// Runs every command with bad values and wrong units for each of its flags, with wrong input files, with output that
// cannot be written and with a mistyped flag: it must exit with 1 and print one line that names the flag or the file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <ostream>
#include <regex>
#include <sstream>

#include "program.hpp"

namespace {

/// A program and a valid command line. LENS and names that begin with "@" stand for files.
struct Command {
  std::string program;
  Arguments arguments;
};

std::ostream& operator<<(std::ostream& out, const Command& command) { return out << command.program; }

const std::vector<Command> commands = {
    {"lenses", {"gauss"}},
    {"models", {"LENS"}},
    {"psf", {"LENS", "--at", "1500", "--focus", "1000", "--rays", "1", "--out", "@out"}},
    {"shapes", {"--rays", "1", "--out", "@out"}},
    {"camera-rays", {"LENS", "--table", "@samples.csv", "--model", "thin", "--focus", "1000", "--out", "@rays.csv"}},
    {"choose", {"LENS", "--near", "1000", "--far", "2000", "--budget", "1"}},
    {"colour", {"LENS", "--rays", "1", "--out", "@out"}},
    {"convert", {"LENS", "@out.json"}},
    {"expressive", {"LENS", "--rays", "1", "--out", "@out"}},
    {"surface", {"LENS", "--points", "@surface.json", "--out", "@out"}},
    {"focus", {"LENS"}},
    {"export", {"LENS", "--camera", "@t.bin", "--calibration", "@out", "--ray-map", "@rays.exr", "--size", "24"}},
    {"ghosts", {"LENS", "--light", "0,5", "--wavelengths", "d", "--size", "8", "--out", "@out"}},
    {"metadata", {"LENS", "--out", "@out"}},
    {"report", {"LENS"}},
    {"psf-set",
     {"LENS", "--fields", "0", "--at", "1500", "--focus", "1000", "--rays", "1", "--size", "3", "--out", "@out"}},
    {"psf-set merge", {"@shards", "--out", "@out.exr"}},
    {"spots", {"LENS", "--fields", "0", "--wavelengths", "587.56", "--rays", "1", "--out", "@out"}},
    {"trace", {"LENS", "--table", "@rays_in.csv", "--out", "@rays.csv"}},
#ifdef PETZVAL_TEST_HAS_tilt
    {"pull", {"LENS", "--keys", "@keys.json", "--out", "@out"}},
    {"tilt", {"LENS", "--points", "@points.json", "--out", "@out"}},
#endif
#ifdef PETZVAL_TEST_HAS_render
    {"render", {"--scene", "balls", "LENS", "--focus", "1000", "--size", "8x8", "--spp", "1", "--out", "@out"}},
    {"render merge", {"@shards", "--out", "@out"}},
    {"sheet", {"@out", "--out", "@out.svg"}},
#endif
#ifdef PETZVAL_TEST_HAS_blur
    {"blur", {"--scene", "town", "--size", "8x8", "LENS", "--focus", "3000", "--out", "@out"}},
#endif
};

/// Values that no command accepts. Other numeric flags get nan, which is not a valid number, and a wrong unit; other
/// names get a name that is too long.
const std::map<std::string, Arguments> bad_values = {
    {"--blades", {"1", "2", "21"}},
    {"--configuration", {"nowhere", "1e308"}},
    {"--f-number", {"1e-300", "0.1", "4mm"}},
    {"--fields", {"1e308", "nan", "5mm"}},
    {"--film", {"1e308x1e308", "36", "0x24", "36x24parsec"}},
    {"--focus", {"1e-300", "1", "nan", "3lightyears"}},
    {"--wavelengths", {"1e-300", "1e6", "550,550", "550mm"}},
};

/// Flags of --help with the placeholder of their value; empty if they take no value.
std::map<std::string, std::string> flags_of(const std::string& help) {
  static const std::regex line("(?:^|\\n) +(--[a-z0-9-]+)(?: ([A-Za-z][^ \\n]*))?");
  std::map<std::string, std::string> flags;
  for (std::sregex_iterator found(help.begin(), help.end(), line), end; found != end; ++found) {
    flags[(*found)[1]] = (*found)[2];
  }
  return flags;
}

bool is_output(const std::string& flag) {
  return flag == "--out" || flag == "--balls" || flag == "--calibration" || flag == "--ray-map";
}

class HostileFlags : public Programs, public testing::WithParamInterface<Command> {
 protected:
  void SetUp() override {
    Programs::SetUp();
    write_inputs();
    std::filesystem::create_symlink(path("loop"), path("loop"));
    write("wrong.png", "\x89PNG\r\n\x1a\n\x01{]");
    std::filesystem::create_directory(path("a_folder"));
  }

  std::map<std::string, std::string> flags() const { return flags_of(run(GetParam().program, {"--help"}).out); }

  /// The command line with another value of a flag.
  Arguments with(const std::string& flag, const std::string& value) const {
    Arguments arguments = expanded(GetParam().arguments);
    const auto own = std::find(arguments.begin(), arguments.end(), flag);
    if (own != arguments.end()) {
      *(own + 1) = value;
    } else {
      arguments.push_back(flag), arguments.push_back(value);
    }
    return arguments;
  }

  void expect_named(const std::string& flag, const std::string& value) const {
    const Outcome outcome = run(GetParam().program, with(flag, value));
    const std::string what = flag + " " + value.substr(0, 40) + ": " + outcome.err;
    EXPECT_EQ(outcome.status, 1) << what;
    const bool named =
        outcome.err.find(flag) != std::string::npos || outcome.err.find(value + ": ") != std::string::npos;
    EXPECT_TRUE(named) << what;
    EXPECT_EQ(outcome.err.find("filesystem error"), std::string::npos) << what;
    EXPECT_FALSE(outcome.err.empty()) << what;
  }
};

TEST_P(HostileFlags, AreNamed) {
  Arguments words{"help"};
  std::istringstream program(GetParam().program);  // "psf-set merge": two words
  for (std::string word; program >> word;) words.push_back(word);
  words.push_back("all");
  const Outcome help = run("petzval", words);
  ASSERT_EQ(help.status, 0);
  EXPECT_TRUE(help.err.empty() && help.out.find("Usage: petzval " + GetParam().program) != std::string::npos)
      << help.out;
  for (const auto& [flag, type] : flags_of(help.out)) {
    if (type.empty()) continue;
    Arguments values;
    if (const auto known = bad_values.find(flag); known != bad_values.end()) {
      values = known->second;
    } else if (type.starts_with("FILE") || type.starts_with("DIR") || type == "CSV" || type == "PNG") {
      values = {std::string(300, 'n'), path("loop")};
    } else if (type == "TEXT") {
      continue;  // any text is a title
    } else if (type.starts_with("LENGTH")) {
      values = {"nan", "3lightyears"};
    } else {
      values = {"nan", "1mm"};
    }
    for (const std::string& value : values) expect_named(flag, value);
  }
}

TEST_P(HostileFlags, WrongInputFilesAreNamed) {
  const std::string& program = GetParam().program;
  for (const std::string& wrong : {path("wrong.png"), path("a_folder")}) {
    // The lens, the tables and the folders of the command line.
    for (std::size_t i = 0; i < GetParam().arguments.size(); ++i) {
      const std::string& own = GetParam().arguments[i];
      const bool after_out = i > 0 && is_output(GetParam().arguments[i - 1]);
      if (own != "LENS" && (!own.starts_with('@') || after_out || program == "convert")) continue;
      Arguments arguments = expanded(GetParam().arguments);
      arguments[i] = wrong;
      expect_failure(program, arguments, {wrong});
    }
    for (const auto& [flag, type] : flags()) {
      const bool file = type.find("FILE") != std::string::npos || type.find("CSV") != std::string::npos ||
                        type.find("PNG") != std::string::npos || type.find(".csv") != std::string::npos ||
                        type.find(".json") != std::string::npos;
      if (file && !is_output(flag)) expect_named(flag, wrong);
    }
  }
}

TEST_P(HostileFlags, OutputThatCannotBeWrittenIsNamed) {
  const Arguments& own = GetParam().arguments;
  const std::string inside_a_file = path("samples.csv") + "/out.json";
  bool writes = false;
  for (const auto& [flag, type] : flags()) {
    if (!is_output(flag)) continue;
    writes = writes || std::ranges::find(own, flag) != own.end();
    expect_failure(GetParam().program, with(flag, inside_a_file), {flag, inside_a_file});
  }
  if (GetParam().program == "convert") {
    expect_failure("convert", {lens("double_gauss_100mm_f2_28deg"), inside_a_file}, {"OUT", inside_a_file});
  } else if (!writes) {
    std::string command = invocation(GetParam().program);
    for (const std::string& argument : expanded(own)) command += " '" + argument + '\'';
    EXPECT_NE(std::system((command + " > /dev/full 2> '" + path("stderr") + '\'').c_str()), 0);
    petzval::testing::expect_tokens(read(path("stderr")), {"standard output"});
  }
}

TEST_P(HostileFlags, MistypedFlagsGetASuggestion) {
  std::string longest;
  for (const auto& [flag, type] : flags()) {
    if (flag.size() > longest.size()) longest = flag;
  }
  std::string mistyped = longest;
  std::swap(mistyped.end()[-1], mistyped.end()[-2]);
  Arguments arguments = expanded(GetParam().arguments);
  arguments.push_back(mistyped);
  expect_failure(GetParam().program, arguments, {mistyped, longest});
}

INSTANTIATE_TEST_SUITE_P(All, HostileFlags, testing::ValuesIn(commands), [](const auto& command) {
  std::string name = command.param.program;
  std::ranges::replace_if(
      name, [](char c) { return c == '-' || c == ' '; }, '_');
  return name;
});

}  // namespace
