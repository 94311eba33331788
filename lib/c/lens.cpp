// SPDX-License-Identifier: Apache-2.0
// Lenses, glasses, films and choices of models of the C interface.
#include <limits>
#include <span>

#include "camera/lens_facts.hpp"
#include "fit/film_fit.hpp"
#include "handles.hpp"
#include "petzval/analysis/choose_model.hpp"
#include "petzval/analysis/report.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/focus/autofocus.hpp"
#include "petzval/formats/lens_file.hpp"
#include "petzval/io/json.hpp"
#include "petzval/paraxial/first_order.hpp"
#include "petzval/pupil/apertures.hpp"
#include "petzval/pupil/f_number.hpp"

namespace petzval::c_detail {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

std::string& last_message() {
  thread_local std::string message;
  return message;
}

LensSource source_of(Prescription prescription, const petzval_lens_options& options) {
  LensSource source{.prescription = std::move(prescription)};
  if (options.wavelength_count > 0) {
    const double* const nm = &given(options.wavelengths_nm, "wavelengths_nm");
    if (options.wavelength_count > 65000) bad_argument("wavelength_count is above 65000");
    source.wavelengths_nm.assign(nm, nm + options.wavelength_count);
  }
  if (options.primary_nm != 0) source.primary_nm = options.primary_nm;
  source.clamp_wavelengths = flag(options.clamp_wavelengths, "clamp_wavelengths");
  source.require_glasses = flag(options.require_glasses, "require_glasses");
  if (options.configuration < 0) bad_argument("configuration is negative; must be 0, or a number from 1");
  if (options.configuration > 0) source.configuration = std::to_string(options.configuration - 1);
  return source;
}

/// @param read  reads the prescription with the ReadOptions given
template <class Read>
void open_lens(const petzval_lens_options* options, petzval_lens** lens, const Read& read) {
  given(lens, "lens");
  const auto own = received(options, "petzval_lens_options");
  std::shared_ptr<const GlassCatalogue> glasses;
  if (own.glasses) glasses = live(own.glasses, "glasses").contents;
  const ReadOptions how{
      .strict = flag(own.strict, "strict"), .glasses = glasses.get(), .entry = own.entry ? own.entry : ""};
  CameraSetup setup{.lens = source_of(read(how), own)};
  const Lens compiled = compile(setup, glasses.get());
  give(std::make_shared<LensContents>(LensContents{std::move(setup), std::move(glasses), compiled, compiled}), lens);
}

/// Changes the settings of a lens. If the change is refused, the lens keeps its settings.
template <class Change>
petzval_status change(petzval_lens* lens, const Change& change_setup) {
  return guarded([&] {
    LensContents& contents = *live(lens, "lens").contents;
    CameraSetup changed = contents.setup;
    change_setup(changed);
    contents.lens = prepared(changed, contents.base);
    contents.setup = std::move(changed);
  });
}

/// The prescription in the configuration of the lens.
Prescription own_prescription(const LensContents& contents) {
  const Prescription& all = *contents.setup.lens.prescription;
  return configured(all, configuration_of(contents.setup.lens, all).value_or(ConfigurationChoice()));
}

template <class T>
std::string at(std::span<const T> list, std::size_t index) {
  return index < list.size() ? std::string(list[index]) : "";
}

}  // namespace

void set_message(std::string_view message) noexcept {
  try {
    last_message() = message;
  } catch (...) {
    last_message().clear();
  }
}

void copy_bytes(std::string_view bytes, char* to, std::size_t capacity, std::size_t* length) {
  if (capacity > 0) given(to, "buffer");
  if (length) *length = bytes.size();
  if (capacity == 0) return;
  if (capacity < bytes.size()) {
    throw Failure{PETZVAL_TOO_SMALL, "capacity = " + std::to_string(capacity) + " bytes; must be at least " +
                                         std::to_string(bytes.size())};
  }
  std::memcpy(to, bytes.data(), bytes.size());
}

DistanceOrigin distance_origin(std::int32_t value, const char* name) {
  switch (value) {
    case PETZVAL_FROM_FRONT_VERTEX: return DistanceOrigin::front_vertex;
    case PETZVAL_FROM_FILM: return DistanceOrigin::film;
    case PETZVAL_FROM_ENTRANCE_PUPIL: return DistanceOrigin::entrance_pupil;
    default: bad_argument(std::string(name) + " = " + std::to_string(value) + "; must be PETZVAL_FROM_...");
  }
}

Film film_of(const petzval_film* film) {
  const auto own = received(film, "petzval_film");
  Film result{.width_mm = own.width_mm == 0 ? 36 : own.width_mm,
              .height_mm = own.height_mm == 0 ? 24 : own.height_mm,
              .columns = own.columns == 0 ? 1920 : own.columns,
              .rows = own.rows == 0 ? 1280 : own.rows,
              .shift_x_mm = own.shift_x_mm,
              .shift_y_mm = own.shift_y_mm,
              .margin_mm = own.margin_mm,
              .tilt_rad = own.tilt_rad,
              .swing_rad = own.swing_rad};
  if (flag(own.has_z, "has_z")) result.z_mm = own.z_mm;
  return result;
}

}  // namespace petzval::c_detail

using namespace petzval;
using namespace petzval::c_detail;

petzval_status petzval_check_version(std::int32_t version) {
  return guarded([&] {
    if (version >= 1 && version <= PETZVAL_C_VERSION) return;
    bad_argument("version = " + std::to_string(version) + "; this library has version " +
                 std::to_string(PETZVAL_C_VERSION) + " of the C interface");
  });
}

const char* petzval_message() { return last_message().c_str(); }

const char* petzval_data_directory() {
  thread_local std::string folder;
  const petzval_status status = guarded([&] { folder = data_directory().string(); });
  return status == PETZVAL_OK ? folder.c_str() : nullptr;
}

petzval_status petzval_glasses_create(const char* file, const petzval_glasses* base, petzval_glasses** glasses) {
  return guarded(results(glasses), [&] {
    given(glasses, "glasses");
    GlassCatalogue set = base ? *live(base, "base").contents : glass_tables();
    if (file) set = with_glasses(set, read_glasses(file).glasses);
    give(std::make_shared<const GlassCatalogue>(std::move(set)), glasses);
  });
}

void petzval_glasses_free(petzval_glasses* glasses) { release(glasses); }

std::size_t petzval_glasses_count(const petzval_glasses* glasses) {
  std::size_t count = 0;
  guarded([&] { count = live(glasses, "glasses").contents->glasses().size(); });
  return count;
}

petzval_status petzval_glasses_get(const petzval_glasses* glasses, std::size_t index, petzval_glass* glass) {
  return guarded(results(glass), [&] {
    const auto& list = live(glasses, "glasses").contents->glasses();
    if (index >= list.size())
      bad_argument("index = " + std::to_string(index) + "; must be below petzval_glasses_count()");
    petzval_glass found{};
    found.size = sizeof found;
    found.nd = list[index].nd, found.vd = list[index].vd;
    found.shortest_nm = list[index].shortest_nm, found.longest_nm = list[index].longest_nm;
    copy_text(list[index].catalogue, found.catalogue);
    copy_text(list[index].name, found.name);
    send(found, glass, "petzval_glass");
  });
}

petzval_status petzval_lens_read(const char* file, const petzval_lens_options* options, petzval_lens** lens) {
  return guarded(results(lens), [&] {
    open_lens(options, lens, [&](const ReadOptions& how) { return read_lens(&given(file, "file"), how); });
  });
}

petzval_status petzval_lens_parse(const char* bytes, std::size_t count, const char* name,
                                  const petzval_lens_options* options, petzval_lens** lens) {
  return guarded(results(lens), [&] {
    open_lens(options, lens, [&](const ReadOptions& how) {
      return parse_lens(std::string(&given(bytes, "bytes"), count), name ? name : "lens", how);
    });
  });
}

petzval_status petzval_lens_copy(const petzval_lens* lens, petzval_lens** copy) {
  return guarded(results(copy), [&] {
    given(copy, "copy");
    give(std::make_shared<LensContents>(*live(lens, "lens").contents), copy);
  });
}

void petzval_lens_free(petzval_lens* lens) { release(lens); }

petzval_status petzval_lens_get_info(const petzval_lens* handle, petzval_lens_info* info) {
  return guarded(results(info), [&] {
    const LensContents& contents = *live(handle, "lens").contents;
    const Lens& lens = contents.lens;
    const FirstOrder first = first_order(lens, {}, main_meridian(lens));
    const Prescription own = own_prescription(contents);
    petzval_lens_info found{};
    found.size = sizeof found;
    found.focal_length_mm = first.effective_focal_length;
    found.film_z_mm = lens.film_z();
    found.rear_focal_z_mm = first.rear_focal_z;
    found.front_principal_z_mm = first.front_principal_z;
    found.rear_principal_z_mm = first.rear_principal_z;
    found.f_number = found.entrance_pupil_z_mm = found.entrance_pupil_diameter_mm = unknown;
    found.exit_pupil_z_mm = found.exit_pupil_diameter_mm = unknown;
    if (has_pupils(lens)) {
      const Pupils both = pupils(lens, {}, main_meridian(lens));
      found.entrance_pupil_z_mm = both.entrance.z, found.entrance_pupil_diameter_mm = both.entrance.diameter;
      found.exit_pupil_z_mm = both.exit.z, found.exit_pupil_diameter_mm = both.exit.diameter;
      found.f_number = real_f_number(lens);
    }
    const auto field = declared_half_field(own, contents.base);
    found.declared_half_field_deg = field ? degrees(*field) : unknown;
    found.declared_f_number = own.f_number.value_or(unknown);
    found.image_diagonal_mm = own.image_diagonal_mm.value_or(unknown);
    found.squeeze = squeeze(lens);
    found.surface_count = static_cast<std::int64_t>(lens.surface_count());
    found.wavelength_count = static_cast<std::int64_t>(lens.wavelengths_nm().size());
    found.primary_wavelength = static_cast<std::int64_t>(lens.primary_wavelength());
    found.stop = lens.stop() ? static_cast<std::int64_t>(*lens.stop()) : -1;
    found.index_error = lens.index_error();
    found.has_cylinders = camera_detail::has_cylinders(lens);
    found.has_moving_groups = !lens.focus_positions().empty();
    send(found, info, "petzval_lens_info");
  });
}

petzval_status petzval_lens_get_surface(const petzval_lens* handle, std::size_t index, petzval_surface* surface) {
  return guarded(results(surface), [&] {
    const Lens& lens = live(handle, "lens").contents->lens;
    if (index >= lens.surface_count()) {
      bad_argument("index = " + std::to_string(index) + "; must be below " + std::to_string(lens.surface_count()));
    }
    const LensSurface& own = lens.surfaces()[index];
    petzval_surface found{};
    found.size = sizeof found;
    found.vertex_z_mm = own.vertex_z, found.thickness_mm = own.thickness;
    found.curvature = own.curvature, found.conic = own.conic;
    found.semi_diameter_mm = own.semi_diameter;
    found.index_before = lens.index(index), found.index_after = lens.index(index + 1);
    found.mirror = own.mirror;
    found.aspheric_terms = static_cast<std::int32_t>(own.aspheric.size());
    found.stop = lens.stop() == index;
    found.section = own.curved_in == Section::both ? 0 : own.curved_in == Section::x ? 1 : 2;
    send(found, surface, "petzval_surface");
  });
}

petzval_status petzval_lens_get_text(const petzval_lens* handle, std::int32_t kind, std::size_t index, char* text,
                                     std::size_t capacity, std::size_t* length) {
  return guarded(results(text, capacity), [&] {
    if (length) *length = 0;
    const LensContents& contents = *live(handle, "lens").contents;
    const auto& imported = contents.setup.lens.prescription->imported;
    std::string found;
    switch (kind) {
      case PETZVAL_TEXT_NAME: found = contents.lens.name(); break;
      case PETZVAL_TEXT_WARNING:
        if (imported && index < imported->warnings.size()) {
          const ImportWarning& warning = imported->warnings[index];
          found = "line " + std::to_string(warning.line) + ": " + warning.command + ": " + warning.message;
        }
        break;
      case PETZVAL_TEXT_CLAMPED_GLASS: found = at(contents.lens.clamped_glasses(), index); break;
      case PETZVAL_TEXT_MISSING_GLASS: found = at(contents.lens.missing_glasses(), index); break;
      case PETZVAL_TEXT_PRESCRIPTION: found = format_prescription(*contents.setup.lens.prescription); break;
      default: bad_argument("kind = " + std::to_string(kind) + "; must be PETZVAL_TEXT_...");
    }
    const bool ended = found.empty() && kind != PETZVAL_TEXT_NAME;
    if (ended && capacity > 0) given(text, "text") = 0;
    if (!ended) copy_bytes({found.c_str(), found.size() + 1}, text, capacity, length);
  });
}

petzval_status petzval_lens_report(const petzval_lens* handle, const double* fields_deg, std::size_t count,
                                   std::int32_t threads, char* text, std::size_t capacity, std::size_t* length) {
  return guarded(results(text, capacity), [&] {
    if (length) *length = 0;
    const LensContents& contents = *live(handle, "lens").contents;
    const CameraSetup& setup = contents.setup;
    if (count > 0) given(fields_deg, "fields_deg");
    LensReport::Conditions conditions{.fields_deg = {fields_deg, fields_deg + count},
                                      .threads = threads == 0 ? 1 : threads};
    const double stated = own_prescription(contents).design.object_distance_mm;
    conditions.subject_z = setup.focus_mm ? origin_z(contents.lens, setup.focus.origin) - *setup.focus_mm : -stated;
    const std::string found = to_json(lens_report(contents.lens, std::move(conditions)));
    copy_bytes({found.c_str(), found.size() + 1}, text, capacity, length);
  });
}

petzval_status petzval_lens_set_f_number(petzval_lens* lens, double f_number) {
  return change(lens, [&](CameraSetup& setup) { setup.f_number = f_number; });
}

petzval_status petzval_lens_set_iris(petzval_lens* lens, std::int32_t blades, double roundness, double rotation) {
  return change(lens, [&](CameraSetup& setup) {
    setup.iris = {.blades = blades, .roundness = roundness, .rotation_rad = rotation};
    iris_area(setup.iris);  // checks the values
  });
}

petzval_status petzval_lens_set_focus(petzval_lens* lens, double distance_mm, std::int32_t origin) {
  return change(lens, [&](CameraSetup& setup) {
    setup.focus_mm = distance_mm, setup.focus.origin = distance_origin(origin, "origin");
  });
}

petzval_status petzval_lens_fit_film(const petzval_lens* handle, const petzval_focus_point* points, std::size_t count,
                                     double max_tilt_rad, petzval_film* film, petzval_film_fit* fit) {
  return guarded(results(fit), [&] {
    const Lens& lens = live(handle, "lens").contents->lens;
    const Film start = film_of(&given(film, "film"));
    std::vector<FocusTarget> targets;
    if (count > 0) given(points, "points");
    for (const petzval_focus_point& point : std::span(points, count)) {
      targets.push_back({.point = {{point.position_mm[0], point.position_mm[1], point.position_mm[2]}},
                         .blur_mm = point.blur_mm,
                         .weight = point.weight});
    }
    petzval_film_fit found{};
    found.size = sizeof found;
    Film fitted;
    std::string_view status;
    if (max_tilt_rad == 0) {
      const Autofocus solution = autofocus(lens, targets, start);
      if (!solution) status = name(solution.status);
      fitted = solution.film, found.rms_mm = solution.rms_mm, found.upright = 1;
    } else {
      const TiltOptions options{.max_tilt_rad = max_tilt_rad, .film = start};
      const TiltFit solution =
          fit_detail::fit_film(image_rays(lens, start, targets, options.rays), targets, options, {});
      if (!solution) status = name(solution.status);
      fitted = solution.film, found.rms_mm = solution.rms_mm;
      found.limited = solution.status == FocusStatus::limited;
      found.upright = solution.status == FocusStatus::least_tilt;
    }
    if (!status.empty()) throw Error(lens.name() + ": film for focus points: " + std::string(status));
    petzval_film result = received(film, "petzval_film");
    result.z_mm = fitted.z(), result.has_z = 1;
    result.tilt_rad = fitted.tilt_rad, result.swing_rad = fitted.swing_rad;
    result.shift_x_mm = fitted.shift_x_mm, result.shift_y_mm = fitted.shift_y_mm;
    if (fit) send(found, fit, "petzval_film_fit");
    send(result, film, "petzval_film");
  });
}

petzval_status petzval_lens_choose_model(const petzval_lens* handle, const petzval_film* film,
                                         const petzval_requirements* requirements, petzval_choice* choice) {
  return guarded(results(choice), [&] {
    const Lens& lens = live(handle, "lens").contents->lens;
    const auto own = received(requirements, "petzval_requirements");
    const auto limit = [](double value) { return value == 0 ? std::nullopt : std::optional(value); };
    const ModelChoice chosen =
        choose_model(lens,
                     {.near_mm = own.near_mm == 0 ? 1000 : own.near_mm,
                      .far_mm = own.far_mm == 0 ? std::numeric_limits<double>::infinity() : own.far_mm,
                      .film = film_of(film),
                      .origin = DistanceOrigin::film},
                     {.max_px = limit(own.max_px),
                      .max_of_blur = limit(own.max_of_blur),
                      .exposure = limit(own.exposure),
                      .pupil_shape = own.pupil_shape == 0 ? 0.1 : own.pupil_shape},
                     own.threads == 0 ? 1 : own.threads);
    petzval_choice found{};
    found.size = sizeof found;
    copy_text(name(chosen.model), found.model);
    const auto row = std::ranges::find(chosen.table, chosen.model, &ModelCandidate::model);
    if (row != chosen.table.end()) {
      found.max_px = row->error.all.max_px;
      found.exposure = row->error.exposure, found.pupil_shape = row->error.pupil_shape;
      found.ns_per_ray = row->ns_per_ray;
    }
    std::string reasons;
    for (const std::string& reason : chosen.reasons) reasons += reason + '\n';
    copy_text(reasons, found.reasons);
    send(found, choice, "petzval_choice");
  });
}
