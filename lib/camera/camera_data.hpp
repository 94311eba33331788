// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>

#include "camera/ray_model.hpp"
#include "petzval/camera/camera.hpp"
#include "petzval/lens/lens.hpp"
#include "sample_rays.hpp"
#include "scene_side.hpp"
#include "tilted_film.hpp"

namespace petzval {

/// Access of the library to the data of a camera.
struct CameraAccess {
  using Data = Camera::Data;
  static const Data& data(const Camera& camera) noexcept { return *camera.data_; }
  static Camera camera(std::shared_ptr<const Data> data) noexcept { return Camera(std::move(data)); }
};

/// Data that a camera computes once: the film side in the constructor, the scene side on first use.
struct Camera::Data {
  /// @param radius upright_radius() of the film
  Data(const camera_detail::LensFacts& facts, const Film& placed, std::shared_ptr<const RayModel> model, double radius,
       const CameraOptions& options);

  Lens lens;
  Film film;

 private:
  std::shared_ptr<const RayModel> model_;

 public:
  const RayModel& model;
  std::optional<camera_detail::TiltedFilm> tilted;
  camera_detail::PupilWeights weights;
  camera_detail::Transmission transmission;
  camera_detail::WavelengthFacts wavelengths;  ///< scales of weights and importance
  camera_detail::Front front;
  camera_detail::LocalFocus focus;
  Normalisation normalisation;
  double pdf_film;  ///< density of uniform film points, 1/mm^2

  const camera_detail::FilmView& view() const noexcept { return view_; }
  /// A wavelength as an index or in nm, clamped if the camera clamps.
  Wavelength resolved(Wavelength given) const noexcept {
    if (!given.in_nm()) return given.index(primary_);
    return clamp_ ? Wavelength::nm(clamped(*given.in_nm())) : given;
  }
  /// Resolves the wavelengths of N rays and calls of_rays(begin, count, wavelengths) for consecutive ranges. One call
  /// covers all rays unless each ray has a wavelength in nm that must be clamped.
  template <class OfRays>
  void in_range(std::size_t count, const RayWavelengths& given, const OfRays& of_rays) const {
    RayWavelengths own = given.resolved(primary_);
    if (!clamp_ || !own.in_nm()) return of_rays(0, count, own);
    if (!own.each_nm) own.all = resolved(own.all);
    if (!own.each_nm) return of_rays(0, count, own);
    std::array<float, 256> nm;
    for (std::size_t begin = 0; begin < count; begin += nm.size()) {
      const std::size_t n = std::min(nm.size(), count - begin);
      for (std::size_t i = 0; i < n; ++i) {
        nm[i] = static_cast<float>(clamped(double{given.each_nm[begin + i]}));
      }
      own.each_nm = nm.data();
      of_rays(begin, n, own);
    }
  }
  /// The scene side is built on first use, because many renderers only trace paths from the film.
  const camera_detail::SceneSide& scene(int threads = 1) const {
    std::call_once(scene_once_, [&] {
      scene_.emplace(facts_, film, tilted, front, focus, model, radius_, wavelengths, weights, transmission, threads);
    });
    return *scene_;
  }

 private:
  /// NaN stays NaN.
  double clamped(double nm) const noexcept { return std::clamp(nm, shortest_nm_, longest_nm_); }

  camera_detail::LensFacts facts_;
  double radius_;
  std::size_t primary_;
  bool clamp_;
  double shortest_nm_, longest_nm_;
  camera_detail::FilmView view_;
  mutable std::once_flag scene_once_;
  mutable std::optional<camera_detail::SceneSide> scene_;
};

}  // namespace petzval
