// SPDX-License-Identifier: Apache-2.0
#include "psf_job.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "bokeh.hpp"
#include "contact_sheet.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"
#include "petzval/core/geometry.hpp"
#include "petzval/image/psf.hpp"
#include "text.hpp"

namespace examples {
namespace {

namespace fs = std::filesystem;

constexpr const char* job_file = "job.json";

std::vector<double> axis(const Json& description, const char* key) {
  std::vector<double> values;
  for (const Json& value : description.at(key)) {
    values.push_back(value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>());
  }
  return values;
}

/// The number of shards, if the shards that began in the folders agree; otherwise nullopt.
std::optional<std::size_t> shard_count(const std::vector<fs::path>& folders) {
  std::set<std::size_t> counts;
  for (const fs::path& folder : folders) {
    for (const fs::path& entry : entries(folder)) {
      if (const auto shard = shard_of_file(entry, "shard")) counts.insert(shard->count);
    }
  }
  return counts.size() == 1 && *counts.begin() > 1 ? std::optional(*counts.begin()) : std::nullopt;
}

Json index(const PsfJob& job, const std::vector<petzval::ExrPart>& parts, const fs::path& file) {
  Json json = job.description();
  json.erase("prescription");
  json["exr"] = file.filename().string();
  json["units"] = {{"light",
                    "channel Y: film irradiance relative to the wide-open lens on the axis in a uniformly bright "
                    "scene; total is the sum of all pixels"},
                   {"lengths", "mm"},
                   {"throughput", "fraction of the light on the paraxial entrance pupil of the PSF's own stop"},
                   {"error", "bound of the relative error of the radial profile, held by 95 of 100 runs"}};
  json["frame"] =
      "rows from the top; up is away from the centre of a photograph, towards the field; the anchor is at the centre "
      "of the middle pixel; anchor_mm is its position on the film, where the picture is upside down";
  json["psfs"] = Json::array();
  for (const petzval::ExrPart& part : parts) {
    const auto [point, kernel] = petzval::from_exr_part(part);
    json["psfs"].push_back({{"part", part.name},
                            {"field_deg", point.field_deg},
                            {"distance_mm", finite_or_null(point.distance_mm)},
                            {"wavelength_nm", point.wavelength_nm},
                            {"f_number", point.f_number},
                            {"pixels", kernel.pixels},
                            {"pixel_mm", kernel.pixel_mm},
                            {"anchor", part.texts.at("anchor")},
                            {"anchor_mm", {kernel.anchor_mm.x, kernel.anchor_mm.y}},
                            {"total", kernel.total},
                            {"throughput", kernel.throughput},
                            {"error", kernel.error},
                            {"rays", kernel.rays},
                            {"diffraction", part.texts.at("diffraction")}});
  }
  return json;
}

/// The irradiance of a kernel in grey.
petzval::Rgb8Image picture(const petzval::PsfKernel& kernel) {
  petzval::RgbImage image(kernel.pixels, kernel.pixels);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = kernel.light[i / 3];
  return expose(image).picture;
}

/// Fields by distances, at the wavelength nearest to the d line and the largest stop.
Sheet contact_sheet(const PsfJob& job, const std::vector<petzval::ExrPart>& parts) {
  const auto& axes = job.axes();
  const double nm =
      *std::ranges::min_element(axes.wavelengths_nm, {}, [](double a) { return std::abs(a - petzval::d_line_nm); });
  Sheet sheet{
      .title = "PSFs of " + job.description().at("lens").get<std::string>(),
      .rows = {},
      .notes = {"Field angle, and light: the film irradiance of a uniformly bright scene relative to the wide-open "
                "lens on the axis.",
                "Up is away from the centre of the photograph. Tiles of a row have the same film scale and their "
                "own exposure."}};
  for (const double distance : axes.distances_mm) {
    std::vector<std::pair<petzval::PsfSetPoint, petzval::PsfKernel>> row;
    for (std::size_t node = 0; node < parts.size(); ++node) {
      const petzval::PsfSetPoint point = axes.point(node);
      if (point.distance_mm == distance && point.wavelength_nm == nm && point.f_number == axes.f_numbers.front()) {
        row.push_back(petzval::from_exr_part(parts[node]));
      }
    }
    SheetRow shown{.title = std::isinf(distance) ? "a light at infinity" : "a light at " + number(distance) + " mm",
                   .subtitle = number(nm) + " nm, f/" + number(axes.f_numbers.front(), 3),
                   .tiles = {}};
    for (const auto& [point, kernel] : row) {
      shown.tiles.push_back({picture(kernel),
                             {number(point.field_deg) + "°", "light " + number(kernel.total, 3)},
                             kernel.pixels * kernel.pixel_mm});
    }
    sheet.rows.push_back(std::move(shown));
  }
  return sheet;
}

}  // namespace

std::string distance_from(const petzval::ExrPart& part) {
  const auto text = part.texts.find(distance_from_key);
  return text == part.texts.end() ? "front_vertex" : text->second;
}

PsfJob::PsfJob(Json description)
    : description_(std::move(description)),
      id_(petzval::checksum(description_.dump())),
      axes_{axis(description_, "fields_deg"), axis(description_, "distances_mm"), axis(description_, "wavelengths_nm"),
            axis(description_, "f_numbers")} {
  petzval::PsfSet::validate(axes_);
}

PsfJob PsfJob::read(const fs::path& folder) {
  const fs::path file = folder / job_file;
  if (!examples::exists(file))
    throw petzval::Error(folder.string() + ": has no " + job_file + "; must be a folder of petzval psf-set");
  try {
    return PsfJob(Json::parse(read_text(file)));
  } catch (const nlohmann::json::exception&) {
    throw petzval::Error(file.string() + ": not a valid job of petzval psf-set: the file has changed");
  }
}

std::string PsfJob::name(std::size_t node) const { return petzval::psf_part_name(axes_.point(node)); }

fs::path PsfJob::file(const fs::path& folder, std::size_t node) const {
  return folder / "psfs" / (name(node) + ".exr");
}

void PsfJob::begin(const fs::path& folder, const Shard& shard) const {
  if (examples::exists(folder / job_file)) {
    if (read(folder).description_ != description_) {
      throw petzval::Error((folder / job_file).string() +
                           ": describes another set; the folder must be empty or hold the same set");
    }
  } else {
    make_folder(folder / "psfs");
    write_text(folder / job_file, description_.dump(1) + '\n');
  }
  make_folder(folder / "psfs");
  Json names = Json::array();
  for (std::size_t node = 0; node < axes_.size(); ++node) {
    if (shard.has(node)) names.push_back(name(node));
  }
  write_text(folder / (shard.stem("shard") + ".json"),
             Json{{"shard", shard.text()}, {"psfs", std::move(names)}}.dump(1) + '\n');
}

void PsfJob::write(const fs::path& folder, std::size_t node, const petzval::PsfKernel& kernel) const {
  petzval::ExrPart part = petzval::to_exr_part(kernel, axes_.point(node));
  part.texts["lens"] = description_.at("lens").get<std::string>();
  part.texts["job"] = id_;
  part.texts[distance_from_key] = description_.at("distance_from").get<std::string>();
  petzval::write_exr({&part, 1}, file(folder, node));
}

petzval::ExrPart PsfJob::part(const fs::path& folder, std::size_t node) const {
  const fs::path own = file(folder, node);
  std::vector<petzval::ExrPart> parts = petzval::read_exr_parts(own);
  try {
    petzval::from_exr_part(parts.front());
  } catch (const petzval::Error& error) {
    throw petzval::Error(own.string() + ": " + error.what());
  }
  const auto job = parts.front().texts.find("job");
  if (parts.size() != 1 || parts.front().name != name(node) || job == parts.front().texts.end() || job->second != id_) {
    throw petzval::Error(own.string() + ": belongs to another set");
  }
  return std::move(parts.front());
}

std::vector<petzval::ExrPart> PsfJob::gather(const std::vector<fs::path>& folders) const {
  const std::optional<std::size_t> shards = shard_count(folders);
  const auto of_shard = [&](std::size_t node) {
    return shards ? "shard " + Shard{node % *shards + 1, *shards}.text() + ": " : std::string();
  };
  std::vector<petzval::ExrPart> parts;
  std::vector<std::string> faults;
  std::map<std::string, std::vector<std::string>> missing;  // by shard
  for (std::size_t node = 0; node < axes_.size(); ++node) {
    std::vector<std::string> corrupt;
    std::optional<petzval::ExrPart> found;
    fs::path found_folder;
    for (const fs::path& folder : folders) {
      if (!examples::exists(file(folder, node))) continue;
      try {
        petzval::ExrPart own = part(folder, node);
        if (!found) {
          found = std::move(own), found_folder = folder;
        } else if (found->texts != own.texts) {  // checksums
          faults.push_back(of_shard(node) + file(folder, node).string() + " and " + file(found_folder, node).string() +
                           " differ");
        }
      } catch (const petzval::Error& error) {
        corrupt.push_back(of_shard(node) + error.what());
      }
    }
    if (found) {  // an intact copy replaces a corrupt file
      parts.push_back(std::move(*found));
    } else if (corrupt.empty()) {
      missing[of_shard(node)].push_back(name(node));
    } else {
      faults.insert(faults.end(), corrupt.begin(), corrupt.end());
    }
  }
  constexpr std::size_t max_listed = 4;
  for (const auto& [shard, names] : missing) {
    std::string fault = shard + std::to_string(names.size()) + " missing: ";
    for (std::size_t i = 0; i < std::min(max_listed, names.size()); ++i) fault += (i > 0 ? ", " : "") + names[i];
    faults.push_back(fault + (names.size() > max_listed ? " and others" : ""));
  }
  if (faults.empty()) return parts;
  std::string all = "set of " + std::to_string(axes_.size()) + " PSFs";
  for (const std::string& fault : faults) all += "; " + fault;
  throw petzval::Error(all + "; all must be intact");
}

std::vector<fs::path> write_psf_set(const PsfJob& job, const std::vector<petzval::ExrPart>& parts, const fs::path& file,
                                    const std::optional<Json>& interpolation_error) {
  const auto sibling = [&](const char* extension) { return fs::path(file).replace_extension(extension); };
  Json json = index(job, parts, file);
  if (interpolation_error) json["interpolation_error"] = *interpolation_error;
  const std::string sheet = draw_sheet(contact_sheet(job, parts));
  petzval::write_exr(parts, file);
  write_text(sibling(".json"), json.dump(1) + '\n');
  write_text(sibling(".svg"), sheet);
  return {file, sibling(".json"), sibling(".svg")};
}

}  // namespace examples
