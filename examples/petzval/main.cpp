// SPDX-License-Identifier: Apache-2.0
// The program petzval: one command for each task.
//
//   petzval report double_gauss_52mm_f1.8
#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "commands.hpp"
#include "describe.hpp"
#include "petzval/core/config.hpp"
#include "support/cli.hpp"
#include "support/suggest.hpp"

namespace {

using commands::Command;
using commands::Group;

const Command* find(std::string_view name) {
  for (const Group& group : commands::groups()) {
    for (const Command& command : group.commands) {
      if (command.name == name) return &command;
    }
  }
  return nullptr;
}

void print_overview(std::ostream& out) {
  out << "petzval " PETZVAL_VERSION
         ": real lenses, from the table of a patent to rays, pictures and numbers\n\n"
         "Usage: petzval COMMAND [LENS] [options]\n"
         "LENS is a file or the name of a shipped lens (petzval lenses). Lengths are millimetres or have a unit: 3m, "
         "50cm, 2in.\n";
  for (const Group& group : commands::groups()) {
    out << '\n' << group.title << '\n';
    for (const Command& command : group.commands) {
      out << "  " << command.name << std::string(13 - command.name.size(), ' ') << command.summary;
      if (!command.run) out << " (not built: needs " << command.needs << ')';
      out << '\n';
    }
  }
  out << "\npetzval help COMMAND   options of a command, with an example; petzval help COMMAND all: every detail\n"
         "petzval help files     formats of points, keys and tables\n"
         "petzval help WORD      commands for a task: mtf, distortion, bokeh, dof, blender, nuke, zemax, ...\n"
         "petzval --version\n";
}

void print_files() {
  std::cout << R"(Points (--points FILE): a JSON list of objects, or an object with the list "points".
  position_mm [x, y, z]  position in the scene (also called world_mm); tilt, surface, pull: in the lens frame
  at_infinity            true: position_mm is a direction
  pixel [x, y]           position in the picture, instead of position_mm (surface, render, blur)
  distance_mm            distance in focus (surface, render, blur); null: infinity
  weight                 0 or more; 1 if left out
  blur_mm or blur_px     requested diameter of the blur; negative in front of the plane of focus
  extent_stops           extent of the depth of field, in stops; with fixes_distance false, only the extent
  fade                   0 (no influence) to 1 (surface, render, blur)

Keys (pull --keys FILE, blur --frames N --points FILE): points with from_s, until_s and "keys", a list of objects
  with time_s, position_mm, at_infinity, weight, blur_mm and extent_stops. A point without keys does not move.

Events (view --replay FILE): an object with scene (or image, depth, deep), lens, size, fov_deg and events, a list
  of objects with type: add_point, move_point, set_point, remove_point, serve, setup, expressive,
  weighting, key, time, undo, redo, still. A window of view saves such a file.

Rays (trace --table FILE): CSV with the columns x_mm,y_mm,z_mm,dx,dy,dz.
Samples (camera-rays --table FILE): CSV with film_x_mm,film_y_mm,pupil_u,pupil_v,wavelength_nm.

Lenses: data/README.md describes the JSON format. All commands also read .zmx, .seq, .len, FlareSim .lens, LensHH
  .lhlt, crayg .fx, OpticalBench and other tables, and JSON of lentil, optiland and DeepLens. petzval convert writes
  other formats.

Reports (--json, and JSON files in --out DIR): lib/docs/reports.md and picture_reports.md list the keys.

Exit status: 0 success; 1 error, with one line on standard error; 2 unknown command; 3 not converted
  because of --strict; 130 interrupted (Ctrl-C or SIGTERM): finished pictures are kept, --resume continues.
)";
}

int unknown(std::string_view name) {
  std::vector<std::string> names;
  for (const Group& group : commands::groups()) {
    for (const Command& command : group.commands) names.emplace_back(command.name);
  }
  const std::string task = commands::first_command_for(name), near = examples::nearest(name, names);
  std::cerr << "petzval: command = \"" << name << "\"; must be a command"
            << (!task.empty()  ? "; see petzval " + task + " (petzval help " + std::string(name) + ')'
                : near.empty() ? " (petzval help)"
                               : "; did you mean " + near + "?")
            << '\n';
  return 2;
}

int run(std::string_view name, int argc, char** argv, const std::string& topic = "") {
  const Command* const command = find(name);
  if (!command) return unknown(name);
  if (!command->run) {
    std::cerr << "petzval: " << name << " is not built: needs " << command->needs << '\n';
    return 1;
  }
  // The library takes the baseline for an unknown name, because its rays are noexcept.
  const char* const set = std::getenv("PETZVAL_INSTRUCTION_SET");
  constexpr std::array<std::string_view, 4> sets{"", "baseline", "avx2", "avx512"};
  if (set && std::find(sets.begin(), sets.end(), set) == sets.end()) {
    std::cerr << "petzval: PETZVAL_INSTRUCTION_SET = \"" << set << "\"; must be baseline, avx2 or avx512\n";
    return 1;
  }
  examples::set_help("petzval " + std::string(name) + ' ' + std::string(command->example), topic);
  return command->run(argc, argv);
}

int help(int argc, char** argv) {
  if (argc < 3) return print_overview(std::cout), 0;
  const std::string_view topic = argv[2];
  if (topic == "files") return print_files(), 0;
  if (!find(topic)) {
    std::string words;
    for (int i = 2; i < argc; ++i) words += argv[i];
    if (commands::print_help_on(words)) return 0;
  }
  std::string flag = "--help";
  const std::string_view next = argc > 3 ? argv[3] : "";
  if (next == "merge" || next == "query") {  // commands of psf-set and render
    char* arguments[]{argv[2], argv[3], flag.data(), nullptr};
    return run(topic, 3, arguments, argc > 4 ? argv[4] : "");
  }
  char* arguments[]{argv[2], flag.data(), nullptr};
  return run(topic, 2, arguments, std::string(next));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view first = argc > 1 ? argv[1] : "help";
  if (first == "help" || first == "--help" || first == "-h") return help(argc, argv);
  if (first == "--version" || first == "version" || first == "-v")
    return std::cout << "petzval " PETZVAL_VERSION "\n", 0;
  if (first == "--man-page") return commands::print_man_page(), 0;
  if (first == "--bash-completion") return commands::print_bash_completion(), 0;
  if (first == "--zsh-completion") return commands::print_zsh_completion(), 0;
  return run(first, argc - 1, argv + 1);
}
