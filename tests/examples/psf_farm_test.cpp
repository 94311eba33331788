// SPDX-License-Identifier: Apache-2.0
// Render farm scripts: run if the scheduler is installed; otherwise only their form is checked.
#include <sys/wait.h>

#include <cstdlib>
#include <map>

#include "program.hpp"

namespace {

class PsfFarm : public Programs {
 protected:
  static std::string farm(const std::string& file) {
    return (std::filesystem::path(PETZVAL_TEST_DATA).parent_path() / "examples/farm" / file).string();
  }
  std::vector<std::string> grid() const {
    return {
        lens("double_gauss_100mm_f2_28deg"), "--fields", "0,7", "--at", "1000,inf", "--rays", "4096", "--size", "33"};
  }
  /// Runs a line of the shell with petzval on the path.
  int shell(const std::string& line) const {
    return std::system(("PATH='" + std::string(PETZVAL_TEST_PROGRAMS) + "':\"$PATH\"; " + line + " > '" +
                        path("stdout") + "' 2> '" + path("stderr") + "'")
                           .c_str());
  }
  std::string quoted(const std::vector<std::string>& words) const {
    std::string text;
    for (const std::string& word : words) text += " '" + word + "'";
    return text;
  }
  std::string whole() const {
    auto arguments = grid();
    arguments.insert(arguments.end(), {"--out", path("whole")});
    EXPECT_EQ(run("psf-set", arguments).status, 0);
    return read(path("whole/psf_set.exr"));
  }
};

TEST_F(PsfFarm, GnuParallelGivesTheSetOfOneRun) {
  if (std::system("parallel --version 2> /dev/null | grep -q 'GNU parallel'") != 0) GTEST_SKIP() << "no GNU parallel";
  ASSERT_EQ(shell("sh '" + farm("psf_set.parallel.sh") + "' 3 '" + path("out") + "'" + quoted(grid())), 0)
      << read(path("stderr"));
  EXPECT_EQ(read(path("out/psf_set.exr")), whole());
  EXPECT_NE(shell("sh '" + farm("psf_set.parallel.sh") + "' 3 '" + path("bad") + "' nowhere.json"), 0);
  EXPECT_FALSE(std::filesystem::exists(path("bad/psf_set.exr")));
}

/// The script as Slurm runs it: with these variables, once for each task of the array.
TEST_F(PsfFarm, SlurmArrayGivesTheSetOfOneRun) {
  const auto task = [&](int first, int last, int count, int id) {
    return shell("SLURM_ARRAY_TASK_MIN=" + std::to_string(first) + " SLURM_ARRAY_TASK_MAX=" + std::to_string(last) +
                 " SLURM_ARRAY_TASK_COUNT=" + std::to_string(count) + " SLURM_ARRAY_TASK_ID=" + std::to_string(id) +
                 " sh '" + farm("psf_set.slurm.sh") + "' '" + path("out") + "'" + quoted(grid()));
  };
  EXPECT_NE(task(0, 1, 2, 0), 0);
  EXPECT_NE(task(1, 3, 2, 1), 0) << "1,3";
  EXPECT_NE(read(path("stderr")).find("--array"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  for (const int id : {2, 1, 2}) EXPECT_EQ(task(1, 2, 2, id), 0) << read(path("stderr"));
  ASSERT_EQ(shell("petzval psf-set merge '" + path("out") + "' --out '" + path("out/psf_set.exr") + "'"), 0);
  EXPECT_EQ(read(path("out/psf_set.exr")), whole());
}

/// Runs as root, on a Slurm of one node that is started for the test.
TEST_F(PsfFarm, SlurmRunsTheArray) {
  if (std::system("command -v sbatch slurmctld slurmd > /dev/null && [ $(id -u) = 0 ]") != 0) {
    GTEST_SKIP() << "no Slurm, or not root";
  }
  const auto script = std::filesystem::path(PETZVAL_TEST_DATA).parent_path() / "tests/examples/slurm_on_loopback.sh";
  write("array.sh", "exec sbatch --wait --output '" + path("task_%a.txt") + "' --array=1-2 '" +
                        farm("psf_set.slurm.sh") + "' '" + path("out") + "'" + quoted(grid()) + '\n');
  const int status = shell("sh '" + script.string() + "' '" + path("slurm") + "' sh '" + path("array.sh") + "'");
  if (WIFEXITED(status) && WEXITSTATUS(status) == 77) GTEST_SKIP() << "Slurm does not start: " << read(path("stderr"));
  ASSERT_EQ(status, 0) << read(path("stderr"));
  EXPECT_EQ(lines(read(path("task_1.txt"))).size(), 2u);
  ASSERT_EQ(shell("petzval psf-set merge '" + path("out") + "' --out '" + path("out/psf_set.exr") + "'"), 0)
      << read(path("stderr"));
  EXPECT_EQ(read(path("out/psf_set.exr")), whole());
}

/// Replaces the renderer, which is not built everywhere, by a program that records its arguments.
TEST_F(PsfFarm, ScriptsRunRenderWithItsFlags) {
  write("petzval", "#!/bin/sh\necho \"$@\" >> '" + path("calls") + "'\n");
  std::filesystem::permissions(path("petzval"), std::filesystem::perms::owner_all);
  const std::string renderer = "COMMAND=render PATH='" + folder.string() + "':\"$PATH\" ", out = path("an out"),
                    resumed = " --resume --out " + out;
  ASSERT_EQ(shell(renderer + "SLURM_ARRAY_TASK_MIN=1 SLURM_ARRAY_TASK_MAX=3 SLURM_ARRAY_TASK_COUNT=3 " +
                  "SLURM_ARRAY_TASK_ID=2 sh '" + farm("psf_set.slurm.sh") + "' '" + out + "' --scene chess"),
            0)
      << read(path("stderr"));
  EXPECT_EQ(lines(read(path("calls"))), std::vector<std::string>{"render --scene chess --shard 2/3" + resumed});
  std::filesystem::remove(path("calls"));
  if (std::system("parallel --version 2> /dev/null | grep -q 'GNU parallel'") != 0) GTEST_SKIP() << "no GNU parallel";
  ASSERT_EQ(shell(renderer + "sh '" + farm("psf_set.parallel.sh") + "' 2 '" + out + "' --scene chess"), 0)
      << read(path("stderr"));
  EXPECT_EQ(lines(read(path("calls"))), (std::vector<std::string>{"render --scene chess --shard 1/2" + resumed,
                                                                  "render --scene chess --shard 2/2" + resumed,
                                                                  "render merge " + out + " --out " + out}));
}

/// Templates of Open Job Description, specification "jobtemplate-2023-09".
class OpenJobDescription : public PsfFarm {
 protected:
  using Json = nlohmann::json;

  static std::string filled(std::string text, const std::map<std::string, std::string>& values) {
    for (const auto& [name, value] : values) {
      const std::string reference = "{{" + name + "}}";
      for (std::size_t at; (at = text.find(reference)) != std::string::npos;) text.replace(at, reference.size(), value);
    }
    return text;
  }
  /// Executes a template like a scheduler: replaces names by values, runs a task for each value of the range, and steps
  /// in the order of their dependencies.
  void run_tasks(const Json& job, const std::map<std::string, std::string>& chosen) const {
    std::map<std::string, std::string> values = chosen;
    for (const Json& parameter : job["parameterDefinitions"]) {
      if (!parameter.contains("default")) continue;
      const Json& value = parameter["default"];
      values.emplace("Param." + parameter["name"].get<std::string>(),
                     value.is_string() ? value.get<std::string>() : value.dump());
    }
    const auto task = [&](const Json& step) {
      const Json& action = step["script"]["actions"]["onRun"];
      std::vector<std::string> arguments;
      for (const Json& argument : action["args"]) arguments.push_back(filled(argument, values));
      const auto outcome = run(filled(action["command"], values), arguments);
      EXPECT_EQ(outcome.status, 0) << outcome.err;
    };
    for (const Json& step : job["steps"]) {
      if (!step.contains("parameterSpace")) {
        task(step);
        continue;
      }
      const Json& parameter = step["parameterSpace"]["taskParameterDefinitions"].at(0);
      const std::string range = filled(parameter["range"], values);
      const int first = std::stoi(range), last = std::stoi(range.substr(range.find('-') + 1));
      for (int i = first; i <= last; ++i) {
        values["Task.Param." + parameter["name"].get<std::string>()] = std::to_string(i);
        task(step);
      }
    }
  }
};

class OpenJobTemplate : public OpenJobDescription, public testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Farm, OpenJobTemplate, testing::Values("psf_set", "bokeh_scene"),
                         [](const auto& program) { return std::string(program.param); });

TEST_F(OpenJobDescription, TasksOfTheTemplateGiveTheSetOfOneRun) {
  run_tasks(read_json(farm("psf_set.openjd.json")), {{"Param.Lens", lens("double_gauss_100mm_f2_28deg")},
                                                     {"Param.Out", path("out")},
                                                     {"Param.Fields", "0,7"},
                                                     {"Param.DistancesMm", "1000,inf"},
                                                     {"Param.WavelengthsNm", "587.5618"},
                                                     {"Param.FNumbers", "2.8"},
                                                     {"Param.Samples", "4096"},
                                                     {"Param.Shards", "3"}});
  ASSERT_EQ(run("psf-set", {lens("double_gauss_100mm_f2_28deg"), "--fields", "0,7", "--at", "1000,inf", "--f-number",
                            "2.8", "--rays", "4096", "--out", path("whole")})
                .status,
            0);
  EXPECT_EQ(read(path("out/psf_set.exr")), read(path("whole/psf_set.exr")));
}

#ifdef PETZVAL_TEST_HAS_render
TEST_F(OpenJobDescription, TasksOfTheTemplateGiveThePictureOfOneRun) {
  run_tasks(read_json(farm("bokeh_scene.openjd.json")), {{"Param.Lens", lens("double_gauss_100mm_f2_28deg")},
                                                         {"Param.Out", path("out")},
                                                         {"Param.Scene", "balls"},
                                                         {"Param.Samples", "2"},
                                                         {"Param.Width", "40"},
                                                         {"Param.Height", "24"},
                                                         {"Param.Shards", "2"}});
  ASSERT_EQ(run("render", {"--scene", "balls", lens("double_gauss_100mm_f2_28deg"), "--focus", "950", "--size", "40x24",
                           "--spp", "2", "--out", path("whole")})
                .status,
            0);
  EXPECT_EQ(read(path("out/picture.exr")), read(path("whole/picture.exr")));
}
#endif

/// Checks the template with the reference implementation.
TEST_P(OpenJobTemplate, IsAcceptedByOpenjd) {
  if (std::system("openjd --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no openjd";
  EXPECT_EQ(shell("openjd check '" + farm(GetParam() + std::string(".openjd.json")) + "'"), 0)
      << read(path("stdout")) << read(path("stderr"));
}

}  // namespace
