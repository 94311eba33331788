// SPDX-License-Identifier: Apache-2.0
// Blurs layers of a scene, or a picture with depths, by a thin lens, a singlet or any prescription.
//
//   petzval blur --scene town --thin-lens 50 --f-number 0.5 --focus 5000 --compare --out out
//   petzval blur --scene street data/lenses/double_gauss_52mm_f1.8.json --focus 3000 --rays 32 --out out
//   petzval blur --image photo.jpg --depth photo.pfm --thin-lens 85 --f-number 1.42 --focus 2000 --out out
#include "commands.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "layers/layer_input.hpp"
#include "layers/layer_picture.hpp"
#include "layers/lens_setup.hpp"
#include "layers/lit_scene.hpp"
#include "layers/picture_quality.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/parallel.hpp"
#include "petzval/image/exr.hpp"
#include "petzval/image/image.hpp"
#include "support/cli.hpp"
#include "support/contact_sheet.hpp"
#include "support/files.hpp"
#include "support/picture_files.hpp"
#include "support/svg_page.hpp"
#include "support/text.hpp"

namespace {

using examples::Json;
using petzval::RgbImage;

struct Options {
  lens_blur::InputFlags input;
  lens_blur::LensFlags lens;
  std::uint32_t layers = 4, supersample = 0, ghosts = 0;
  std::uint32_t frames = 1;                     ///< CameraFlags::frame_count()
  double travel_mm = 0, highlights_above = -1;  ///< highlights_above < 0: lens_blur::threshold_of()
  bool compare = false;
  std::uint32_t compare_rays = 0;  ///< 0: no comparison with more rays
  std::vector<std::string> formats;
  std::string out_folder, deep_out;
};

/// Largest number of frames in frames.svg.
constexpr std::size_t most_shown = 8;

/// Largest change of the reference of a still pixel from frame to frame, in each colour.
constexpr float most_still_change = 1e-3f;

constexpr examples::Range supersamples{1, 4, "1, 2 or 4"};

/// The middle of a picture, at most 320 x 240 pixels.
RgbImage middle_of(const RgbImage& picture) {
  RgbImage middle(std::min(picture.width, 320), std::min(picture.height, 240));
  for (int y = 0; y < middle.height; ++y) {
    const float* const row =
        picture.pixel((picture.width - middle.width) / 2, y + (picture.height - middle.height) / 2);
    std::copy_n(row, 3 * middle.width, middle.pixel(0, y));
  }
  return middle;
}

/// A grey image of a number for each pixel.
template <class Of>
RgbImage grey(const petzval::BlurredImage& picture, const Of& of) {
  RgbImage image(picture.columns, picture.rows);
  for (std::size_t i = 0; i < picture.missed.size(); ++i) std::fill_n(&image.pixels[3 * i], 3, of(i));
  return image;
}

lens_blur::LensFlags for_pixels(lens_blur::LensFlags flags, int side, bool of_file) {
  flags.pattern.supersample = static_cast<std::uint32_t>(side), flags.pattern.over_pixels = of_file;
  return flags;
}

class Job {
 public:
  explicit Job(const Options& options)
      : options_(options),
        threads_(examples::threads()),
        input_(options.input),
        side_(options.supersample > 0 ? static_cast<int>(options.supersample)
              : input_.scene()        ? 2
                                      : 1),
        lens_(for_pixels(options.lens, side_, !input_.scene()), input_.columns(), input_.rows(), input_.pose(),
              options.frames > 1) {
    if (options.frames == 1 && options.travel_mm != 0) {
      throw petzval::Error("--travel: --frames = 1; must be 2 or more");
    }
    if (options.compare_rays == 0 && options.lens.ray_counts.size() > 1) {
      throw petzval::Error("--rays: " + std::to_string(options.lens.ray_counts.size()) +
                           " numbers; must be 1 without --compare-rays");
    }
    if (options.compare_rays > 0 && options.frames > 1) {
      throw petzval::Error("--compare-rays: --frames = " + std::to_string(options.frames) + "; must be 1");
    }
    if (options.ghosts > 0 && options.lens.thin()) {
      throw petzval::Error("--ghosts with --thin-lens, which has no surfaces; must be a lens of surfaces");
    }
    if (side_ == 3) throw petzval::Error(std::string("--supersample = 3; must be ") + supersamples.words);
    if (side_ > 1 && !options.deep_out.empty()) {
      throw petzval::Error("--deep-out: --supersample = " + std::to_string(side_) + "; must be 1");
    }
    if (!input_.scene()) {
      if (options.compare) throw petzval::Error("--compare needs --scene");
      if (options.travel_mm != 0) throw petzval::Error("--travel needs --scene: files have a fixed camera");
      input_.refine(side_);
    }
  }

  void run() {
    const std::filesystem::path folder = options_.out_folder;
    examples::make_folder(folder);
    std::optional<examples::Progress> progress;
    if (options_.frames > 1) progress.emplace("petzval blur", options_.frames);
    // A distance out of reach is refused before the first frame.
    if (options_.lens.setup.pull.moves())
      lens_.focus_at(options_.lens.setup.pull.nearest_mm(), input_.scene() != nullptr);
    for (std::uint32_t frame = 0; frame < options_.frames; ++frame) {
      if (progress) progress->step("frame " + std::to_string(frame + 1));
      try {
        do_frame(frame, folder, options_.frames > 1 ? "_" + examples::frame_number(frame) : "");
      } catch (const petzval::Error&) {
        input_.refuse_near(nearest_mm_, lens_.focal_length_mm(), true);
        throw;
      }
    }
    result_["model"] = petzval::name(lens_.model());
    if (options_.compare && options_.frames > 1) {
      result_["flicker"] = flicker_ / (options_.frames - 1);
      result_["still_change"] = examples::finite_or_null(still_change_ / still_count_);
    }
    if (options_.frames > 1) write_frames(folder);
    if (options_.compare_rays > 0) compare_rays(folder);
    want_free(folder / "blur.json");
    if (!options_.deep_out.empty()) petzval::write_deep_exr(input_.held_out(), options_.deep_out);
    examples::write_text(folder / "blur.json", result_.dump(1) + '\n');
    progress.reset();
    if (rays_error_px_ > 1) {
      std::cerr << "note: rays are interpolated over the picture, with errors of up to "
                << examples::number(rays_error_px_, 3) << " pixels\n";
    }
    std::cout << (folder / "blur.json").string() << '\n';
  }

 private:
  void do_frame(std::uint32_t frame, const std::filesystem::path& folder, const std::string& number) {
    const examples::FocusPull& pull = options_.lens.setup.pull;
    const double time = pull.time_s(frame);
    double focus_mm = *options_.lens.setup.focus_mm;
    if (pull.moves()) {
      focus_mm = pull.distance_mm(frame, options_.frames);
      // The camera of a file keeps its angle.
      lens_.focus_at(focus_mm, input_.scene() != nullptr);
    }
    const double travelled_mm = options_.frames > 1 ? options_.travel_mm * frame / (options_.frames - 1.0) : 0;
    if (input_.scene()) input_.scene()->move_to({static_cast<float>(travelled_mm), 0, 0});
    const double nearest = nearest_mm_ = input_.nearest_mm(lens_.layers(), threads_);
    if (!std::isfinite(nearest))
      throw petzval::Error(input_.file() + ": no depth is finite and positive; must have at least one");
    input_.refuse_near(nearest, lens_.focal_length_mm());
    auto start = std::chrono::steady_clock::now();
    // A smaller depth than the nearest surface: layers extend beyond the picture, where objects may be nearer.
    const petzval::LensRays rays = lens_.rays(lens_blur::least_depth(nearest), threads_, time, travelled_mm);
    const double rays_ms = examples::ms_since(start);
    rays_error_px_ = std::max(rays_error_px_, rays.interpolation_error_px());
    const petzval::PeelPlan plan = lens_blur::plan_of(input_, rays, nearest);

    start = std::chrono::steady_clock::now();
    input_.fill(plan, static_cast<int>(options_.layers), threads_, layers_);
    const double n_buffer_ms = 1e3 * layers_.n_buffer_seconds(), peel_ms = examples::ms_since(start) - n_buffer_ms;
    // All frames have the threshold of the first frame.
    if (options_.highlights_above < 0) options_.highlights_above = lens_blur::threshold_of(layers_, !input_.scene());
    const double threshold = options_.highlights_above;
    start = std::chrono::steady_clock::now();
    petzval::gather(layers_, rays, {.threads = threads_, .highlights_above = threshold}, blurred_);
    const double gather_ms = examples::ms_since(start);
    nearest_mm_ = std::numeric_limits<double>::infinity();  // later errors have other reasons
    const RgbImage picture = lens_blur::averaged(lens_blur::colours_of(blurred_), side_);
    std::map<std::string, std::vector<float>> channels;
    Json ghost_json;
    if (input_.deep()) {
      const RgbImage alpha =
          lens_blur::averaged(grey(blurred_, [&](std::size_t i) { return blurred_.rgba[4 * i + 3]; }), side_);
      for (std::size_t i = 0; i < alpha.pixels.size(); i += 3) channels["A"].push_back(alpha.pixels[i]);
    }
    RgbImage seen = picture;
    if (options_.ghosts > 0) {
      start = std::chrono::steady_clock::now();
      const auto parts = lens_blur::bright_parts(layers_, rays.camera(), threshold, options_.ghosts);
      const RgbImage ghosts = lens_.ghosts(parts, threads_);
      std::ranges::transform(picture.pixels, ghosts.pixels, seen.pixels.begin(), std::plus());
      examples::add_channels(channels, "ghosts.", ghosts);
      const auto light = [](const RgbImage& of) { return std::reduce(of.pixels.begin(), of.pixels.end(), 0.0); };
      ghost_json = {{"lights", parts.size()},
                    {"fraction", examples::finite_or_null(light(ghosts) / light(picture))},
                    {"ms", examples::ms_since(start)}};
    }
    write(seen, folder / ("blur" + number), channels);
    if (frame == 0) {
      write(lens_blur::averaged(lens_blur::sharp_of(layers_, rays.camera()), side_), folder / "sharp");
      write(lens_blur::averaged(grey(blurred_, [&](std::size_t i) { return blurred_.missed[i]; }), side_),
            folder / "missed");
    }

    Json json{{"lens", lens_.name()},
              {"columns", picture.width},
              {"rows", picture.height},
              {"layers", layers_.count()},
              {"most_layers", plan.most_layers},
              {"rays", rays.count() * static_cast<std::size_t>(side_ * side_)},
              {"overscan_px", plan.camera.overscan},
              {"rays_ms", rays_ms},
              {"rays_error_px", rays.interpolation_error_px()},
              {"peel_ms", peel_ms},
              {"nbuffer_ms", n_buffer_ms},
              {"gather_ms", gather_ms},
              {"total_ms", peel_ms + n_buffer_ms + gather_ms},
              {"memory_mb", 1e-6 * static_cast<double>(layers_.memory_bytes())},
              {"miss_rate", static_cast<double>(blurred_.missed_count) / static_cast<double>(blurred_.ray_count)},
              {"highlights_above", threshold},
              {"highlights", blurred_.highlight_count},
              {"supersample", side_}};
    if (options_.lens.setup.points_file.empty()) json["focus_mm"] = examples::finite_or_null(focus_mm);
    if (!ghost_json.is_null()) json["ghosts"] = ghost_json;
    if (options_.compare) compare(rays, picture, json);
    if (options_.frames > 1 && frame * most_shown / options_.frames >= shown_.size()) {
      const bool infinite = std::isinf(focus_mm);
      shown_.push_back({petzval::to_srgb8(seen),
                        {!pull.moves() ? examples::number(time, 3) + " s"
                         : infinite    ? "infinity"
                                       : examples::number(focus_mm / 1000, 3) + " m"}});
    }
    if (frame == 0) result_["setup"] = Json::parse(petzval::to_json(lens_.setup()));
    if (options_.frames == 1) {
      result_.update(json);
    } else {
      result_["frames"].push_back(json);
    }
  }

  /// Writes frames.svg: up to 8 frames at equal steps of time.
  void write_frames(const std::filesystem::path& folder) {
    const bool thick = lens_.model() == petzval::ModelKind::thick;
    examples::Sheet sheet{.title = lens_.name() + (thick ? " (thick lens)" : ""), .rows = {}, .notes = {}};
    for (examples::Tile& tile : shown_) {
      if (sheet.rows.empty() || sheet.rows.back().tiles.size() == most_shown / 2) {
        sheet.rows.emplace_back().columns = most_shown / 2;
      }
      sheet.rows.back().tiles.push_back(std::move(tile));
    }
    sheet.notes.push_back(std::to_string(options_.frames) + " frames");
    if (options_.compare) {
      sheet.notes.back() +=
          "; flicker " + examples::number(result_["flicker"].get<double>(), 3) +
          ": RMS change of the error from frame to frame, against rays traced through the scene (white is 1)";
    }
    write_sheet(sheet, folder / "frames.svg");
  }

  /// Blurs the same layers with each number of rays of --rays and compares the pictures with --compare-rays rays.
  void compare_rays(const std::filesystem::path& folder) {
    const double nearest = input_.nearest_mm(lens_.layers(), threads_);
    const std::vector<std::uint32_t> counts =
        options_.lens.ray_counts.empty() ? std::vector{lens_.ray_count()} : options_.lens.ray_counts;
    bool filled = false;
    double ms = 0;
    const auto picture = [&](std::uint32_t count) {
      lens_.set_rays(count);
      const petzval::LensRays rays = lens_.rays(lens_blur::least_depth(nearest), threads_);
      if (!std::exchange(filled, true)) {
        input_.fill(lens_blur::plan_of(input_, rays, nearest), static_cast<int>(options_.layers), threads_, layers_);
      }
      const auto start = std::chrono::steady_clock::now();
      petzval::gather(layers_, rays,
                      {.threads = threads_, .highlights_above = result_["highlights_above"].get<double>()}, blurred_);
      ms = examples::ms_since(start);
      return lens_blur::averaged(lens_blur::colours_of(blurred_), side_);
    };
    const RgbImage most = picture(options_.compare_rays);
    result_["compare_rays"] = options_.compare_rays, result_["compare_rays_ms"] = ms;
    write(most, folder / "many_rays");
    examples::Sheet sheet{.title = "Quality and number of rays", .rows = {{}}, .notes = {}};
    const auto add = [&](const RgbImage& image, std::uint32_t count, double time_ms) {
      sheet.rows[0].tiles.push_back({petzval::to_srgb8(middle_of(image)),
                                     {std::to_string(count) + " rays", std::to_string(std::lround(time_ms)) + " ms"}});
    };
    std::vector<lens_blur::RayQuality> qualities;
    for (const std::uint32_t count : counts) {
      const RgbImage image = picture(count);
      const lens_blur::Likeness like = lens_blur::likeness(image, most);
      result_["quality"].push_back({{"rays", count},
                                    {"gather_ms", ms},
                                    {"psnr_db", examples::finite_or_null(like.psnr_db)},
                                    {"ssim", like.ssim}});
      qualities.push_back({static_cast<double>(count), like.psnr_db});
      add(image, count, ms);
      std::vector<std::string>& captions = sheet.rows[0].tiles.back().captions;
      captions.push_back(examples::number(like.psnr_db, 3) + " dB");
      captions.push_back("SSIM " + examples::number(like.ssim, 4));
    }
    add(most, options_.compare_rays, result_["compare_rays_ms"].get<double>());
    write_sheet(sheet, folder / "ray_counts.svg");
    examples::write_text(folder / "rays.svg",
                         lens_blur::quality_plot(qualities, "against " + std::to_string(options_.compare_rays) +
                                                                " rays of the same layers, " + lens_.name()));
    std::cout << (folder / "rays.svg").string() << '\n';
  }

  void write_sheet(const examples::Sheet& sheet, const std::filesystem::path& file) const {
    examples::write_svg(examples::draw_sheet(sheet), file);
    std::cout << file.string() << '\n';
  }

  void compare(const petzval::LensRays& rays, const RgbImage& picture, Json& json) {
    const auto start = std::chrono::steady_clock::now();
    const RgbImage reference = lens_blur::averaged(input_.scene()->reference(rays, threads_), side_);
    json["reference_ms"] = examples::ms_since(start);
    // Both trace the same number of rays.
    const auto ns_per_ray = [&](double ms) { return 1e6 * ms / static_cast<double>(blurred_.ray_count); };
    json["ns_per_ray"] = ns_per_ray(json["total_ms"].get<double>());
    json["reference_ns_per_ray"] = ns_per_ray(json["reference_ms"].get<double>());
    const lens_blur::Likeness all = lens_blur::likeness(picture, reference);
    json["psnr_db"] = examples::finite_or_null(all.psnr_db), json["ssim"] = all.ssim;
    if (side_ == 1) {
      const lens_blur::Likeness edges =
          lens_blur::likeness(picture, reference, lens_blur::near_depth_edges(layers_, rays));
      json["psnr_edges_db"] = examples::finite_or_null(edges.psnr_db), json["ssim_edges"] = edges.ssim;
    }
    std::vector<float> flip = lens_blur::flip(picture, reference);
    double sum = 0;
    for (const float f : flip) sum += static_cast<double>(f);
    json["flip_mean"] = sum / static_cast<double>(flip.size());
    const auto last = flip.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(flip.size()));
    std::nth_element(flip.begin(), last, flip.end());
    json["flip_p99"] = *last;
    const double drift = lens_blur::energy_drift(picture, reference);
    json["energy_drift"] = drift;
    if (std::abs(drift) > 0.01) {
      std::cerr << "note: the picture has " << examples::number(100 * std::abs(drift), 2) << " % "
                << (drift > 0 ? "more" : "less") << " light than the reference\n";
    }

    // Flicker: change of the error from frame to frame.
    std::vector<float> error(picture.pixels.size());
    for (std::size_t i = 0; i < error.size(); ++i) error[i] = picture.pixels[i] - reference.pixels[i];
    if (!last_error_.empty()) {
      double squares = 0;
      for (std::size_t i = 0; i < error.size(); i += 3) {
        float moved = 0;
        double change = 0;
        for (std::size_t c = i; c < i + 3; ++c) {
          const double off = std::abs(static_cast<double>(error[c] - last_error_[c]));
          squares += off * off, change += off / 3;
          moved = std::max(moved, std::abs(reference.pixels[c] - last_reference_[c]));
        }
        if (moved <= most_still_change) still_change_ += change, ++still_count_;
      }
      flicker_ += std::sqrt(squares / static_cast<double>(error.size()));
    }
    last_error_ = std::move(error), last_reference_ = reference.pixels;
    if (options_.frames == 1) write(reference, std::filesystem::path(options_.out_folder) / "reference");
  }

  /// @throws petzval::Error if a file of --out is also an input or --deep-out
  void want_free(const std::filesystem::path& file) const {
    const lens_blur::InputFlags& input = options_.input;
    for (const std::string& other : {input.image, input.depth, input.deep, input.holdout, options_.deep_out}) {
      if (other.empty() || std::filesystem::weakly_canonical(other) != std::filesystem::weakly_canonical(file))
        continue;
      throw petzval::Error("--out: " + file.string() + " is a file of another flag; must be another folder");
    }
  }

  void write(const RgbImage& image, const std::filesystem::path& stem,
             const std::map<std::string, std::vector<float>>& channels = {}) const {
    for (const std::string& format : options_.formats) want_free(stem.string() + '.' + format);
    for (const auto& file :
         examples::write_picture(image, petzval::to_srgb8(image), options_.formats, stem, {}, {}, channels)) {
      std::cout << file.string() << '\n';
    }
  }

  Options options_;
  int threads_;
  lens_blur::LayerInput input_;
  int side_;
  lens_blur::BlurLens lens_;
  petzval::LayerSet layers_;
  petzval::BlurredImage blurred_;
  Json result_;
  std::vector<examples::Tile> shown_;  ///< tiles of frames.svg
  std::vector<float> last_error_, last_reference_;
  double nearest_mm_ = std::numeric_limits<double>::infinity();  ///< while a picture is computed
  double flicker_ = 0, rays_error_px_ = 0;                       ///< rays_error_px_: maximum over all frames
  double still_change_ = 0, still_count_ = 0;
};

}  // namespace

int commands::blur(int argc, char** argv) {
  Options options;
  examples::App app(
      "Blurs layers of a scene, or a picture with depths, by a lens that is focused at --focus. Writes DIR/blur.*, "
      "sharp.* (the picture of a pinhole), missed.* (the fraction of rays that hit surfaces outside the layers) and "
      "blur.json; with --compare also reference.*, the same rays traced through the scene.",
      "petzval blur");
  lens_blur::add_input(app, options.input, options.lens.fov_deg, options.layers);
  lens_blur::add_lens(app, options.lens,
                      "written as blur_0001.* and so on, and up to 8 of them side by side in frames.svg; --points then "
                      "gives focus points with keys");
  app.add_flag("--compare", options.compare,
               "compare the picture of a scene with the same rays traced through the scene");
  examples::add_count(app, "--compare-rays", options.compare_rays, {1, 1 << 20, "a whole number from 1 to 1048576"},
                      "compare the pictures of all numbers of --rays with a picture of this many rays of the same "
                      "layers: ray_counts.svg, rays.svg, many_rays.* and `quality` in blur.json")
      ->default_str("");
  examples::add_count(app, "--supersample", options.supersample, supersamples,
                      "subpixels per pixel in each direction, averaged; the rays of a pixel are divided between its "
                      "subpixels. Rays of files are spread over each pixel in any case")
      ->default_str("2; files: 1");
  examples::add_number(app, "--highlights-above", options.highlights_above, {0, 1e9, "a number from 0 to 1e9"},
                       "radiance above which small lights become uniform discs; 0: never")
      ->default_str("6 times the mean; at most 1, or 0.75 in files without values above 1");
  lens_blur::add_ghosts(app, options.ghosts, "Also the channels ghosts.R, .G and .B of blur.exr");
  examples::add_out_file(
      app, options.deep_out,
      "deep picture of the samples of --deep that --holdout leaves, not blurred, with depths along the axis in mm",
      "DEEP.exr", "--deep-out")
      ->needs(app.get_option("--deep"));
  examples::add_length(app, "--travel", options.travel_mm, examples::finite_number,
                       "distance that the camera moves to the right over all frames (mm)");
  examples::add_threads(app);
  examples::add_formats(app, options.formats, "png (sRGB)");
  examples::add_out_folder(app, options.out_folder)->required();
  return examples::run(app, argc, argv, [&] {
    const petzval::Film& film = options.lens.setup.film;
    if (options.lens.setup.pixels_given && !options.input.scene.empty() && options.input.width == 0) {
      options.input.width = static_cast<std::uint32_t>(film.columns);
      options.input.height = static_cast<std::uint32_t>(film.rows);
    }
    options.frames = options.lens.setup.frame_count();
    Job(options).run();
  });
}
