// SPDX-License-Identifier: Apache-2.0
// Two example programs at work in one folder at the same time.
#include <cstdlib>
#include <map>

#include "program.hpp"

namespace {

namespace fs = std::filesystem;

class TwoProcesses : public Programs {
 protected:
  /// Runs two commands at once; each must succeed.
  void run_both(const std::string& program, const std::vector<std::string>& one,
                const std::vector<std::string>& other) const {
    const auto command = [&](const std::vector<std::string>& arguments, const std::string& name) {
      std::string text = invocation(program);
      for (const std::string& argument : arguments) text += " '" + argument + '\'';
      return text + " > /dev/null 2> '" + path(name) + '\'';
    };
    const std::string line = command(one, "one") + " & one=$!; " + command(other, "other") +
                             " & other=$!; wait $one; first=$?; wait $other; exit $(($first + $?))";
    EXPECT_EQ(std::system(line.c_str()), 0) << read(path("one")) << read(path("other"));
  }

  std::map<std::string, std::string> files_in(const std::string& name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(path(name))) {
      if (entry.is_regular_file()) files[fs::relative(entry.path(), path(name)).string()] = read(entry.path());
    }
    return files;
  }

  std::vector<std::string> set(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{lens("double_gauss_100mm_f2_28deg"),
                                       "--fields",
                                       "0,7,14",
                                       "--at",
                                       "1000,2000,inf",
                                       "--rays",
                                       "4096",
                                       "--size",
                                       "33",
                                       "--out",
                                       path(out)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(TwoProcesses, WithOnePsfSetBothSucceed) {
  ASSERT_EQ(run("psf-set", set("whole")).status, 0);
  for (int round = 0; round < 3; ++round) {
    const std::string out = "both" + std::to_string(round);
    run_both("psf-set", set(out), set(out));
    EXPECT_EQ(files_in(out), files_in("whole"));
    run_both("psf-set", set(out, {"--resume"}), set(out, {"--resume"}));
    EXPECT_EQ(files_in(out), files_in("whole"));
  }
}

TEST_F(TwoProcesses, WithTwoShardsCompleteTheSet) {
  ASSERT_EQ(run("psf-set", set("whole")).status, 0);
  run_both("psf-set", set("shards", {"--shard", "1/2"}), set("shards", {"--shard", "2/2"}));
  const std::vector<std::string> merge{"merge", path("shards"), "--out", path("shards/psf_set.exr")};
  run_both("psf-set", merge, merge);
  EXPECT_EQ(read(path("shards/psf_set.exr")), read(path("whole/psf_set.exr")));
  EXPECT_EQ(read(path("shards/psf_set.svg")), read(path("whole/psf_set.svg")));
}

TEST_F(TwoProcesses, WithEqualPicturesBothSucceed) {
  const auto bokeh = [&](const std::string& out) {
    return std::vector<std::string>{
        lens("double_gauss_100mm_f1.35"), "--at", "1000", "--focus", "800,1200", "--rays", "32768", "--out", path(out)};
  };
  ASSERT_EQ(run("psf", bokeh("whole")).status, 0);
  run_both("psf", bokeh("both"), bokeh("both"));
  EXPECT_EQ(files_in("both"), files_in("whole"));
}

}  // namespace
