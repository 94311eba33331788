// SPDX-License-Identifier: Apache-2.0
// Runs every program with one bad value for each of its flags: it must exit with 1 and print one line that names the
// flag.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <ostream>
#include <regex>
#include <set>

#include "program.hpp"

namespace {

/// A program and a valid command line. LENS and names that begin with "@" stand for files.
struct Command {
  std::string program;
  Arguments arguments;
};

std::ostream& operator<<(std::ostream& out, const Command& command) { return out << command.program; }

const std::vector<Command> commands = {
    {"accuracy_speed", {"LENS"}},
    {"bokeh_psf", {"LENS", "--subject-distance-mm", "1500", "--focus-mm", "1000", "--samples", "1", "--out", "@out"}},
    {"bokeh_shapes", {"--samples", "1", "--out", "@out"}},
    {"camera_rays",
     {"LENS", "--samples", "@samples.csv", "--model", "thin", "--focus-mm", "1000", "--out", "@rays.csv"}},
    {"choose_camera", {"LENS", "--near-mm", "1000", "--far-mm", "2000", "--budget-px", "1"}},
    {"chromatic_bokeh", {"LENS", "--samples", "1", "--out", "@out"}},
    {"convert_lens", {"LENS", "@out.json"}},
    {"expressive_lens", {"LENS", "--samples", "1", "--out", "@out"}},
    {"focal_surface", {"LENS", "--points", "@surface.json", "--out", "@out"}},
    {"focus_report", {"LENS"}},
    {"lens_metadata", {"LENS", "--out", "@out"}},
    {"lens_report", {"LENS"}},
    {"psf_set",
     {"LENS", "--fields", "0", "--distances-mm", "1500", "--focus-mm", "1000", "--samples", "1", "--pixels", "3",
      "--out", "@out"}},
    {"spot_diagram", {"LENS", "--field-deg", "0", "--wavelengths-nm", "587.56", "--samples", "1", "--out", "@out"}},
    {"trace_rays", {"LENS", "--rays", "@rays_in.csv", "--out", "@rays.csv"}},
    {"wu_figure7", {"--samples", "1", "--out", "@out.png"}},
    {"wu_statements", {"--samples", "1"}},
#ifdef PETZVAL_TEST_HAS_tilt_shift
    {"focus_pull", {"LENS", "--keys", "@keys.json", "--out", "@out"}},
    {"tilt_shift", {"LENS", "--points", "@points.json", "--out", "@out"}},
#endif
#ifdef PETZVAL_TEST_HAS_bokeh_scene
    {"bokeh_scene",
     {"--scene", "balls", "--lens", "LENS", "--focus-mm", "1000", "--width", "8", "--height", "8", "--spp", "1",
      "--out", "@out"}},
    {"bokeh_sheet", {"@out", "--out", "@out.png"}},
#endif
#ifdef PETZVAL_TEST_HAS_lens_blur
    {"lens_blur",
     {"--scene", "town", "--width", "8", "--height", "8", "--lens", "LENS", "--focus-mm", "3000", "--out", "@out"}},
#endif
};

/// Values that no program accepts. Other numeric flags get nan, which is not a valid number; other names get a name
/// that is too long.
const std::map<std::string, Arguments> bad_values = {
    {"--blades", {"1", "2", "21"}},
    {"--configuration", {"nowhere", "1e308"}},
    {"--f-number", {"1e-300", "0.1", "0"}},
    {"--f-numbers", {"1e-300", "0.1"}},
    {"--field-deg", {"1e308", "nan"}},
    {"--fields", {"170", "nan"}},
    {"--film-mm", {"1e308x1e308", "36", "0x24"}},
    {"--focus-mm", {"1e-300", "1", "nan"}},
    {"--wavelength-nm", {"1e-300", "1e6", "nan"}},
    {"--wavelengths-nm", {"1e-300", "1e6", "550,550"}},
};

/// Flags of --help that take a value, with the placeholder of the value.
std::map<std::string, std::string> flags_of(const std::string& help) {
  static const std::regex line("(?:^|\\n) +(?:-[a-z],)?(--[a-z0-9-]+) ([A-Z][^ \\n]*)");
  std::map<std::string, std::string> flags;
  for (std::sregex_iterator found(help.begin(), help.end(), line), end; found != end; ++found) {
    const std::string type = (*found)[2];
    if (type != "Needs:" && type != "Excludes:") flags[(*found)[1]] = type;
  }
  return flags;
}

class HostileFlags : public Programs, public testing::WithParamInterface<Command> {
 protected:
  void SetUp() override {
    Programs::SetUp();
    write_inputs();
    std::filesystem::create_symlink(path("loop"), path("loop"));
  }

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
  const Outcome help = run(GetParam().program, {"--help"});
  ASSERT_EQ(help.status, 0);
  EXPECT_TRUE(help.err.empty() && help.out.find("Usage: " + GetParam().program) != std::string::npos) << help.out;
  for (const auto& [flag, type] : flags_of(help.out)) {
    Arguments values;
    if (const auto known = bad_values.find(flag); known != bad_values.end()) {
      values = known->second;
    } else if (type.starts_with("FILE") || type.starts_with("DIR") || type == "CSV" || type == "PNG") {
      values = {std::string(300, 'n'), path("loop")};
    } else if (type.starts_with("TEXT") && !type.starts_with("TEXT:{")) {
      continue;  // any text is a title
    } else {
      values = {"nan"};
    }
    for (const std::string& value : values) expect_named(flag, value);
  }
}

INSTANTIATE_TEST_SUITE_P(All, HostileFlags, testing::ValuesIn(commands),
                         [](const auto& command) { return command.param.program; });

}  // namespace
