// SPDX-License-Identifier: Apache-2.0
#include <concepts>

#include "io/json_members.hpp"
#include "petzval/analysis/report.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/io/lint.hpp"

namespace petzval {
namespace {

using io_detail::OrderedJson;

/// A value as JSON; null if it is not finite or nullopt.
template <class T>
OrderedJson json(const T& value) {
  if constexpr (std::same_as<T, OrderedJson>) {
    return value;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? json(*value) : OrderedJson();
  } else {
    return io_detail::json_of(value);
  }
}

/// Adds keys and values to an object.
template <class T, class... More>
void add(OrderedJson& to, const char* key, const T& value, const More&... more) {
  to.add(key, json(value));
  if constexpr (sizeof...(more) > 0) add(to, more...);
}
template <class... Members>
OrderedJson object(const Members&... members) {
  OrderedJson result = OrderedJson::object();
  add(result, members...);
  return result;
}

/// A member of an optional struct.
template <class T, class Member>
std::optional<Member> member(const std::optional<T>& from, Member T::*which) {
  return from ? std::optional(*from.*which) : std::nullopt;
}

std::optional<double> um(const std::optional<double>& mm) { return mm ? std::optional(1000 * *mm) : std::nullopt; }

void add_section(OrderedJson& to, const LensReport::Section& section, const std::optional<double>& f_number) {
  const FirstOrder& first = section.first_order;
  const std::optional<Pupil> entrance = member(section.pupils.value, &Pupils::entrance),
                             exit = member(section.pupils.value, &Pupils::exit);
  const auto diameter = member(entrance, &Pupil::diameter);
  const auto paraxial = diameter ? std::optional(std::abs(first.effective_focal_length) / *diameter) : std::nullopt;
  add(to, "afocal", first.afocal, "entrance_pupil_z_mm", member(entrance, &Pupil::z), "entrance_pupil_diameter_mm",
      diameter, "exit_pupil_z_mm", member(exit, &Pupil::z), "exit_pupil_diameter_mm", member(exit, &Pupil::diameter),
      "f_number", f_number, "f_number_paraxial", paraxial, "effective_focal_length_mm", first.effective_focal_length,
      "back_focal_distance_mm", first.back_focal_distance, "front_focal_distance_mm", first.front_focal_distance,
      "front_principal_z_mm", first.front_principal_z, "rear_principal_z_mm", first.rear_principal_z,
      "petzval_sum_per_mm", first.petzval_sum);
}

OrderedJson paraxial_rays_json(const LensReport& r, const ParaxialRays& rays) {
  OrderedJson list = OrderedJson::list();
  for (int number = r.conditions.first_surface_number; const ParaxialRays::Pair& pair : rays.surfaces) {
    list.add(object("surface", number++, "marginal_y", pair.marginal_y, "marginal_u", pair.marginal_u, "chief_y",
                    pair.chief_y, "chief_u", pair.chief_u));
  }
  return list;
}

void add_terms(OrderedJson& to, const SeidelTerms& t, bool coloured) {
  add(to, "S1", t.s1, "S2", t.s2, "S3", t.s3, "S4", t.s4, "S5", t.s5);
  add(to, "C1", coloured ? json(t.c1) : OrderedJson(), "C2", coloured ? json(t.c2) : OrderedJson());
}

/// Values of points; contrasts are null if no ray passes.
OrderedJson list_of(std::span<const MtfPoint> points, double MtfPoint::*value) {
  const bool contrast = value == &MtfPoint::tangential || value == &MtfPoint::sagittal;
  OrderedJson list = OrderedJson::list();
  for (const MtfPoint& p : points) list.add(contrast && p.sampling_error == 0 ? OrderedJson() : json(p.*value));
  return list;
}

void add_seidel(OrderedJson& to, OrderedJson& failures, const LensReport& r) {
  if (!r.seidel) {
    add(failures, "seidel", r.seidel.failure);
    return add(to, "seidel", OrderedJson(), "seidel_sums", OrderedJson(), "seidel_sums_declared", OrderedJson());
  }
  const bool coloured = r.lens.wavelengths_nm().size() > 1;
  OrderedJson list = OrderedJson::list(), sums = OrderedJson::object(), declared = OrderedJson::object();
  for (int number = r.conditions.first_surface_number; const SeidelTerms& terms : r.seidel->surfaces) {
    add_terms(list.add(object("surface", number++)), terms, coloured);
  }
  add_terms(sums, r.seidel->sums, coloured);
  if (r.seidel_declared) add_terms(declared, r.seidel_declared->sums, coloured);
  add(to, "seidel", list, "seidel_sums", sums, "seidel_sums_declared", r.seidel_declared ? declared : OrderedJson());
}

/// Writes lists of quantities, and the reasons for quantities without a value. `add_entry` gets the list, the row and
/// the column of a value, and the value.
struct Writer {
  OrderedJson& to;
  OrderedJson failures = OrderedJson::object();

  template <class T, class Add>
  void operator()(const char* key, const LensReport::Quantity<Grid<T>>& grid, const Add& add_entry) {
    OrderedJson& list = to.add(key, grid ? OrderedJson::list() : OrderedJson());
    if (!grid) return add(failures, key, grid.failure);
    for (std::size_t i = 0; i < grid->values.size(); ++i) {
      add_entry(list, i / grid->columns, i % grid->columns, grid->values[i]);
    }
  }
  template <class T, class Add>
  void operator()(const char* key, const LensReport::Quantity<std::vector<T>>& values, const Add& add_entry) {
    LensReport::Quantity<Grid<T>> grid{{}, values.failure};
    if (values) grid.value = {*values, 1};
    (*this)(key, grid, add_entry);
  }
};

}  // namespace

std::string to_json(const LensReport& r) {
  const Lens& lens = r.lens;
  const std::vector<double>&fields = r.conditions.fields_deg, &weights = r.conditions.wavelength_weights;
  const int first_surface = r.conditions.first_surface_number;
  const std::vector<double> nm(lens.wavelengths_nm().begin(), lens.wavelengths_nm().end());
  const LensReport::Section& main = r.sections.front();
  const auto stop = member(main.pupils.value, &Pupils::stop);
  OrderedJson report = object("name", lens.name(), "dispersion", lens.dispersion(), "wavelength_nm",
                              nm[lens.primary_wavelength()], "surfaces_from", first_surface, "stop_surface",
                              stop ? std::optional(first_surface + static_cast<int>(*stop)) : std::nullopt,
                              "stop_inferred", main.pupils && main.pupils->stop_inferred);
  add_section(report, main, r.f_number.value);
  add(report, "film_z_mm", lens.film_z(), "subject_distance_mm", r.largest_field.object_distance, "wavelengths_nm", nm,
      "wavelength_weights", weights.empty() ? std::vector<double>(nm.size(), 1) : weights, "fields_deg", fields,
      "meridian", std::string(main.meridian == Meridian::y ? "y" : "x"));
  OrderedJson& meridians = report.add("meridians", r.sections.size() > 1 ? OrderedJson::object() : OrderedJson());
  for (std::size_t i = 0; r.sections.size() > 1 && i < r.sections.size(); ++i) {
    const LensReport::Section& section = r.sections[i];
    add_section(meridians.add(section.meridian == Meridian::y ? "y" : "x", OrderedJson::object()), section,
                i == 0 ? r.f_number.value : std::nullopt);
  }
  Writer write{report};
  add_seidel(report, write.failures, r);
  if (!r.paraxial_rays) add(write.failures, "paraxial_rays", r.paraxial_rays.failure);
  add(report, "paraxial_rays", r.paraxial_rays ? paraxial_rays_json(r, *r.paraxial_rays) : OrderedJson());
  add(report, "optical_invariant_mm", member(r.paraxial_rays.value, &ParaxialRays::invariant),
      "optical_invariant_declared_mm", member(r.paraxial_rays_declared.value, &ParaxialRays::invariant));

  using List = OrderedJson;
  using Index = std::size_t;
  const auto at = [&](std::size_t field, const auto&... values) {
    return object("field_deg", fields[field], values...);
  };
  write("ray_fans", r.ray_fans, [&](List& list, Index field, Index k, const RayFan& fan) {
    for (const RayFan::Point& p : fan.points) {
      list.add(at(field, "wavelength_nm", nm[k], "pupil", p.pupil, "tangential_mm", p.tangential_mm, "sagittal_mm",
                  p.sagittal_mm, "tangential_waves", p.tangential_waves, "sagittal_waves", p.sagittal_waves));
    }
  });
  write("field_curvature", r.field_curvature, [&](List& list, Index field, Index, const FieldFocus& focus) {
    list.add(at(field, "tangential_mm", focus.tangential_mm, "sagittal_mm", focus.sagittal_mm));
  });
  write("distortion_percent", r.distortion, [&](List& list, Index field, Index, const FieldDistortion& one) {
    list.add(at(field, "f_tan_theta", one.f_tan_theta_percent, "f_theta", one.f_theta_percent));
  });
  write("mtf", r.mtf, [&](List& list, Index field, Index k, const MtfPoint& p) {
    const bool dark = (*r.mtf)[field][0].tangential == 0;  // at frequency 0
    list.add(at(field, "frequency_per_mm", p.frequency_per_mm, "tangential", dark ? List() : json(p.tangential),
                "sagittal", dark ? List() : json(p.sagittal), "sampling_error", p.sampling_error, "diffraction_limit",
                r.diffraction_limit ? json((*r.diffraction_limit)[k]) : List()));
  });
  write("mtf_over_field", r.mtf_over_field, [](List& list, Index, Index, const MtfPoint& p) {
    list.add(object("field_deg", degrees(p.field_rad), "frequency_per_mm", p.frequency_per_mm, "tangential",
                    p.tangential, "sagittal", p.sagittal, "sampling_error", p.sampling_error));
  });
  write("mtf_diffraction", r.mtf_diffraction, [&](List& list, Index field, Index k, const MtfPoint& p) {
    if (k > 0) return;
    const std::span<const MtfPoint> points = (*r.mtf_diffraction)[field];
    list.add(at(field, "image_height_mm", p.image_height_mm, "wavelengths", nm, "lp_per_mm",
                list_of(points, &MtfPoint::frequency_per_mm), "tangential", list_of(points, &MtfPoint::tangential),
                "sagittal", list_of(points, &MtfPoint::sagittal), "error", p.sampling_error));
  });
  write("mtf_chart", r.mtf_chart, [](List& list, Index, Index, const MtfChart& chart) {
    const auto& [f_number, points] = chart;
    for (Index k = 0; k < points.columns; ++k) {
      std::vector<MtfPoint> line;
      for (Index height = 0; height < points.size(); ++height) line.push_back(points[height][k]);
      list.add(object("f_number", f_number, "lp_per_mm", line[0].frequency_per_mm, "image_height_mm",
                      list_of(line, &MtfPoint::image_height_mm), "tangential", list_of(line, &MtfPoint::tangential),
                      "sagittal", list_of(line, &MtfPoint::sagittal)));
    }
  });
  write("mtf_through_focus", r.mtf_through_focus, [&](List& list, Index field, Index k, const MtfPoint& p) {
    if (k > 0) return;
    const std::span<const MtfPoint> points = (*r.mtf_through_focus)[field];
    list.add(at(field, "lp_per_mm", p.frequency_per_mm, "film_shift_mm", json(mtf_film_shifts(r)), "tangential",
                list_of(points, &MtfPoint::tangential), "sagittal", list_of(points, &MtfPoint::sagittal), "error",
                p.sampling_error));
  });
  write("through_focus", r.through_focus, [&](List& list, Index field, Index, const ThroughFocusSpot& spot) {
    list.add(at(field, "film_shift_mm", spot.film_shift_mm, "rms_radius_mm", spot.rms_radius_mm, "sampling_error_mm",
                spot.sampling_error_mm));
  });
  write("encircled_energy", r.encircled_energy, [&](List& list, Index field, Index, const EncircledEnergy& p) {
    list.add(at(field, "fraction", p.fraction, "radius_um", um(p.radius_mm), "sampling_error_um",
                1000 * p.sampling_error_mm));
  });
  write("longitudinal_aberration", r.longitudinal_aberration,
        [&](List& list, Index wavelength, Index, const AxialRayFocus& focus) {
          list.add(object("wavelength_nm", nm[wavelength], "pupil", focus.pupil, "tangential_mm", focus.tangential_mm,
                          "sagittal_mm", focus.sagittal_mm));
        });
  write("lateral_colour", r.lateral_colour, [&](List& list, Index field, Index k, const std::optional<double>& shift) {
    list.add(at(field, "wavelength_nm", nm[k], "chief_ray_shift_um", um(shift)));
  });
  write("wavefront", r.wavefront, [&](List& list, Index field, Index k, const std::optional<Wavefront>& front) {
    using W = Wavefront;
    const auto strehl = front ? front->strehl : std::nullopt;
    list.add(at(field, "wavelength_nm", nm[k], "rms_waves", member(front, &W::rms_waves), "rms_without_tilt_waves",
                member(front, &W::rms_without_tilt), "peak_to_valley_waves", member(front, &W::peak_to_valley_waves),
                "strehl", strehl, "strehl_error", strehl ? json(front->strehl_error) : List(), "zernike_fringe",
                member(front, &W::zernike), "zernike_residual_waves", member(front, &W::zernike_residual_waves),
                "sampling_error_waves", member(front, &W::sampling_error_waves)));
  });
  OrderedJson edges = OrderedJson::list();
  for (const std::optional<double>& edge : edge_thicknesses(lens)) edges.add(json(edge));
  add(report, "failures", write.failures, "edge_thicknesses_mm", edges, "missing_glasses", lens.missing_glasses());
  return io_detail::format_json(report);
}

}  // namespace petzval
