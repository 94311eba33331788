// SPDX-License-Identifier: Apache-2.0
// Cameras of the C interface.
#include "petzval/camera/camera.hpp"

#include <array>
#include <limits>
#include <span>

#include "handles.hpp"
#include "petzval/analysis/psf.hpp"
#include "petzval/ghosts/ghosts.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/aim.hpp"

namespace petzval::c_detail {
namespace {

HostFrame frame_of(const HostOptions& host, const Lens& lens) {
  constexpr std::array hosts{Host::arnold, Host::pbrt, Host::mitsuba, Host::arnold};
  const bool of_lens = host.frame == PETZVAL_FRAME_LENS;
  if (of_lens && host.origin != DistanceOrigin::front_vertex) {
    bad_argument("origin is not PETZVAL_FROM_FRONT_VERTEX; must be, in the frame of the lens");
  }
  const Host kind = hosts[static_cast<std::size_t>(host.frame)];
  if (host.units_per_mm != 0) return {kind, lens, host.origin, host.units_per_mm};
  return of_lens ? HostFrame(kind, lens, host.origin, 1) : HostFrame(kind, lens, host.origin);
}

HostOptions host_options(const petzval_camera_options& options) {
  if (options.frame < 0 || options.frame > PETZVAL_FRAME_ARNOLD) {
    bad_argument("frame = " + std::to_string(options.frame) + "; must be PETZVAL_FRAME_...");
  }
  return {.frame = options.frame,
          .origin = distance_origin(options.origin, "origin"),
          .near_far_origin = distance_origin(options.near_far_origin, "near_far_origin"),
          .units_per_mm = options.units_per_mm,
          .near_mm = options.near_mm,
          .far_mm = options.far_mm};
}

CameraOptions camera_options(const petzval_camera_options& own) {
  const std::string name = own.model ? own.model : "exact_float";
  const auto model = model_named(name);
  if (!model) bad_argument("model = \"" + name + "\"; must be a name such as exact_float, thin or polynomial_7");
  if (own.normalisation < 0 || own.normalisation > PETZVAL_UNITY_AT_EACH_WAVELENGTH) {
    bad_argument("normalisation = " + std::to_string(own.normalisation) + "; must be PETZVAL_IRRADIANCE, ...");
  }
  CameraOptions options{.model = *model,
                        .normalisation = static_cast<Normalisation>(own.normalisation),
                        .threads = own.threads == 0 ? 1 : own.threads,
                        .clamp_wavelengths = flag(own.clamp_wavelengths, "clamp_wavelengths"),
                        .importance_tables = flag(own.importance_tables, "importance_tables")};
  options.bokeh.lens_ratio = own.lens_ratio == 0 ? 1 : own.lens_ratio;
  options.bokeh.rate_of_change = own.rate_of_change;
  options.bokeh.keep_light = flag(own.keep_light, "keep_light");
  options.bokeh.weight_distribution = own.weight_distribution;
  options.bokeh.weight_strength = own.weight_strength;
  return options;
}

/// The set-up with a travel of the film from the far to the near end of the range of focus.
CameraSetup with_range(CameraSetup setup, const HostOptions& host, const Lens& lens) {
  if (!host.has_range()) return setup;
  Film& film = setup.film;
  const FocusOptions from{.origin = host.near_far_origin};
  if (!lens.focus_positions().empty()) {
    throw Error(lens.name() + ": near_mm and far_mm; must be 0 for a lens that focuses by moving groups");
  }
  if (film.z_mm) throw Error(lens.name() + ": has_z = 1; must be 0 for a range of focus, which sets the film");
  if (!(host.near_mm > 0 && host.far_mm > host.near_mm)) {
    bad_argument("far_mm must be above near_mm, and near_mm above 0");
  }
  film.z_mm = with_focus(lens, host.far_mm, from).film_z();
  film.travel_mm = with_focus(lens, host.near_mm, from).film_z() - *film.z_mm;
  return setup;
}

Wavelength wavelength_of(double nm) { return nm == 0 ? Wavelength() : Wavelength::nm(nm); }
Vec3<double> vector_of(const double* v) { return {v[0], v[1], v[2]}; }
void put(const Vec3<double>& v, double* to) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

CameraSample sample_of(const CameraContents& own, const petzval_sample& sample) {
  return {.film = own.camera.film().point(sample.raster_x, sample.raster_y),
          .pupil_u = sample.pupil_u,
          .pupil_v = sample.pupil_v,
          .wavelength = wavelength_of(sample.wavelength_nm),
          .time = own.film_time(sample.time)};
}
void put(const CameraContents& own, const CameraRay& ray, petzval_ray& to) {
  put(own.frame.point_to_host(ray.ray.origin), to.origin);
  put(own.frame.direction_to_host(ray.ray.direction), to.direction);
  to.weight = ray.weight;
  to.pdf_film = ray.pdf_film, to.pdf_pupil = ray.pdf_pupil, to.pdf_direction = ray.pdf_direction;
  to.fate = static_cast<std::int32_t>(ray.fate), to.unused = 0;
}
petzval_importance importance_of(const CameraContents& own, const Importance& found) {
  return {.raster_x = found.raster.x,
          .raster_y = found.raster.y,
          .we = found.we * own.area,
          .pdf_position = found.pdf_position * own.area,
          .pdf_direction = found.pdf_direction,
          .fate = static_cast<std::int32_t>(found.fate),
          .unused = 0};
}
petzval_connection connection_of(const CameraContents& own, const ImportanceSample& found, double pdf_unit) {
  petzval_connection result{};
  put(own.frame.direction_to_host(found.direction), result.direction);
  put(own.frame.point_to_host(found.on_front), result.on_front);
  result.distance = found.distance * own.frame.units_per_mm();
  result.pdf = found.pdf * pdf_unit;
  result.importance = importance_of(own, found.importance);
  return result;
}

constexpr std::size_t block = 256;
template <class T>
using Block = std::array<T, block>;
template <class T>
T* from(T* array, std::size_t begin) {
  return array ? array + begin : nullptr;
}

/// Samples and rays as the arrays of petzval_samples_float or petzval_samples_double.
template <class T, class Samples, class Rays>
petzval_status sample_arrays(const petzval_camera* camera, std::size_t count, const Samples* samples,
                             const Rays* rays) {
  const auto clear = [&] {
    if (!rays) return;
    for (T* const array : {rays->x, rays->y, rays->z, rays->dx, rays->dy, rays->dz, rays->weights, rays->pdf_pupil,
                           rays->pdf_direction}) {
      reset(array, count);
    }
    reset(rays->fates, count, std::uint8_t{PETZVAL_FATE_INVALID});
  };
  return guarded(clear, [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    if (count == 0) return;
    const Samples& in = given(samples, "samples");
    const Rays& out = given(rays, "rays");
    for (const auto& [array, name] : {std::pair{in.raster_x, "raster_x"},
                                      {in.raster_y, "raster_y"},
                                      {in.pupil_u, "pupil_u"},
                                      {in.pupil_v, "pupil_v"}}) {
      given(array, name);
    }
    for (const auto& [array, name] : {std::pair{out.x, "x"},
                                      {out.y, "y"},
                                      {out.z, "z"},
                                      {out.dx, "dx"},
                                      {out.dy, "dy"},
                                      {out.dz, "dz"},
                                      {out.weights, "weights"}}) {
      given(array, name);
    }
    Block<T> x, y, time;
    Block<RayFate> fate;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      own.camera.film().points(n, in.raster_x + begin, in.raster_y + begin, x.data(), y.data());
      for (std::size_t i = 0; i < n; ++i) {
        time[i] = static_cast<T>(own.film_time(in.times ? double{in.times[begin + i]} : 0));
      }
      const CameraRays<T> to{
          {out.x + begin, out.y + begin, out.z + begin, out.dx + begin, out.dy + begin, out.dz + begin},
          out.weights + begin,
          fate.data(),
          from(out.pdf_pupil, begin),
          from(out.pdf_direction, begin)};
      own.camera.sample<T>(n,
                           {x.data(),
                            y.data(),
                            in.pupil_u + begin,
                            in.pupil_v + begin,
                            {.each_nm = from(in.wavelengths_nm, begin)},
                            time.data()},
                           to);
      for (std::size_t i = 0; i < n; ++i) {
        if (out.fates) out.fates[begin + i] = static_cast<std::uint8_t>(fate[i]);
        const Ray<double> ray = own.frame.to_host(
            {{to.rays.x[i], to.rays.y[i], to.rays.z[i]}, {to.rays.dx[i], to.rays.dy[i], to.rays.dz[i]}});
        to.rays.x[i] = static_cast<T>(ray.origin.x), to.rays.dx[i] = static_cast<T>(ray.direction.x);
        to.rays.y[i] = static_cast<T>(ray.origin.y), to.rays.dy[i] = static_cast<T>(ray.direction.y);
        to.rays.z[i] = static_cast<T>(ray.origin.z), to.rays.dz[i] = static_cast<T>(ray.direction.z);
      }
    }
  });
}

/// Fractions of the travel of the film for a block of times.
const double* film_times(const CameraContents& own, const double* times, std::size_t begin, std::size_t n,
                         Block<double>& to) {
  for (std::size_t i = 0; i < n; ++i) to[i] = own.film_time(times ? times[begin + i] : 0);
  return to.data();
}

FieldPoint field_of(const CameraContents& own, const Vec3<double>& point, bool distant) {
  const Vec3<double> at = distant ? own.frame.direction_to_lens(point) : own.frame.point_to_lens(point);
  const double pupil_z = distant ? 0 : pupils(own.camera.lens()).entrance.z;
  return {.field_rad = std::atan2(std::hypot(at.x, at.y), pupil_z - at.z),
          .z = distant ? -std::numeric_limits<double>::infinity() : at.z,
          .azimuth_rad = std::atan2(at.x, at.y)};
}

}  // namespace

CameraContents::CameraContents(CameraSetup given, const HostOptions& options,
                               std::shared_ptr<const GlassCatalogue> of_lens, const Lens& lens)
    : setup(std::move(given)),
      host(options),
      glasses(std::move(of_lens)),
      camera(petzval::camera(with_range(setup, host, lens), lens)),
      frame(frame_of(host, camera.lens())) {
  area = 1 / (frame.units_per_mm() * frame.units_per_mm());
  if (!host.has_range()) return;
  if (host.opens_mm != 0) {
    set_focus(host.opens_mm, host.closes_mm);
    return;
  }
  opens = closes = std::clamp((lens.film_z() - camera.film().z()) / camera.film().travel_mm, 0.0, 1.0);
}

void CameraContents::set_focus(double opens_mm, double closes_mm) {
  if (!host.has_range()) bad_argument("near_mm and far_mm are 0, so that the focus is fixed; must be a range");
  const FocusOptions from{.origin = host.near_far_origin};
  const auto fraction = [&](double distance) {
    if (!(distance >= host.near_mm * (1 - 1e-9) && distance <= host.far_mm * (1 + 1e-9))) {
      throw Error("focus distance = " + std::to_string(distance) + "; must be from near_mm to far_mm");
    }
    const double z = with_focus(camera.lens(), distance, from).film_z();
    return std::clamp((z - camera.film().z()) / camera.film().travel_mm, 0.0, 1.0);
  };
  const double open = fraction(opens_mm), close = opens_mm == closes_mm ? open : fraction(closes_mm);
  opens = open, closes = close;
  host.opens_mm = opens_mm, host.closes_mm = closes_mm;
}

}  // namespace petzval::c_detail

using namespace petzval;
using namespace petzval::c_detail;

petzval_status petzval_camera_create(const petzval_lens* lens, const petzval_film* film,
                                     const petzval_camera_options* options, petzval_camera** camera) {
  return guarded(results(camera), [&] {
    given(camera, "camera");
    const LensContents& own = *live(lens, "lens").contents;
    const auto options_in = received(options, "petzval_camera_options");
    CameraSetup setup = own.setup;
    setup.film = film_of(film), setup.camera = camera_options(options_in);
    give(std::make_shared<CameraContents>(std::move(setup), host_options(options_in), own.glasses, own.lens), camera);
  });
}

void petzval_camera_free(petzval_camera* camera) { release(camera); }

petzval_status petzval_camera_get_info(const petzval_camera* camera, petzval_camera_info* info) {
  return guarded(results(info), [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    const Film film = own.camera.film().at(own.opens);
    petzval_camera_info found{};
    found.size = sizeof found;
    copy_text(name(own.camera.model()), found.model);
    found.film_width_mm = film.width_mm, found.film_height_mm = film.height_mm;
    found.film_z_mm = film.z(), found.film_area_mm2 = film.area_mm2();
    found.columns = film.columns, found.rows = film.rows;
    found.units_per_mm = own.frame.units_per_mm();
    const auto [shortest, longest] = std::ranges::minmax(own.camera.lens().wavelengths_nm());
    found.shortest_nm = shortest, found.longest_nm = longest;
    found.wavelength_count = static_cast<std::int64_t>(own.camera.lens().wavelengths_nm().size());
    send(found, info, "petzval_camera_info");
  });
}

petzval_status petzval_camera_set_focus(petzval_camera* camera, double opens_mm, double closes_mm) {
  return guarded([&] { live(camera, "camera").contents->set_focus(opens_mm, closes_mm); });
}

petzval_status petzval_camera_write(const petzval_camera* camera, char* bytes, std::size_t capacity,
                                    std::size_t* length) {
  return guarded(results(bytes, capacity), [&] {
    if (length) *length = 0;
    copy_bytes(write_camera(*live(camera, "camera").contents), bytes, capacity, length);
  });
}

petzval_status petzval_camera_read(const char* bytes, std::size_t count, petzval_camera** camera) {
  return guarded(results(camera), [&] {
    given(camera, "camera");
    give(read_camera({&given(bytes, "bytes"), count}), camera);
  });
}

petzval_status petzval_camera_sample(const petzval_camera* camera, const petzval_sample* sample, petzval_ray* ray) {
  return guarded(results(ray), [&] {
    given(ray, "ray");
    const CameraContents& own = *live(camera, "camera").contents;
    put(own, own.camera.sample(sample_of(own, given(sample, "sample"))), *ray);
  });
}

petzval_status petzval_camera_sample_differential(const petzval_camera* camera, const petzval_sample* sample,
                                                  petzval_ray_differential* ray) {
  return guarded(results(ray), [&] {
    given(ray, "ray");
    const CameraContents& own = *live(camera, "camera").contents;
    const CameraRayDifferential found = own.camera.sample_differential(sample_of(own, given(sample, "sample")));
    put(own, found.sample, ray->ray);
    const auto [by_x, by_y] = by_raster(found, own.camera.film());
    const double units = own.frame.units_per_mm();
    put(own.frame.direction_to_host(by_x.origin) * units, ray->origin_by_x);
    put(own.frame.direction_to_host(by_x.direction), ray->direction_by_x);
    put(own.frame.direction_to_host(by_y.origin) * units, ray->origin_by_y);
    put(own.frame.direction_to_host(by_y.direction), ray->direction_by_y);
  });
}

petzval_status petzval_camera_sample_float(const petzval_camera* camera, std::size_t count,
                                           const petzval_samples_float* samples, const petzval_rays_float* rays) {
  return sample_arrays<float>(camera, count, samples, rays);
}
petzval_status petzval_camera_sample_double(const petzval_camera* camera, std::size_t count,
                                            const petzval_samples_double* samples, const petzval_rays_double* rays) {
  return sample_arrays<double>(camera, count, samples, rays);
}

petzval_status petzval_camera_sample_path(const petzval_camera* camera, const petzval_sample* sample, std::size_t count,
                                          const double* nm, petzval_ray* ray, petzval_path_wavelength* found) {
  const auto clear = [&] { reset(ray), reset(found, count); };
  return guarded(clear, [&] {
    given(ray, "ray");
    const CameraContents& own = *live(camera, "camera").contents;
    if (count == 0) bad_argument("count = 0; must be at least 1");
    given(nm, "nm"), given(found, "found");
    std::array<PathWavelength, 64> results;
    if (count > results.size()) bad_argument("count = " + std::to_string(count) + "; must be at most 64");
    const CameraRay hero = own.camera.sample_path(sample_of(own, given(sample, "sample")), {nm, count}, results.data());
    put(own, hero, *ray);
    for (std::size_t i = 0; i < count; ++i) {
      const PathWavelength& one = results[i];
      found[i] = {
          one.raster.x, one.raster.y, one.weight, one.density * own.area, static_cast<std::int32_t>(one.fate), 0};
    }
  });
}

petzval_status petzval_camera_importance(const petzval_camera* camera, std::size_t count, const double* origins,
                                         const double* directions, const float* nm, const double* times,
                                         petzval_importance* found) {
  return guarded(results(found, count), [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    if (count == 0) return;
    given(origins, "origins"), given(directions, "directions"), given(found, "found");
    const auto lens_ray = [&](std::size_t i) {
      return Ray<double>{own.frame.point_to_lens(vector_of(origins + 3 * i)),
                         own.frame.direction_to_lens(vector_of(directions + 3 * i))};
    };
    if (count == 1) {  // a single call is faster than a batch with one ray
      *found = importance_of(own, own.camera.importance(lens_ray(0), wavelength_of(nm ? double{*nm} : 0),
                                                        own.film_time(times ? *times : 0)));
      return;
    }
    std::array<Block<double>, 6> rays;
    Block<double> time;
    Block<Importance> results;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      for (std::size_t i = 0; i < n; ++i) {
        const auto [o, d] = lens_ray(begin + i);
        rays[0][i] = o.x, rays[1][i] = o.y, rays[2][i] = o.z, rays[3][i] = d.x, rays[4][i] = d.y, rays[5][i] = d.z;
      }
      own.camera.importance(
          n, {rays[0].data(), rays[1].data(), rays[2].data(), rays[3].data(), rays[4].data(), rays[5].data()},
          {.each_nm = from(nm, begin)}, results.data(), film_times(own, times, begin, n, time));
      for (std::size_t i = 0; i < n; ++i) found[begin + i] = importance_of(own, results[i]);
    }
  });
}

petzval_status petzval_camera_connect(const petzval_camera* camera, std::size_t count, const double* points,
                                      const double* u, const double* v, const float* nm, const double* times,
                                      petzval_connection* found) {
  return guarded(results(found, count), [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    if (count == 0) return;
    given(points, "points"), given(u, "u"), given(v, "v"), given(found, "found");
    if (count == 1) {
      *found = connection_of(
          own,
          own.camera.sample_importance(own.frame.point_to_lens(vector_of(points)), *u, *v,
                                       wavelength_of(nm ? double{*nm} : 0), own.film_time(times ? *times : 0)),
          1);
      return;
    }
    Block<Vec3<double>> lens_points;
    Block<double> time;
    Block<ImportanceSample> results;
    for (std::size_t begin = 0; begin < count; begin += block) {
      const std::size_t n = std::min(block, count - begin);
      for (std::size_t i = 0; i < n; ++i) lens_points[i] = own.frame.point_to_lens(vector_of(points + 3 * (begin + i)));
      own.camera.sample_importance(n, lens_points.data(), u + begin, v + begin, {.each_nm = from(nm, begin)},
                                   results.data(), film_times(own, times, begin, n, time));
      for (std::size_t i = 0; i < n; ++i) found[begin + i] = connection_of(own, results[i], 1);
    }
  });
}

petzval_status petzval_camera_connect_distant(const petzval_camera* camera, const double* direction, double u, double v,
                                              double nm, double time, petzval_connection* found) {
  return guarded(results(found), [&] {
    given(found, "found");
    const CameraContents& own = *live(camera, "camera").contents;
    const auto lens_direction = own.frame.direction_to_lens(vector_of(&given(direction, "direction")));
    *found = connection_of(
        own, own.camera.sample_distant_importance(lens_direction, u, v, wavelength_of(nm), own.film_time(time)),
        own.area);
  });
}

petzval_status petzval_camera_connection_pdf(const petzval_camera* camera, const double* point, const double* direction,
                                             double nm, std::int32_t distant, double* pdf) {
  return guarded(results(pdf), [&] {
    given(pdf, "pdf");
    const CameraContents& own = *live(camera, "camera").contents;
    const auto at = own.frame.point_to_lens(vector_of(&given(point, "point")));
    const auto towards = own.frame.direction_to_lens(vector_of(&given(direction, "direction")));
    *pdf = flag(distant, "distant") ? own.camera.pdf_distant_importance({at, towards}, wavelength_of(nm)) * own.area
                                    : own.camera.pdf_importance(at, towards, wavelength_of(nm));
  });
}

petzval_status petzval_camera_project(const petzval_camera* camera, std::size_t count, const double* points, double nm,
                                      double time, double* raster, std::uint8_t* visible) {
  const auto clear = [&] { reset(raster, 2 * count), reset(visible, count); };
  return guarded(clear, [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    if (count == 0) return;
    given(points, "points"), given(raster, "raster");
    for (std::size_t i = 0; i < count; ++i) {
      const Projection found = own.camera.project(own.frame.point_to_lens(vector_of(points + 3 * i)), wavelength_of(nm),
                                                  own.film_time(time));
      const bool none = found.status == AimStatus::no_ray;
      raster[2 * i] = none ? std::numeric_limits<double>::quiet_NaN() : found.raster.x;
      raster[2 * i + 1] = none ? std::numeric_limits<double>::quiet_NaN() : found.raster.y;
      if (visible) visible[i] = found ? 1 : 0;
    }
  });
}

petzval_status petzval_camera_point_image(const petzval_camera* camera, const double* point,
                                          const petzval_psf_options* options, petzval_psf* psf, float* image,
                                          std::size_t floats) {
  const auto clear = [&] { reset(psf), reset(image, floats); };
  return guarded(clear, [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    if (own.host.has_range()) {
      bad_argument("a camera with near_mm and far_mm has no image of a point; make one for a fixed focus");
    }
    const auto in = received(options, "petzval_psf_options");
    PsfOptions how{.samples = in.samples == 0 ? 1u << 18 : in.samples,
                   .pixels = in.pixels == 0 ? 64 : in.pixels,
                   .half_width_mm = in.half_width_mm,
                   .seed = in.seed,
                   .threads = in.threads == 0 ? 1 : in.threads};
    if (flag(in.has_centre, "has_centre")) how.centre = {in.centre_mm[0], in.centre_mm[1]};
    const Vec3<double> at = vector_of(&given(point, "point"));
    const bool distant = flag(in.distant, "distant");
    if (distant && at == Vec3<double>{0, 0, 0}) bad_argument("point = (0, 0, 0); must be a direction if distant = 1");
    const Psf found = point_image(own.camera, field_of(own, at, distant), how);
    petzval_psf out{};
    out.size = sizeof out;
    out.pixel_mm = found.pixel_mm;
    out.centre_mm[0] = found.centre.x, out.centre_mm[1] = found.centre.y;
    out.centroid_mm[0] = found.size.centroid.x, out.centroid_mm[1] = found.size.centroid.y;
    out.rms_radius_mm = found.size.rms_radius, out.max_radius_mm = found.size.max_radius;
    out.throughput = found.mean_throughput, out.error = found.error;
    out.pixels = found.pixels, out.wavelengths = static_cast<std::int32_t>(found.wavelengths_nm.size());
    if (psf) send(out, psf, "petzval_psf");
    if (!image) return;
    const auto& counts = found.counts;
    if (floats < counts.size()) {
      throw Failure{PETZVAL_TOO_SMALL,
                    "floats = " + std::to_string(floats) + "; must be at least " + std::to_string(counts.size())};
    }
    const std::size_t plane = counts.size() / found.wavelengths_nm.size();
    for (std::size_t i = 0; i < counts.size(); ++i) {
      image[i] = static_cast<float>(static_cast<double>(counts[i]) * found.ray_weight(i / plane));
    }
  });
}

petzval_status petzval_ghosts(const petzval_camera* camera, const double* point, const petzval_ghosts_options* options,
                              petzval_ghost* pairs, std::size_t capacity, std::size_t* count, float* picture,
                              std::size_t floats) {
  const auto clear = [&] { reset(pairs, capacity), reset(count), reset(picture, floats); };
  return guarded(clear, [&] {
    const CameraContents& own = *live(camera, "camera").contents;
    const auto in = received(options, "petzval_ghosts_options");
    const Lens& lens = own.camera.lens();
    const Film& film = own.camera.film();
    GhostOptions how{.film_reflectance = in.film_reflectance, .threads = in.threads == 0 ? 1 : in.threads};
    if (in.tolerance != 0) how.tolerance = in.tolerance;
    if (in.most_pairs < 0) bad_argument("most_pairs = " + std::to_string(in.most_pairs) + "; must be at least 0");
    if (in.most_pairs > 0) how.max_pairs = static_cast<std::size_t>(in.most_pairs);
    const Vec3<double> at = vector_of(&given(point, "point"));
    const bool distant = flag(in.distant, "distant");
    const ScenePoint light{distant ? own.frame.direction_to_lens(at) : own.frame.point_to_lens(at), distant};
    const std::size_t wanted = picture ? lens.wavelengths_nm().size() * static_cast<std::size_t>(film.columns) *
                                             static_cast<std::size_t>(film.rows)
                                       : 0;
    if (floats < wanted) {
      throw Failure{PETZVAL_TOO_SMALL,
                    "floats = " + std::to_string(floats) + "; must be at least " + std::to_string(wanted)};
    }
    if (pairs || count) {
      const Ghosts found = ghost_pairs(lens, light, how);
      for (std::size_t i = 0; pairs && i < std::min(capacity, found.pairs.size()); ++i) {
        const GhostPair& pair = found.pairs[i];
        pairs[i] = {static_cast<std::int32_t>(pair.first),
                    static_cast<std::int32_t>(pair.second),
                    pair.energy,
                    pair.error,
                    {pair.centre.x, pair.centre.y},
                    pair.rms_radius_mm,
                    pair.peak_per_mm2,
                    pair.caustic,
                    0};
      }
      if (count) *count = found.pairs.size();
    }
    if (!picture) return;
    std::vector<Wavelength> wavelengths;
    for (std::size_t w = 0; w < lens.wavelengths_nm().size(); ++w) wavelengths.emplace_back(w);
    std::fill_n(picture, wanted, 0.0f);
    add_ghosts(lens, light, film, wavelengths, {picture, wanted}, how);
  });
}
