// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <optional>
#include <vector>

#include "petzval/trace/trace.hpp"
#include "textbook_tracer.hpp"
#include "trace/sequential.hpp"
#include "trace_rays.hpp"

/// A method of tracing a set of rays to the scene, timed in rounds; its results are compared afterwards. Every thread
/// has its own object with a copy of the rays.
class Work {
 public:
  virtual ~Work() = default;

  /// Traces all rays once and writes all results to memory.
  virtual void trace() = 0;

  /// Direction of a ray after trace(); nullopt if the ray was lost.
  virtual std::optional<petzval::Vec3<double>> direction(std::size_t ray) const = 0;
};

class TextbookWork : public Work {
 public:
  TextbookWork(const BenchLens& bench, const RaySet& set) : tracer_(bench.textbook) {
    for (const auto& ray : set.in_float.rays) rays_.push_back({ray.origin, ray.direction});
    traced_.resize(rays_.size());
    passed_.resize(rays_.size());
  }

  void trace() override {
    for (std::size_t i = 0; i < rays_.size(); ++i) passed_[i] = tracer_.trace(rays_[i], traced_[i]);
  }

  std::optional<petzval::Vec3<double>> direction(std::size_t ray) const override {
    if (!passed_[ray]) return {};
    return petzval::Vec3<double>(traced_[ray].direction);
  }

 private:
  const TextbookTracer& tracer_;
  std::vector<TextbookTracer::Ray> rays_, traced_;
  std::vector<char> passed_;
};

/// The trace of one ray, called for each ray.
template <class T>
class SingleWork : public Work {
 public:
  SingleWork(const BenchLens& bench, const RaySet& set)
      : lens_(bench.lens), rays_(set.of<T>().rays), traced_(rays_.size()) {}

  void trace() override {
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      traced_[i] = petzval::trace(lens_, rays_[i], {.travel = petzval::Travel::to_scene});
    }
  }

  std::optional<petzval::Vec3<double>> direction(std::size_t ray) const override {
    if (!traced_[ray].transmitted()) return {};
    return petzval::Vec3<double>(traced_[ray].ray.direction);
  }

 protected:
  const petzval::Lens& lens_;
  std::vector<petzval::Ray<T>> rays_;
  std::vector<petzval::TracedRay<T>> traced_;
};

/// The reference kernel, called for each ray.
template <class T>
class TemplateWork : public SingleWork<T> {
 public:
  using SingleWork<T>::SingleWork;

  void trace() override {
    const auto view = petzval::kernel::view<T>(this->lens_);
    for (std::size_t i = 0; i < this->rays_.size(); ++i) {
      const auto& [origin, direction] = this->rays_[i];
      const auto end =
          petzval::kernel::trace(view, petzval::kernel::to_kernel(origin), petzval::kernel::to_kernel(direction),
                                 {.travel = petzval::Travel::to_scene});
      this->traced_[i] = {
          {petzval::kernel::to_public(end.origin), petzval::kernel::to_public(end.direction)}, end.fate, end.surface};
    }
  }
};

/// Memory aligned to cache lines.
template <class T>
struct OnCacheLines {
  using value_type = T;
  static constexpr std::align_val_t line{64};

  OnCacheLines() = default;
  template <class U>
  explicit OnCacheLines(const OnCacheLines<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, line); }
  friend bool operator==(const OnCacheLines&, const OnCacheLines&) { return true; }
};

/// A batch over arrays of structures.
template <class T>
class StructuresWork : public SingleWork<T> {
 public:
  StructuresWork(const BenchLens& bench, const RaySet& set, const petzval::BatchOptions& options)
      : SingleWork<T>(bench, set), options_(options) {}

  void trace() override { petzval::trace<T>(this->lens_, this->rays_, this->traced_.data(), options_); }

 private:
  petzval::BatchOptions options_;
};

/// A batch over structures of arrays.
template <class T>
class ArraysWork : public Work {
 public:
  ArraysWork(const BenchLens& bench, const RaySet& set, const petzval::BatchOptions& options)
      : lens_(bench.lens), options_(options) {
    const auto& rays = set.of<T>().rays;
    for (auto& a : out_) a.resize(rays.size());
    fates_.resize(rays.size());
    surfaces_.resize(rays.size());
    for (const auto& ray : rays) {
      for (int k = 0; k < 3; ++k) {
        in_[static_cast<std::size_t>(k)].push_back(ray.origin[k]);
        in_[static_cast<std::size_t>(k) + 3].push_back(ray.direction[k]);
      }
    }
  }

  void trace() override {
    petzval::trace<T>(lens_, fates_.size(), arrays<const T>(in_), arrays<T>(out_), fates_.data(), surfaces_.data(),
                      options_);
  }

  std::optional<petzval::Vec3<double>> direction(std::size_t ray) const override {
    if (fates_[ray] != petzval::RayFate::transmitted) return {};
    return petzval::Vec3<double>(out_[3][ray], out_[4][ray], out_[5][ray]);
  }

 protected:
  using Columns = std::array<std::vector<T, OnCacheLines<T>>, 6>;

  template <class Element, class From>
  static petzval::RayArrays<Element> arrays(From& c) {
    return {c[0].data(), c[1].data(), c[2].data(), c[3].data(), c[4].data(), c[5].data()};
  }

  const petzval::Lens& lens_;
  petzval::BatchOptions options_;
  Columns in_, out_;
  std::vector<petzval::RayFate> fates_;
  std::vector<int> surfaces_;
};

/// A batch over structures of arrays, with derivatives with respect to the film point.
template <class T>
class DifferentialsWork : public ArraysWork<T> {
 public:
  DifferentialsWork(const BenchLens& bench, const RaySet& set, const petzval::BatchOptions& options)
      : ArraysWork<T>(bench, set, options) {
    for (auto* columns : {&u_in_, &v_in_, &u_out_, &v_out_}) {
      for (auto& column : *columns) column.resize(this->fates_.size());
    }
    std::fill(u_in_[0].begin(), u_in_[0].end(), T(1));
    std::fill(v_in_[1].begin(), v_in_[1].end(), T(1));
  }

  void trace() override {
    const auto in = [](const auto& columns) { return ArraysWork<T>::template arrays<const T>(columns); };
    const auto out = [](auto& columns) { return ArraysWork<T>::template arrays<T>(columns); };
    petzval::trace_differentials<T>(this->lens_, this->fates_.size(), in(this->in_), {in(u_in_), in(v_in_)},
                                    out(this->out_), {out(u_out_), out(v_out_)}, this->fates_.data(),
                                    this->surfaces_.data(), this->options_);
  }

 private:
  typename ArraysWork<T>::Columns u_in_, v_in_, u_out_, v_out_;
};
