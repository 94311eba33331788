// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "font.hpp"
#include "petzval/image/image.hpp"

namespace examples {

/// A picture of one colour.
petzval::Rgb8Image blank(int width, int height, const Colour& colour);

/// Fills a rectangle, clipped to the picture.
void fill(petzval::Rgb8Image& picture, int x, int y, int width, int height, const Colour& colour);

/// Draws a disc with a smooth edge, clipped to the picture.
void disc(petzval::Rgb8Image& picture, double x, double y, double radius, const Colour& colour);

/// Copies a tile with its upper left corner to (x, y). The tile must fit.
void place(petzval::Rgb8Image& picture, int x, int y, const petzval::Rgb8Image& tile);

}  // namespace examples
