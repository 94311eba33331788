// SPDX-License-Identifier: Apache-2.0
#pragma once
// Handles of petzval.h as classes, for C++11 and later, with or without exceptions.
//
//     petzval17::Lens lens = petzval17::Lens::read("data/lenses/double_gauss_52mm_f1.8.json");
//     lens.f_number(2.8).focus(3000);
//     petzval17::Camera camera(lens, film);
//     if (!camera) return fail(camera.message());
//     petzval_ray ray = camera.sample(sample);
//
// A failed call sets status() and message() of its object, and the object takes no further calls: check after a chain
// of calls. With exceptions, define PETZVAL17_THROWS before the include to throw petzval17::Error instead.
#include <string>
#include <utility>
#include <vector>

#include "petzval/petzval.h"
#ifdef PETZVAL17_THROWS
#include <stdexcept>
#endif

namespace petzval17 {

#ifdef PETZVAL17_THROWS
struct Error : std::runtime_error {
  Error(petzval_status code, const char* message) : std::runtime_error(message), status(code) {}
  petzval_status status;
};
#endif

/// A handle with its first failure. Movable; copies are made by copy().
template <class Handle, void (*release)(Handle*)>
class Owner {
 public:
  Owner() = default;
  Owner(Owner&& other) noexcept { swap(other); }
  Owner& operator=(Owner&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Owner() { release(handle_); }

  explicit operator bool() const noexcept { return handle_ && status_ == PETZVAL_OK; }
  petzval_status status() const noexcept { return status_; }
  const std::string& message() const noexcept { return message_; }
  Handle* get() const noexcept { return handle_; }

 protected:
  /// Keeps the first failure.
  bool keep(petzval_status status) const {
    if (status == PETZVAL_OK) return true;
#ifdef PETZVAL17_THROWS
    throw Error(status, petzval_message());
#else
    if (status_ == PETZVAL_OK) status_ = status, message_ = petzval_message();
    return false;
#endif
  }
  bool good() const noexcept { return status_ == PETZVAL_OK; }
  void swap(Owner& other) noexcept {
    std::swap(handle_, other.handle_);
    std::swap(status_, other.status_);
    message_.swap(other.message_);
  }

  Handle* handle_ = nullptr;
  mutable petzval_status status_ = PETZVAL_OK;
  mutable std::string message_;
};

class Glasses : public Owner<petzval_glasses, petzval_glasses_free> {
 public:
  /// Reads the installed glasses, and the glasses of a file unless it is null.
  explicit Glasses(const char* file = nullptr) { keep(petzval_glasses_create(file, nullptr, &handle_)); }
  std::size_t count() const noexcept { return petzval_glasses_count(handle_); }
  petzval_glass get_glass(std::size_t index) const {
    petzval_glass glass = petzval_glass_init();
    keep(petzval_glasses_get(handle_, index, &glass));
    return glass;
  }
};

class Lens : public Owner<petzval_lens, petzval_lens_free> {
 public:
  static Lens read(const std::string& file, const petzval_lens_options& options = petzval_lens_options_init()) {
    Lens lens;
    lens.keep(petzval_lens_read(file.c_str(), &options, &lens.handle_));
    return lens;
  }
  static Lens parse(const std::string& text, const petzval_lens_options& options = petzval_lens_options_init()) {
    Lens lens;
    lens.keep(petzval_lens_parse(text.data(), text.size(), nullptr, &options, &lens.handle_));
    return lens;
  }
  Lens copy() const {
    Lens lens;
    lens.keep(petzval_lens_copy(handle_, &lens.handle_));
    return lens;
  }
  Lens& f_number(double value) {
    if (good()) keep(petzval_lens_set_f_number(handle_, value));
    return *this;
  }
  Lens& iris(int blades, double roundness = 0, double rotation = 0) {
    if (good()) keep(petzval_lens_set_iris(handle_, blades, roundness, rotation));
    return *this;
  }
  Lens& focus(double distance_mm, int origin = PETZVAL_FROM_FRONT_VERTEX) {
    if (good()) keep(petzval_lens_set_focus(handle_, distance_mm, origin));
    return *this;
  }
  petzval_lens_info info() const {
    petzval_lens_info info = petzval_lens_info_init();
    keep(petzval_lens_get_info(handle_, &info));
    return info;
  }
  std::string text(int kind, std::size_t index = 0) const {
    std::size_t length = 0;
    if (!keep(petzval_lens_get_text(handle_, kind, index, nullptr, 0, &length)) || length == 0) return "";
    std::vector<char> bytes(length);
    if (!keep(petzval_lens_get_text(handle_, kind, index, bytes.data(), length, nullptr))) return "";
    return bytes.data();
  }
  petzval_film_fit fit_film(const std::vector<petzval_focus_point>& points, double max_tilt, petzval_film& film) const {
    petzval_film_fit fit = petzval_film_fit_init();
    keep(petzval_lens_fit_film(handle_, points.data(), points.size(), max_tilt, &film, &fit));
    return fit;
  }
  petzval_choice choose_model(const petzval_film& film, const petzval_requirements& requirements) const {
    petzval_choice choice = petzval_choice_init();
    keep(petzval_lens_choose_model(handle_, &film, &requirements, &choice));
    return choice;
  }
};

class Camera : public Owner<petzval_camera, petzval_camera_free> {
 public:
  Camera() = default;
  explicit Camera(const Lens& lens, const petzval_film& film = petzval_film_init(),
                  const petzval_camera_options& options = petzval_camera_options_init()) {
    status_ = lens.status(), message_ = lens.message();
    if (good()) keep(petzval_camera_create(lens.get(), &film, &options, &handle_));
  }
  static Camera read(const std::string& setup) {
    Camera camera;
    camera.keep(petzval_camera_read(setup.data(), setup.size(), &camera.handle_));
    return camera;
  }
  std::string write() const {
    std::size_t length = 0;
    keep(petzval_camera_write(handle_, nullptr, 0, &length));
    std::string setup(length, ' ');
    if (length > 0) keep(petzval_camera_write(handle_, &setup[0], length, nullptr));
    return setup;
  }
  petzval_camera_info info() const {
    petzval_camera_info info = petzval_camera_info_init();
    keep(petzval_camera_get_info(handle_, &info));
    return info;
  }
  /// False, with petzval_message(), if the distances are refused; the camera keeps its focus.
  bool set_focus(double opens_mm, double closes_mm) noexcept {
    return petzval_camera_set_focus(handle_, opens_mm, closes_mm) == PETZVAL_OK;
  }

  // Calls of render threads: they neither allocate nor store a failure; the results of a failed call are 0 or a lost
  // ray.
  petzval_ray sample(const petzval_sample& sample) const noexcept {
    petzval_ray ray;
    petzval_camera_sample(handle_, &sample, &ray);  // a failed call sets a lost ray
    return ray;
  }
  petzval_ray_differential sample_differential(const petzval_sample& sample) const noexcept {
    petzval_ray_differential ray;
    petzval_camera_sample_differential(handle_, &sample, &ray);
    return ray;
  }
  petzval_importance importance(const double* origin, const double* direction, float nm = 0,
                                double time = 0) const noexcept {
    petzval_importance found;
    if (petzval_camera_importance(handle_, 1, origin, direction, nm > 0 ? &nm : nullptr, &time, &found) != PETZVAL_OK) {
      found = petzval_importance();
    }
    return found;
  }
  petzval_connection connect(const double* point, double u, double v, float nm = 0, double time = 0) const noexcept {
    petzval_connection found;
    if (petzval_camera_connect(handle_, 1, point, &u, &v, nm > 0 ? &nm : nullptr, &time, &found) != PETZVAL_OK) {
      found = petzval_connection();
    }
    return found;
  }
  double connection_pdf(const double* point, const double* direction, double nm = 0) const noexcept {
    double pdf;
    return petzval_camera_connection_pdf(handle_, point, direction, nm, 0, &pdf) == PETZVAL_OK ? pdf : 0;
  }
};

}  // namespace petzval17
