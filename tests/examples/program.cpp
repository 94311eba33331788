// SPDX-License-Identifier: Apache-2.0
#include "program.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

namespace {

std::string quoted(const std::string& text) { return '\'' + text + '\''; }

}  // namespace

void Programs::SetUp() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  folder = std::filesystem::path(testing::TempDir()) /
           ("petzval_" + std::string(test->test_suite_name()) + '_' + test->name() + '_' + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
}

void Programs::TearDown() { std::filesystem::remove_all(folder); }

std::string Programs::invocation(const std::string& program) {
  const std::filesystem::path folder = PETZVAL_TEST_PROGRAMS;
  static const std::set<std::string> teaching{"autofocus",   "bokeh_psf",    "focus_editor",
                                              "path_tracer", "spot_diagram", "tilt_fit"};
  const bool own =
      program == "petzval" || program.starts_with("hello_") || program.starts_with("wu_") || teaching.contains(program);
  return own ? quoted((folder / program).string()) : quoted((folder / "petzval").string()) + ' ' + program;
}

Programs::Outcome Programs::run(const std::string& program, const Arguments& arguments) const {
  std::string command = invocation(program);
  for (const std::string& argument : arguments) command += ' ' + quoted(argument);
  command += " > " + quoted(path("stdout")) + " 2> " + quoted(path("stderr"));
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("stdout")), read(path("stderr"))};
}

void Programs::expect_failure(const std::string& program, const Arguments& arguments,
                              const std::vector<petzval::testing::Token>& tokens, int line) const {
  const Outcome outcome = run(program, arguments);
  EXPECT_EQ(outcome.status, 1) << outcome.err << "from line " << line;
  EXPECT_EQ(outcome.out, "");
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  petzval::testing::expect_tokens(outcome.err, tokens, test->file(), line);
  EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
}

void Programs::write_inputs() const {
  write("samples.csv", "film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm\n0,0,0.5,0.5,587.5618\n");
  write("rays_in.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-10,0,0,1\n");
  write("points.json", R"([{"position_mm": [0, 0, -1000]}])");
  write("keys.json", R"([{"keys": [{"time_s": 0, "position_mm": [0, 0, -1000]}]}])");
  write("surface.json", R"({"points": [{"world_mm": [0, 0, -1000]}]})");
}

Arguments Programs::expanded(Arguments arguments) const {
  for (std::string& argument : arguments) {
    if (argument == "LENS") argument = lens("double_gauss_100mm_f2_28deg");
    if (argument.starts_with("LENS:")) argument = lens(argument.substr(5));
    if (argument.starts_with('@')) argument = path(argument.substr(1));
  }
  return arguments;
}

std::string Programs::read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::size_t Programs::pictures_in(const std::filesystem::path& file) {
  const std::string svg = read(file), picture = "data:image/png;base64,iVBORw0KGgo";
  std::size_t count = 0;
  for (std::size_t at = svg.find(picture); at != std::string::npos; at = svg.find(picture, at + 1)) ++count;
  return count;
}

nlohmann::json Programs::read_json(const std::filesystem::path& file) { return nlohmann::json::parse(read(file)); }

std::vector<std::string> Programs::lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> result;
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

void Programs::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder / name, std::ios::binary) << text;
}
