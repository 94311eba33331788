// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "petzval/camera/camera.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/film.hpp"
#include "petzval/focus/focus.hpp"
#include "petzval/glass/glass.hpp"
#include "petzval/io/json.hpp"
#include "petzval/lens/lens.hpp"
#include "petzval/petzval.h"

namespace petzval::c_detail {

/// Status and message of a failed call.
struct Failure {
  petzval_status status;
  std::string message;
};

/// Stores a message for petzval_message() on this thread.
void set_message(std::string_view message) noexcept;

/// True for sizes that a version of the struct T may have: multiples of its alignment, as other sizes would end within
/// a member.
template <class T>
constexpr bool is_size_of(std::size_t size) noexcept {
  return size >= sizeof(std::size_t) && size <= 1 << 16 && size % alignof(T) == 0;
}
/// Sets results to 0 or NULL, and their fates to PETZVAL_FATE_INVALID. The member `size` stays.
template <class T>
void reset(T* to, std::size_t count = 1, T value = {}) noexcept {
  if (!to) return;
  if constexpr (requires { to->size; }) {
    if (!is_size_of<T>(to->size)) return;
    std::memset(reinterpret_cast<char*>(to) + sizeof to->size, 0, std::min(to->size, sizeof(T)) - sizeof to->size);
  } else {
    if constexpr (requires { value.fate; }) value.fate = PETZVAL_FATE_INVALID;
    if constexpr (requires { value.ray.fate; }) value.ray.fate = PETZVAL_FATE_INVALID;
    if constexpr (requires { value.importance.fate; }) value.importance.fate = PETZVAL_FATE_INVALID;
    std::fill_n(to, count, value);
  }
}
/// The results of a call, for guarded().
template <class T>
auto results(T* to, std::size_t count = 1) noexcept {
  return [=]() noexcept { reset(to, count); };
}

/// Runs the body of a function of the C interface: exceptions become a status and a message. `clear` resets the results
/// of a failed call.
template <class Clear, class Body>
petzval_status guarded(const Clear& clear, const Body& body) noexcept {
  petzval_status status = PETZVAL_REFUSED;
  try {
    body();
    return PETZVAL_OK;
  } catch (const Failure& failure) {
    set_message(failure.message);
    status = failure.status;
  } catch (const std::bad_alloc&) {
    set_message("out of memory");
    status = PETZVAL_OUT_OF_MEMORY;
  } catch (const std::exception& error) {
    set_message(error.what());
  } catch (...) {
    set_message("unknown failure");
  }
  clear();
  return status;
}
template <class Body>
petzval_status guarded(const Body& body) noexcept {
  return guarded([] {}, body);
}

[[noreturn]] inline void bad_argument(std::string message) { throw Failure{PETZVAL_BAD_ARGUMENT, std::move(message)}; }
template <class T>
T& given(T* pointer, const char* name) {
  if (!pointer) bad_argument(std::string(name) + " = NULL; must point to a value");
  return *pointer;
}
inline bool flag(std::int32_t value, const char* name) {
  if (value != 0 && value != 1) bad_argument(std::string(name) + " = " + std::to_string(value) + "; must be 0 or 1");
  return value == 1;
}

/// Copies a struct of the caller whose version may be older or newer. NULL: all members 0.
template <class T>
T received(const T* from, const char* name) {
  T copy{};
  copy.size = sizeof(T);
  if (!from) return copy;
  if (!is_size_of<T>(from->size)) {
    bad_argument(std::string(name) + ": size = " + std::to_string(from->size) + "; must be sizeof(" + name +
                 "), as set by " + name + "_init()");
  }
  const auto* const bytes = reinterpret_cast<const unsigned char*>(from);
  for (std::size_t i = sizeof(T); i < from->size; ++i) {
    if (bytes[i] != 0) {
      bad_argument(std::string(name) + ": size = " + std::to_string(from->size) + " and a member beyond byte " +
                   std::to_string(sizeof(T)) + " is set; must be 0 for this version of the library");
    }
  }
  std::memcpy(&copy, from, std::min(from->size, sizeof(T)));
  copy.size = sizeof(T);
  return copy;
}
/// Writes a struct to the caller. The caller may have an older or newer version of the struct.
template <class T>
void send(const T& value, T* to, const char* name) {
  const std::size_t size = given(to, name).size;
  received(to, name);  // checks the size
  auto* const bytes = reinterpret_cast<unsigned char*>(to);
  std::memcpy(bytes + sizeof size, reinterpret_cast<const unsigned char*>(&value) + sizeof size,
              std::min(size, sizeof(T)) - sizeof size);
}
template <std::size_t n>
void copy_text(std::string_view text, char (&to)[n]) noexcept {
  const std::size_t count = std::min(text.size(), n - 1);
  std::memcpy(to, text.data(), count);
  to[count] = 0;
}
/// Copies bytes to a buffer of the caller.
void copy_bytes(std::string_view bytes, char* to, std::size_t capacity, std::size_t* length);

/// The first member of a handle, which tells kinds of handles and freed handles apart.
enum class Kind : std::uint32_t {
  glasses = 0x9e7a61a5,
  lens = 0x9e7a11e5,
  camera = 0x9e7aca3e,
  lens_rays = 0x9e7a4a75,
  layers = 0x9e7a1a7e,
  blur = 0x9e7ab104,
  freed = 0xdead9e7a
};

/// Base of a handle. Lenses and cameras share the contents of their glasses.
template <class T, Kind k>
struct Holder {
  static constexpr Kind own_kind = k;
  Kind kind = k;
  std::shared_ptr<T> contents;
};
/// Gives the caller a new handle.
template <class Handle, class T>
void give(std::shared_ptr<T> contents, Handle** to) {
  auto handle = std::make_unique<Handle>();
  handle->contents = std::move(contents);
  *to = handle.release();
}

template <class Handle>
Handle& live(Handle* handle, const char* name) {
  if (!handle) throw Failure{PETZVAL_BAD_HANDLE, std::string(name) + " = NULL; must be a handle"};
  if (handle->kind != std::remove_const_t<Handle>::own_kind) {
    throw Failure{PETZVAL_BAD_HANDLE, std::string(name) + " is no handle of this kind; has it been freed?"};
  }
  return *handle;
}
/// Frees the contents of a handle. With assertions, the handle itself stays in memory, so that later calls detect a
/// freed handle.
template <class Handle>
void release(Handle* handle) noexcept {
  if (!handle || handle->kind != Handle::own_kind) return;
  handle->contents.reset();
  handle->kind = Kind::freed;
#ifdef NDEBUG
  delete handle;
#endif
}

DistanceOrigin distance_origin(std::int32_t value, const char* name);
Film film_of(const petzval_film* film);

struct LensContents {
  CameraSetup setup;                              ///< its lens, iris, f-number and focus
  std::shared_ptr<const GlassCatalogue> glasses;  ///< null: glass_tables()
  Lens base, lens;                                ///< without and with the settings of iris, f-number and focus
};

/// The options of a camera of the C interface beyond its CameraSetup.
struct HostOptions {
  std::int32_t frame = 0;
  DistanceOrigin origin = DistanceOrigin::front_vertex, near_far_origin = DistanceOrigin::front_vertex;
  double units_per_mm = 0, near_mm = 0, far_mm = 0;
  double opens_mm = 0, closes_mm = 0;  ///< last petzval_camera_set_focus(); 0: none

  bool has_range() const noexcept { return near_mm != 0 || far_mm != 0; }
};

struct CameraContents {
  CameraContents(CameraSetup setup, const HostOptions& host, std::shared_ptr<const GlassCatalogue> glasses,
                 const Lens& lens);
  void set_focus(double opens, double closes);
  /// Fraction of the travel of the film at a time of the exposure.
  double film_time(double time) const noexcept {
    return opens + std::clamp(time > 0 ? time : 0.0, 0.0, 1.0) * (closes - opens);
  }

  CameraSetup setup;
  HostOptions host;
  std::shared_ptr<const GlassCatalogue> glasses;  ///< of the lens
  Camera camera;
  HostFrame frame;
  double opens = 0, closes = 1;
  double area = 1;  ///< 1/mm^2 in 1/unit^2
};

/// The camera as JSON, with the glasses that its lens uses, and the camera of such a text.
std::string write_camera(const CameraContents& camera);
std::shared_ptr<CameraContents> read_camera(std::string_view bytes);

}  // namespace petzval::c_detail

struct petzval_glasses : petzval::c_detail::Holder<const petzval::GlassCatalogue, petzval::c_detail::Kind::glasses> {};
struct petzval_lens : petzval::c_detail::Holder<petzval::c_detail::LensContents, petzval::c_detail::Kind::lens> {};
struct petzval_camera : petzval::c_detail::Holder<petzval::c_detail::CameraContents, petzval::c_detail::Kind::camera> {
};
