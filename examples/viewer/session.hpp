// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "layers/layer_input.hpp"
#include "layers/lens_view.hpp"
#include "petzval/blur/layers.hpp"
#include "petzval/blur/lens_rays.hpp"
#include "petzval/editor/focus_editor.hpp"
#include "petzval/image/image.hpp"
#include "support/files.hpp"

/// Interactive lens blur without its window.
namespace viewer {

/// The scene, the lens and the resources of a session.
struct SessionOptions {
  lens_blur::InputFlags input;
  petzval::CameraSetup setup;  ///< of FocusEditor
  double fov_deg = 0;          ///< vertical; 0: 30 for a thin lens, else the angle of a film 24 mm high
  std::uint32_t layers = 4;
  std::uint32_t ghosts = 0;  ///< number of bright parts with ghosts, to first order before the still picture
  int threads = 1;
  int file_columns = 0, file_rows = 0;  ///< required size of files; 0: any size
};

/// A picture of the state of a session.
struct Frame {
  petzval::RgbImage picture;
  std::uint32_t rays = 0;    ///< per pixel
  double milliseconds = 0;   ///< for rays and gather; for a still picture also for its layers
  double memory_mb = 0;      ///< memory of the layers and the blurred picture
  bool first_order = false;  ///< a preview without aberrations
  bool still = false;        ///< the picture of `petzval blur`
};

/// The status of a state in words; empty if the points are served.
std::string in_words(const petzval::FocusEditorState& state);
/// The status of a point in words; empty if the point is used.
std::string in_words(const petzval::FocusMark& mark);

/// The lens of a state as its file or its name.
const std::string& lens_name(const petzval::FocusEditorState& state);
/// The lens of a state as its file, configuration and name; empty: a thin lens.
std::string lens_key(const petzval::FocusEditorState& state);

class Session;
/// The sentence for a state of which no picture can be computed.
std::string no_picture(const Session& session, const petzval::Error& why);

/// A scene in layers, a focus editor, and pictures of its state.
///
/// Layers are kept while the focus changes. They are made for the widest aperture so far.
class Session {
 public:
  explicit Session(const SessionOptions& options);
  Session(const Session&) = delete;  // the editor calls back
  Session& operator=(const Session&) = delete;

  petzval::FocusEditor& editor() noexcept { return *editor_; }
  const petzval::FocusEditor& editor() const noexcept { return *editor_; }

  /// Makes the layers that the aperture of the state needs. Returns the time in ms; 0 if the layers are kept.
  double make_layers();
  /// True if make_layers() would make new layers.
  bool layers_are_too_small() const;

  /// A picture with few rays of the layers that are kept.
  ///
  /// @param rays         per pixel
  /// @param first_order  true: without the aberrations of a real lens, whose rays take longer to set up
  Frame frame(std::uint32_t rays, bool first_order = false, const std::stop_token& stop = {});
  /// The picture that the command of blur_command() computes.
  Frame still(const std::stop_token& stop = {});

  /// For each pixel of the picture, the blur of the first surface in pixels: negative in front of the plane of focus.
  std::vector<float> blur_map() const;
  /// The depth of the first layer at each pixel (mm); 0: none.
  float depth_mm(int column, int row) const;

  /// The raster positions of the points of the state, through the camera of the state.
  std::vector<std::optional<petzval::Vec2<double>>> handles() const;
  /// The picture of a pinhole.
  petzval::RgbImage sharp() const;
  /// Pixels of the picture per unit of slope.
  double focal_px() const noexcept { return camera_.focal_px; }

  /// The state as a JSON object of `petzval view --replay`, with times and memory of the frame.
  examples::Json state_json(const Frame& frame) const;
  /// The scene, the lens and all events: the file of --replay.
  examples::Json log() const;
  /// The command line that makes the still picture. Writes the set-up of the state to a file, with the distance in
  /// focus also of a lens that cannot focus at it.
  std::string blur_command(const std::string& setup_file) const;

 private:
  petzval::Lens load(const petzval::CameraSetup& setup);
  std::optional<petzval::FocusPlace> place(const petzval::Ray<double>& ray) const;
  lens_blur::LensView view() const;
  void add_ghosts(petzval::RgbImage& picture, const lens_blur::LensView& lens, const petzval::LayerSet& layers,
                  const petzval::LayerCamera& camera, double threshold, petzval::GhostModel model) const;
  double widest_radius(const lens_blur::LensView& view) const;
  void update_camera();

  SessionOptions options_;
  lens_blur::LayerInput input_;
  std::map<std::string, petzval::Lens> lenses_;  ///< by their source as JSON
  std::optional<petzval::FocusEditor> editor_;

  petzval::LayerCamera camera_;  ///< camera of the layers, without overscan
  std::string camera_lens_;      ///< lens_key() of camera_
  double nearest_mm_ = 0;
  petzval::LayerSet layers_;
  double radius_mm_ = 0;  ///< radius of the pupil for which layers_ was made
  double threshold_ = 0;  ///< of highlights
  petzval::BlurredImage blurred_;
};

/// The events of a log. @throws petzval::Error that names the file
examples::Json events_of(const examples::Json& log, const std::string& where);

/// The session of a log, without its events. @throws petzval::Error that names the file and the key
SessionOptions options_of(const examples::Json& log, const std::string& where);

}  // namespace viewer
