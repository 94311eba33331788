// SPDX-License-Identifier: Apache-2.0
// Help by the words that people use for a task.
#include <algorithm>
#include <cctype>
#include <iostream>
#include <string>

#include "describe.hpp"

namespace commands {
namespace {

/// One task in each line: words | commands | how to use them. Words without blanks, hyphens and capitals.
constexpr std::string_view tasks = R"(
 mtf sharpness resolution contrast | report | report LENS --out DIR draws MTF with diffraction, over frequency and as makers print it.
 seidel aberration aberrations coma astigmatism sphericalaberration fieldcurvature fans | report spots | report LENS --out DIR draws Seidel sums, fans, field curvature.
 wavefront opd strehl airy diffraction | report psf | report LENS --out DIR draws the wavefront; psf --diffraction computes point images by waves.
 dof depthoffield hyperfocal breathing macro magnification | focus | focus LENS --at 1m,3m,inf prints depth of field, hyperfocal distance and breathing.
 bokeh swirl catseye catseyes onionrings highlights | psf shapes blur expressive | psf draws a point of light, shapes the cat's eyes over the picture.
 defocus zdepth depthmap lensblur | blur | blur LENS --image PICTURE --depth DEPTHS --focus 2m --out DIR blurs a picture that has depths.
 focuspull rackfocus rack followfocus | pull blur | pull LENS --keys FILE moves the film over time.
 distortion barrel pincushion undistort lensdistortion opencv colmap | export metadata report | export LENS --calibration DIR writes distortion models, metadata ST maps.
 tstop tstops transmission transmittance coatings | report metadata render | report LENS --coatings mgf2 prints T-stop and transmittance.
 vignetting vignette falloff illumination cos4 | report camera-rays render | report LENS --out DIR draws the illumination over the field.
 flare lensflare ghost ghosts ghosting reflections veilingglare | ghosts report | ghosts LENS --light 15,10 --out DIR computes the reflections of a light.
 chromatic chromaticaberration fringing fringes color colors ca | colour psf | colour LENS --out DIR draws longitudinal and lateral colour.
 kernel kernels convolution pointspread | psf psf-set | psf-set writes point images over field, distance, wavelength and f-number.
 scheimpflug tiltshift shift swing | tilt render blur | tilt LENS --points FILE makes points sharp; render and blur take --tilt.
 blender cycles | convert metadata blur | convert LENS camera.osl writes a camera. Guide: lib/docs/hosts_for_artists.md.
 nuke natron fusion resolve aftereffects compositing stmap stmaps | metadata blur psf-set | metadata LENS --out DIR writes ST maps. Guide: lib/docs/hosts_for_artists.md.
 unreal ue5 unrealengine opentrackio | metadata | metadata LENS --out DIR writes OpenTrackIO and ST maps. Guide: lib/docs/hosts_for_artists.md.
 unity hlsl glsl shader shaders gpu | export | export LENS --camera lens.bin writes a lens for shaders. Guide: lib/docs/hosts_for_artists.md.
 houdini karma vex arnold renderman pbrt mitsuba povray osl | convert export camera-rays | Guides: lib/docs/hosts_for_artists.md and examples/hosts/README.md.
 zemax opticstudio codev oslo zmx seq import opticalbench | convert report | Every command reads .zmx, .seq, .len and tables; convert IN OUT.zmx writes them.
 zoom | report | --configuration NAME chooses the position of a zoom lens.
)";

std::string plain(std::string_view word) {
  std::string result;
  for (const char c : word) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) result += static_cast<char>(c | 0x20);
  }
  return result;
}

/// The commands of a task, between blanks, and the text.
std::pair<std::string, std::string_view> task_of(std::string_view word) {
  const std::string wanted = ' ' + plain(word) + ' ';
  for (std::size_t begin = 1, end; (end = tasks.find('\n', begin)) != tasks.npos; begin = end + 1) {
    const std::string_view line = tasks.substr(begin, end - begin);
    const std::size_t commands = line.find('|'), text = line.rfind('|');
    if (line.substr(0, commands).find(wanted) == line.npos) continue;
    return {std::string(line.substr(commands + 1, text - commands - 1)), line.substr(text + 2)};
  }
  return {};
}

}  // namespace

std::string first_command_for(std::string_view word) {
  const std::string commands = task_of(word).first;
  return commands.empty() ? "" : commands.substr(1, commands.find(' ', 1) - 1);
}

bool print_help_on(const std::string& word) {
  const auto [of_task, text] = task_of(word);
  if (!text.empty()) std::cout << text << "\n\n";
  bool any = false;
  for_each([&, &commands = of_task](const Command& command, const examples::CommandText& help) {
    const std::string name(command.name);
    std::string flags;  // without a task: the options that mention the word
    for (const examples::OptionText& option : help.options) {
      const bool mentions =
          plain(word).size() > 2 && plain(option.flag + option.help).find(plain(word)) != std::string::npos;
      if (commands.empty() && mentions) flags += ' ' + option.flag;
    }
    if (flags.empty() && commands.find(' ' + name + ' ') == std::string::npos) return;
    std::cout << "petzval help " << name << std::string(13 - name.size(), ' ')
              << (flags.empty() ? std::string(command.summary) : "all:" + flags) << '\n';
    any = true;
  });
  return any;
}

}  // namespace commands
