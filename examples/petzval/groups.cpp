// SPDX-License-Identifier: Apache-2.0
// The groups of commands in the overview.
#include <array>

#include "commands.hpp"

namespace commands {
namespace {

#ifdef PETZVAL_HAS_FIT
constexpr auto pull_command = &pull, tilt_command = &tilt;
#else
constexpr int (*pull_command)(int, char**) = nullptr, (*tilt_command)(int, char**) = nullptr;
#endif
#ifdef PETZVAL_HAS_RENDERER
constexpr auto render_command = &render, sheet_command = &sheet, blur_command = &blur;
#else
constexpr int (*render_command)(int, char**) = nullptr, (*sheet_command)(int, char**) = nullptr,
                                     (*blur_command)(int, char**) = nullptr;
#endif
#if defined(PETZVAL_HAS_FIT) && defined(PETZVAL_HAS_RENDERER)
constexpr auto view_command = &view;
#else
constexpr int (*view_command)(int, char**) = nullptr;
#endif
constexpr std::string_view ceres = "Ceres", embree = "Embree 3 and tinyobjloader";

constexpr std::array lens_commands{
    Command{"lenses", "list and search the shipped lenses", "gauss", &lenses},
    Command{"report", "first order, pupils and figures of a lens", "double_gauss_52mm_f1.8 --out out", &report},
    Command{"convert", "write a lens in another format", "cooke_triplet_50mm_f5 triplet.zmx", &convert},
    Command{"export", "a camera for shaders, ray maps, calibrations", "double_gauss_52mm_f1.8 --camera camera.h",
            &export_camera},
    Command{"metadata", "OpenTrackIO and ST maps for compositing", "biogon_35mm_f2.8 --out out", &metadata},
};
constexpr std::array focus_commands{
    Command{"focus", "focus, depth of field and breathing", "double_gauss_52mm_f1.8 --at 1m,3m,inf", &focus},
    Command{"tilt", "tilt the film to focus points", "double_gauss_100mm_f2_28deg --points points.json --out out",
            tilt_command, ceres},
    Command{"pull", "film positions over time from keys", "double_gauss_100mm_f2.0 --keys keys.json --out out",
            pull_command, ceres},
    Command{"surface", "focus that varies over the picture", "double_gauss_52mm_f1.8 --points points.json --out out",
            &surface},
};
constexpr std::array figure_commands{
    Command{"trace", "trace rays of a table", "double_gauss_52mm_f1.8 --table rays.csv --out traced.csv", &trace},
    Command{"spots", "spot diagrams over field and wavelength", "cooke_triplet_50mm_f5 --out out", &spots},
    Command{"psf", "images of a point light", "double_gauss_100mm_f1.35 --at 1.5m --focus 1m --out out", &psf},
    Command{"psf-set", "PSFs over field, distance, wavelength and f-number; merge, query",
            "double_gauss_100mm_f2_28deg --fields 0,10 --at 1m,inf --focus 2m --out out", &psf_set},
    Command{"ghosts", "reflections between surfaces: ghosts of a light",
            "double_gauss_52mm_f1.8 --light 15,10 --out out", &ghosts},
    Command{"colour", "colours of out-of-focus lights", "double_gauss_100mm_f1.35 --out out", &colour},
    Command{"shapes", "irises, cat's eyes and weights", "--out out", &shapes},
    Command{"expressive", "a first-order lens with scaled aberrations", "double_gauss_100mm_f1.35 --out out",
            &expressive},
};
constexpr std::array renderer_commands{
    Command{"models", "errors and times of the ray models of a camera", "double_gauss_100mm_f2.0", &models},
    Command{"choose", "the fastest ray model within a budget",
            "double_gauss_100mm_f2.0 --near 1.5m --far 10m --budget 0.5", &choose},
    Command{"camera-rays", "rays of a camera for samples of a table, or for POV-Ray",
            "biogon_35mm_f2.8 --table in.csv --model thick --focus 3m --out rays.csv", &camera_rays},
    Command{"render", "path, light or bidirectional tracing through a lens; merge",
            "double_gauss_100mm_f2.0 --scene street --focus 3m --out out", render_command, embree},
    Command{"sheet", "contact sheets of pictures", "out/a out/b --out sheet.svg", sheet_command, embree},
    Command{"blur", "lens blur of layers or of a picture with depth",
            "--scene town double_gauss_52mm_f1.8 --focus 3m --out out", blur_command, embree},
    Command{"view", "lens blur in a window: focus by clicking", "--scene town double_gauss_52mm_f1.8", view_command,
            "Ceres, Embree 3 and tinyobjloader"},
};
constexpr std::array all_groups{
    Group{"Lenses", lens_commands},
    Group{"Focus", focus_commands},
    Group{"Rays and points of light", figure_commands},
    Group{"Cameras and pictures", renderer_commands},
};

}  // namespace

std::span<const Group> groups() { return all_groups; }

}  // namespace commands
