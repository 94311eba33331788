// SPDX-License-Identifier: Apache-2.0
#include "font.hpp"

#include <fontconfig/fontconfig.h>
#include <ft2build.h>

#include <cmath>
#include <string>
#include FT_FREETYPE_H

#include "petzval/core/error.hpp"

namespace examples {
namespace {

/// Path of the system's font file for "sans"; empty if Fontconfig finds no font.
std::string sans_file() {
  const std::unique_ptr<FcPattern, void (*)(FcPattern*)> pattern(FcPatternCreate(), FcPatternDestroy);
  FcPatternAddString(pattern.get(), FC_FAMILY, reinterpret_cast<const FcChar8*>("sans"));
  FcPatternAddBool(pattern.get(), FC_SCALABLE, FcTrue);
  FcConfigSubstitute(nullptr, pattern.get(), FcMatchPattern);
  FcDefaultSubstitute(pattern.get());
  FcResult result = FcResultNoMatch;
  const std::unique_ptr<FcPattern, void (*)(FcPattern*)> found(FcFontMatch(nullptr, pattern.get(), &result),
                                                               FcPatternDestroy);
  FcChar8* file = nullptr;
  if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch) return {};
  return reinterpret_cast<const char*>(file);
}

/// Removes one character from a UTF-8 text. An invalid byte counts as a question mark.
FcChar32 next_character(std::string_view& text) {
  FcChar32 character = '?';
  const int length =
      FcUtf8ToUcs4(reinterpret_cast<const FcChar8*>(text.data()), &character, static_cast<int>(text.size()));
  text.remove_prefix(length > 0 ? static_cast<std::size_t>(length) : 1);
  return length > 0 ? character : '?';
}

}  // namespace

struct Font::Face {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  ~Face() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }

  /// Calls `use(glyph, x)` for each rendered character. Returns the final pen position.
  template <class Use>
  int each_glyph(std::string_view text, int pixel_size, Use&& use) {
    FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(pixel_size));
    FT_Pos pen = 0;  // 1/64 pixel
    while (!text.empty()) {
      if (FT_Load_Char(face, next_character(text), FT_LOAD_RENDER | FT_LOAD_NO_HINTING) != 0) continue;
      use(*face->glyph, static_cast<int>((pen + 32) / 64));
      pen += face->glyph->advance.x;
    }
    return static_cast<int>((pen + 63) / 64);
  }
};

Font::Font() : face_(std::make_unique<Face>()) {
  const std::string file = sans_file();
  if (file.empty() || FT_Init_FreeType(&face_->library) != 0 ||
      FT_New_Face(face_->library, file.c_str(), 0, &face_->face) != 0) {
    throw petzval::Error("captions: no usable font" + (file.empty() ? "" : " in " + file) +
                         "; Fontconfig must name a font for \"sans\" (such as fonts-dejavu-core)");
  }
}

Font::~Font() = default;

int Font::width(std::string_view text, int pixel_size) {
  return face_->each_glyph(text, pixel_size, [](const FT_GlyphSlotRec&, int) {});
}

void Font::draw(petzval::Rgb8Image& picture, int x, int y, int pixel_size, std::string_view text,
                const Colour& colour) {
  face_->each_glyph(text, pixel_size, [&](const FT_GlyphSlotRec& glyph, int pen) {
    const FT_Bitmap& bitmap = glyph.bitmap;
    for (int row = 0; row < static_cast<int>(bitmap.rows); ++row) {
      for (int column = 0; column < static_cast<int>(bitmap.width); ++column) {
        const int px = x + pen + glyph.bitmap_left + column, py = y - glyph.bitmap_top + row;
        if (px < 0 || py < 0 || px >= picture.width || py >= picture.height) continue;
        const int coverage = bitmap.buffer[row * bitmap.pitch + column];
        std::uint8_t* pixel = &picture.pixels[(static_cast<std::size_t>(py) * static_cast<std::size_t>(picture.width) +
                                               static_cast<std::size_t>(px)) *
                                              3];
        for (std::size_t c = 0; c < 3; ++c) {
          pixel[c] = static_cast<std::uint8_t>((pixel[c] * (255 - coverage) + colour[c] * coverage + 127) / 255);
        }
      }
    }
  });
}

}  // namespace examples
