// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

/// The commands of the program petzval. Each runs like a main(): argv[0] is the name of the command, and the result is
/// the exit status.
namespace commands {

int blur(int argc, char** argv);
int camera_rays(int argc, char** argv);
int choose(int argc, char** argv);
int colour(int argc, char** argv);
int convert(int argc, char** argv);
int export_camera(int argc, char** argv);
int expressive(int argc, char** argv);
int focus(int argc, char** argv);
int ghosts(int argc, char** argv);
int lenses(int argc, char** argv);
int metadata(int argc, char** argv);
int models(int argc, char** argv);
int psf(int argc, char** argv);
int psf_set(int argc, char** argv);
int pull(int argc, char** argv);
int render(int argc, char** argv);
int report(int argc, char** argv);
int shapes(int argc, char** argv);
int sheet(int argc, char** argv);
int spots(int argc, char** argv);
int surface(int argc, char** argv);
int tilt(int argc, char** argv);
int trace(int argc, char** argv);
int view(int argc, char** argv);

struct Command {
  std::string_view name;     ///< as typed
  std::string_view summary;  ///< one line of the overview
  std::string_view example;  ///< arguments of an example
  int (*run)(int, char**);   ///< null: not built
  std::string_view needs{};  ///< the missing library of a command that is not built
};

/// Commands that belong together.
struct Group {
  std::string_view title;
  std::span<const Command> commands;
};

/// All groups in the order of the overview.
std::span<const Group> groups();

}  // namespace commands
