// SPDX-License-Identifier: Apache-2.0
// Cameras of the C interface as JSON: a set-up and host options.
#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "handles.hpp"
#include "io/json_members.hpp"
#include "petzval/formats/lens_file.hpp"

namespace petzval::c_detail {

using namespace io_detail;

constexpr std::array host_origins{DistanceOrigin::front_vertex, DistanceOrigin::film, DistanceOrigin::entrance_pupil};

template <Is<HostOptions> S, class Of>
void members(S& host, const Of& of) {
  of("frame", host.frame, Range{PETZVAL_FRAME_LENS, PETZVAL_FRAME_ARNOLD, "a frame, 0 to 3"});
  of("origin", host.origin, host_origins), of("near_far_origin", host.near_far_origin, host_origins);
  of("units_per_mm", host.units_per_mm), of("near_mm", host.near_mm, not_negative);
  constexpr Range distance{0, std::numeric_limits<double>::infinity(), "a number of 0 or more, or null for infinity"};
  of("far_mm", host.far_mm, distance), of("opens_mm", host.opens_mm, distance);
  of("closes_mm", host.closes_mm, distance);
}

/// The set-up of a camera and its host options, with the glasses that the lens uses.
std::string write_camera(const CameraContents& own) {
  CameraSetup setup = own.setup;
  const auto add = [&](const Medium& medium) {
    const Glass* const glass = own.glasses ? glass_of(medium, *own.glasses) : nullptr;
    const auto same = [&](const Glass& other) {
      return other.name == glass->name && other.catalogue == glass->catalogue;
    };
    if (glass && std::ranges::none_of(setup.lens.glasses, same)) setup.lens.glasses.push_back(*glass);
  };
  if (const std::optional<Prescription>& lens = setup.lens.prescription) {
    add(lens->object_space);
    for (const SurfaceRow& row : lens->surfaces) add(row.medium);
    for (const Configuration& configuration : lens->configurations) {
      for (const SurfaceChange& change : configuration.changes) {
        if (change.medium) add(*change.medium);
      }
    }
  }
  OrderedJson json = OrderedJson::object();
  json.add("setup", setup_json(setup)), json.add("host", json_of(own.host));
  return format_json(json);
}

std::shared_ptr<CameraContents> read_camera(std::string_view bytes) {
  const JsonTree tree(bytes, "camera set-up", words_of);
  CameraSetup setup;
  HostOptions host;
  const auto read = [&](const JsonPart& part) { setup = read_setup(part); };
  JsonPart(tree).read({{"setup", read, required}, {"host", [&](const auto& part) { read_value(part, host); }}});
  const Lens lens = prepared(setup, compile(setup));
  std::shared_ptr<const GlassCatalogue> glasses;
  if (!setup.lens.glasses.empty()) glasses = std::make_shared<const GlassCatalogue>(std::move(setup.lens.glasses));
  setup.lens.glasses.clear();
  return std::make_shared<CameraContents>(std::move(setup), host, std::move(glasses), lens);
}

}  // namespace petzval::c_detail
