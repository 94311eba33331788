// SPDX-License-Identifier: Apache-2.0
#include "petzval/trace/trace.hpp"

#include "petzval/trace/sequential.hpp"

namespace petzval {
namespace {

template <class T>
bool usable(const Ray<T>& ray) noexcept {
  using kernel::finite;
  const auto& o = ray.origin;
  const T length = dot(kernel::to_kernel(ray.direction), kernel::to_kernel(ray.direction));
  return finite(o.x) && finite(o.y) && finite(o.z) && length > T(0.999) && length < T(1.001);
}

template <class T>
TracedRay<T> trace_one(const kernel::LensView<T>& view, const Ray<T>& ray, const kernel::Path& path) noexcept {
  if (!usable(ray) || path.wavelength >= view.wavelengths) {
    const bool to_film = path.travel == Travel::to_film;
    const int first_met = to_film ? 0 : static_cast<int>(view.count) - 1;
    return {{{0, 0, 0}, {0, 0, to_film ? T(1) : T(-1)}}, RayFate::missed_surface, first_met};
  }
  const auto end = kernel::trace(view, kernel::to_kernel(ray.origin), kernel::to_kernel(ray.direction), path);
  return {{kernel::to_public(end.origin), kernel::to_public(end.direction)}, end.fate, end.surface};
}

kernel::Path whole_lens(const TraceOptions& options) noexcept {
  return {.travel = options.travel, .wavelength = options.wavelength, .apertures = options.apertures};
}

}  // namespace

template <class T>
TracedRay<T> trace(const Lens& lens, const Ray<T>& ray, const TraceOptions& options) noexcept {
  return trace_one(lens.view<T>(), ray, whole_lens(options));
}

template <class T>
void trace(const Lens& lens, std::size_t count, const RayArrays<const T>& in, const RayArrays<T>& out, RayFate* fates,
           int* surfaces, const TraceOptions& options) noexcept {
  const auto view = lens.view<T>();
  const auto path = whole_lens(options);
  for (std::size_t i = 0; i < count; ++i) {
    const Ray<T> ray{{in.x[i], in.y[i], in.z[i]}, {in.dx[i], in.dy[i], in.dz[i]}};
    const auto [end, fate, surface] = trace_one(view, ray, path);
    out.x[i] = end.origin.x;
    out.y[i] = end.origin.y;
    out.z[i] = end.origin.z;
    out.dx[i] = end.direction.x;
    out.dy[i] = end.direction.y;
    out.dz[i] = end.direction.z;
    if (fates) fates[i] = fate;
    if (surfaces) surfaces[i] = surface;
  }
}

template PETZVAL_API TracedRay<float> trace(const Lens&, const Ray<float>&, const TraceOptions&) noexcept;
template PETZVAL_API TracedRay<double> trace(const Lens&, const Ray<double>&, const TraceOptions&) noexcept;
template PETZVAL_API void trace(const Lens&, std::size_t, const RayArrays<const float>&, const RayArrays<float>&,
                                RayFate*, int*, const TraceOptions&) noexcept;
template PETZVAL_API void trace(const Lens&, std::size_t, const RayArrays<const double>&, const RayArrays<double>&,
                                RayFate*, int*, const TraceOptions&) noexcept;

}  // namespace petzval
