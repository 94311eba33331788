// SPDX-License-Identifier: Apache-2.0
#include "image/exr.hpp"

#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <string>

#include "image/exr_head.hpp"
#include "image/file_capacity.hpp"
#include "petzval/core/error.hpp"
#include "petzval/core/files.hpp"

namespace petzval {
namespace {

// 3 GiB in memory. The limit is needed because a damaged header may state any size.
constexpr std::uint64_t most_values = std::uint64_t(3) << 28;

/// Attributes that OpenEXR writes to every file.
constexpr std::array<std::string_view, 7> common_attributes{
    "chunkCount", "name", "pixelAspectRatio", "screenWindowCenter", "screenWindowWidth", "type", "version"};
/// Standard attributes of lenses with type float.
constexpr std::array<std::string_view, 7> standard_floats{"aperture", "effectiveFocalLength", "entrancePupilOffset",
                                                          "focus",    "nominalFocalLength",   "pinholeFocalLength",
                                                          "tStop"};

bool is_among(std::span<const std::string_view> names, std::string_view name) noexcept {
  return std::find(names.begin(), names.end(), name) != names.end();
}
bool in_every_file(std::string_view name) noexcept { return is_among(common_attributes, name); }

std::string size_of(const ExrPart& part) { return std::to_string(part.width) + " x " + std::to_string(part.height); }

void validate(const ExrPart& part) {
  const std::string where = "part \"" + part.name + "\": ";
  if (part.width < 1 || part.height < 1) throw Error(where + "size = " + size_of(part) + "; must be at least 1 x 1");
  if (part.margin_x < 0 || part.margin_y < 0 || 2 * part.margin_x >= part.width || 2 * part.margin_y >= part.height) {
    throw Error(where + "margins = " + std::to_string(part.margin_x) + " and " + std::to_string(part.margin_y) +
                " pixels; must be 0 or more, and less than half of " + size_of(part));
  }
  if (part.channels.empty()) throw Error(where + "no channel; must be at least one");
  for (const auto& [name, values] : part.channels) {
    if (name.empty()) throw Error(where + "a channel has no name; must not be empty");
    if (values.size() != static_cast<std::size_t>(part.width) * static_cast<std::size_t>(part.height)) {
      throw Error(where + "channel " + name + ": values = " + std::to_string(values.size()) +
                  "; must be one for each of " + size_of(part) + " pixels");
    }
  }
  for (const auto& [name, text] : part.texts) {
    if (part.numbers.contains(name))
      throw Error(where + "attribute " + name + " is a text and a number; must be unique");
  }
  for (const auto& [name, pair] : part.pairs) {
    if (part.texts.contains(name) || part.numbers.contains(name)) {
      throw Error(where + "attribute " + name + " is a pair and a text or number; must be unique");
    }
  }
}

void validate(std::span<const ExrPart> parts) {
  if (parts.empty()) throw Error("no part; must be at least one");
  std::set<std::string_view> names;
  for (const ExrPart& part : parts) {
    validate(part);
    if (parts.size() == 1) break;
    if (part.name.empty()) throw Error("one of several parts has no name; must not be empty");
    if (!names.insert(part.name).second) throw Error("part \"" + part.name + "\" is a duplicate; must be unique");
  }
}

/// Inserts an attribute. Refuses reserved names: OpenEXR would overwrite their values, or fail with a message without
/// the name.
template <class Attribute, class Value>
void insert(Imf::Header& header, const std::string& name, const Value& value) {
  if (in_every_file(name) || header.find(name) != header.end()) {
    throw Error("attribute " + name + " is reserved by EXR; must have another name");
  }
  header.insert(name, Attribute(value));
}

Imf::Header header_of(const ExrPart& part, const Imath::Box2i& display) {
  const Imath::V2i first{-part.margin_x, -part.margin_y};
  Imf::Header header(display, {first, first + Imath::V2i(part.width - 1, part.height - 1)});
  header.setType(Imf::SCANLINEIMAGE);
  const Imf::Channel type(part.half ? Imf::HALF : Imf::FLOAT);
  for (const auto& [name, values] : part.channels) header.channels().insert(name, type);
  for (const auto& [name, text] : part.texts) insert<Imf::StringAttribute>(header, name, text);
  for (const auto& [name, number] : part.numbers) {
    if (is_among(standard_floats, name)) {
      insert<Imf::FloatAttribute>(header, name, static_cast<float>(number));
    } else {
      insert<Imf::DoubleAttribute>(header, name, number);
    }
  }
  for (const auto& [name, pair] : part.pairs) insert<Imf::V2fAttribute>(header, name, Imath::V2f(pair.x, pair.y));
  if (!part.name.empty()) header.setName(part.name);
  return header;
}

/// The frame buffer of the channels. The first pixel is the upper left corner of the data window.
Imf::FrameBuffer frame(const ExrPart& part, const Imath::Box2i& window) {
  Imf::FrameBuffer buffer;
  const auto width = static_cast<std::size_t>(part.width);
  for (const auto& [name, values] : part.channels) {
    // A frame buffer needs mutable pixels; writing does not change the pixels.
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, const_cast<float*>(values.data()), window.min, part.width,
                                         part.height, sizeof(float), sizeof(float) * width));
  }
  return buffer;
}

template <class T>
const T* number(const Imf::Attribute& attribute) {
  const auto* typed = dynamic_cast<const Imf::TypedAttribute<T>*>(&attribute);
  return typed ? &typed->value() : nullptr;
}

void read_attributes(const Imf::Header& header, ExrPart& part) {
  if (header.hasName()) part.name = header.name();
  for (auto i = header.begin(); i != header.end(); ++i) {
    if (in_every_file(i.name())) continue;
    const Imf::Attribute& attribute = i.attribute();
    if (const auto* text = number<std::string>(attribute)) part.texts[i.name()] = *text;
    if (const auto* value = number<double>(attribute)) part.numbers[i.name()] = *value;
    if (const auto* value = number<float>(attribute)) part.numbers[i.name()] = static_cast<double>(*value);
    if (const auto* value = number<int>(attribute)) part.numbers[i.name()] = *value;
    if (const auto* value = number<Imath::V2f>(attribute)) part.pairs[i.name()] = {value->x, value->y};
  }
}

/// The largest number of values per byte of a file: twice the number for black images with 100,000 columns, 511 with
/// deflate and 8566 with DWA.
std::uint64_t most_in_a_byte(Imf::Compression compression) noexcept {
  return compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION ? 1 << 14 : 1 << 10;
}

/// An EXR file, part by part.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file, ExrWindow window = ExrWindow::data)
      : path_(file), file_(file.string().c_str(), 0), window_(window) {}

  int parts() const { return file_.parts(); }

  /// Reads a part with the given channels; all channels if none are given.
  ExrPart part(int index, std::span<const std::string_view> channel_names = {}) {
    const Imf::Header& header = file_.header(index);
    ExrPart part;
    read_attributes(header, part);
    for (const std::string_view name : channel_names) part.channels[std::string(name)];
    if (channel_names.empty()) {
      for (auto i = header.channels().begin(); i != header.channels().end(); ++i) part.channels[i.name()];
    }
    for (const auto& [missing, values] : part.channels) {
      if (header.channels().findChannel(missing)) continue;
      std::string all;
      for (const std::string_view name : channel_names) all += (all.empty() ? "" : ", ") + std::string(name);
      throw Error("no channel " + missing + "; must have " + all);
    }

    const Imath::Box2i window = header.dataWindow(), &display = header.displayWindow();
    const std::size_t pixels_read = size_part(part, window, most_in_a_byte(header.compression()));
    for (auto& [name, values] : part.channels) values.resize(pixels_read);
    const Imath::V2i before = display.min - window.min, after = window.max - display.max;
    if (before == after && before.x >= 0 && before.y >= 0) part.margin_x = before.x, part.margin_y = before.y;
    Imf::InputPart in(file_, index);
    in.setFrameBuffer(frame(part, window));
    in.readPixels(window.min.y, window.max.y);
    if (window_ == ExrWindow::data || display == window) return part;

    const int read_width = part.width;
    part.margin_x = part.margin_y = 0;
    const std::size_t pixels = size_part(part, display, 1 << 14);
    const Imath::V2i low = {std::max(display.min.x, window.min.x), std::max(display.min.y, window.min.y)},
                     high = {std::min(display.max.x, window.max.x), std::min(display.max.y, window.max.y)};
    const auto at = [&](const Imath::Box2i& box, int width, int y) {
      return std::ptrdiff_t{y - box.min.y} * width + low.x - box.min.x;
    };
    for (auto& [name, values] : part.channels) {
      std::vector<float> shown(pixels);
      for (int y = low.y; low.x <= high.x && y <= high.y; ++y) {
        std::copy_n(values.begin() + at(window, read_width, y), high.x - low.x + 1,
                    shown.begin() + at(display, part.width, y));
      }
      values = std::move(shown);
    }
    return part;
  }

 private:
  /// Sets the size of a part to a window, and returns the number of pixels.
  std::size_t size_part(ExrPart& part, const Imath::Box2i& window, std::uint64_t values_in_a_byte) {
    const auto width = std::uint64_t(std::int64_t(window.max.x) - window.min.x + 1);
    const auto height = std::uint64_t(std::int64_t(window.max.y) - window.min.y + 1);
    // In this order no product overflows, because sides are below 2^32.
    if (width * height > left_ || width * height * part.channels.size() > left_) {
      throw Error("part \"" + part.name + "\": size = " + std::to_string(width) + " x " + std::to_string(height) +
                  " with " + std::to_string(part.channels.size()) + " channels; must be at most " +
                  std::to_string(most_values) + " values in all parts");
    }
    const std::uint64_t values = width * height * part.channels.size();
    if (!image_detail::fits_in_file(values, values_in_a_byte, path_)) {
      throw Error("part \"" + part.name + "\": values = " + std::to_string(values) +
                  "; must not exceed the size of the file");
    }
    left_ -= values;
    part.width = static_cast<int>(width), part.height = static_cast<int>(height);
    return static_cast<std::size_t>(width * height);
  }

  std::filesystem::path path_;
  Imf::MultiPartInputFile file_;
  ExrWindow window_;
  std::uint64_t left_ = most_values;  ///< remaining values
};

}  // namespace

void write_exr(std::span<const ExrPart> parts, const std::filesystem::path& file) {
  Imf::StdOSStream stream;
  try {
    validate(parts);
    Imath::Box2i display{{0, 0}, {0, 0}};
    for (const ExrPart& part : parts) {
      display.extendBy(Imath::V2i(part.width - 2 * part.margin_x - 1, part.height - 2 * part.margin_y - 1));
    }
    std::vector<Imf::Header> headers;
    for (const ExrPart& part : parts) headers.push_back(header_of(part, display));
    Imf::MultiPartOutputFile out(stream, headers.data(), static_cast<int>(headers.size()), false, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const ExrPart& part = parts[i];
      Imf::OutputPart out_part(out, static_cast<int>(i));
      Imf::FrameBuffer buffer = frame(part, headers[i].dataWindow());
      std::vector<std::vector<half>> halves;
      if (part.half) {
        const auto width = static_cast<std::size_t>(part.width);
        for (const auto& [name, values] : part.channels) {
          halves.emplace_back(values.begin(), values.end());
          buffer.insert(name, Imf::Slice::Make(Imf::HALF, halves.back().data(), headers[i].dataWindow().min, part.width,
                                               part.height, sizeof(half), sizeof(half) * width));
        }
      }
      out_part.setFrameBuffer(buffer);
      out_part.writePixels(part.height);
    }
  } catch (const std::exception& e) {
    throw Error(file.string() + ": " + e.what());
  }
  write_file(stream.str(), file);
}

std::vector<ExrPart> read_exr_parts(const std::filesystem::path& file, ExrWindow window) {
  return image_detail::read_exr_file(file, [&] {
    Reader reader(file, window);
    std::vector<ExrPart> parts;
    for (int i = 0; i < reader.parts(); ++i) parts.push_back(reader.part(i));
    return parts;
  });
}

ExrPart image_detail::read_first_part(const std::filesystem::path& file, std::span<const std::string_view> channels) {
  return read_exr_file(file, [&] { return Reader(file).part(0, channels); });
}

}  // namespace petzval
