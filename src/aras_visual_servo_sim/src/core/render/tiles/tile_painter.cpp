#include "tile_painter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"

namespace aras_visual_servo_sim {
namespace {

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

constexpr int kSide = TileBins::kTile, kSquare = kSide * kSide;
constexpr float kFar = std::numeric_limits<float>::max();

/** Over the pixels' squares, of the distances to a triangle's edges: the least, the most, and the least to its rim. */
ARAS_WIDE void measureFlat(const TileTriangle& t, float* __restrict least, float* __restrict most,
                           float* __restrict rim) {
  float half[3], outer[3];
  for (int k = 0; k < 3; ++k) {
    half[k] = 0.5f * (std::abs(t.a[k]) + std::abs(t.b[k]));
    outer[k] = t.seam[k] ? kFar : -half[k];
  }
  for (int p = 0; p < kSquare; ++p) {
    const float x = p % kSide + 0.5f, y = p / kSide + 0.5f;  // NOLINT
    const float e0 = t.a[0] * x + t.b[0] * y + t.c[0], e1 = t.a[1] * x + t.b[1] * y + t.c[1],
                e2 = t.a[2] * x + t.b[2] * y + t.c[2];
    least[p] = std::min(std::min(e0 - half[0], e1 - half[1]), e2 - half[2]);
    most[p] = std::min(std::min(e0 + half[0], e1 + half[1]), e2 + half[2]);
    rim[p] = std::min(std::min(e0 + outer[0], e1 + outer[1]), e2 + outer[2]);
  }
}

/** The same through a lens, of pixels first <= p < last.
 *  @param rays  middle, across and down of all pixels, x, y and z */
ARAS_WIDE void measureBent(const TileTriangle& t, const float (*__restrict rays)[kSquare], int first, int last,
                           float* __restrict least, float* __restrict most, float* __restrict rim) {
  std::fill(least + first, least + last, kFar);
  std::fill(most + first, most + last, kFar);
  std::fill(rim + first, rim + last, kFar);
  for (int k = 0; k < 3; ++k) {
    const float x = t.edge[k][0], y = t.edge[k][1], z = t.edge[k][2], beyond = t.seam[k] ? kFar : 0.0f;
    for (int p = first; p < last; ++p) {
      const float e = x * rays[0][p] + y * rays[1][p] + z * rays[2][p];
      const float half = 0.5f * (std::abs(x * rays[3][p] + y * rays[4][p] + z * rays[5][p]) +
                                 std::abs(x * rays[6][p] + y * rays[7][p] + z * rays[8][p]));
      least[p] = std::min(least[p], e - half);
      most[p] = std::min(most[p], e + half);
      rim[p] = std::min(rim[p], std::max(e - half, beyond));
    }
  }
}

}  // namespace

void TilePainter::paint(const CameraModel& camera, const TriangleList& triangles, const CurvedList& curved,
                        const TileBins& bins, const Rgb& background, const AnyCanvas& canvas) {
  camera_ = &camera;
  list_ = &triangles;
  curved_list_ = &curved;
  bins_ = &bins;
  canvas_ = canvas;
  background_ = background;
  statistics_ = {};
  for (int tile = 0; tile < bins.tiles(); ++tile) {
    if (bins.mark(tile) == TileBins::Mark::kNone) continue;
    ++statistics_.tiles;
    paintTile(tile);
  }
}

void TilePainter::paintTile(int tile) {
  box_ = bins_->pixels(tile);
  if (!list_->isFlat()) cone_ = camera_->blockCones()[tile];
  keep_ = bins_->mark(tile) == TileBins::Mark::kBodies;
  candidates_.clear();
  for (const std::uint32_t* triangle = bins_->begin(tile); triangle != bins_->end(tile); ++triangle) {
    TileTriangle candidate;
    if (candidate.set(*list_, *triangle, camera_->nearM(), box_, cone_)) candidates_.push_back(candidate);
  }
  curved_.clear();
  const bool curved = tile < curved_list_->tiles() && curved_list_->begin(tile) != curved_list_->end(tile);
  if (!curved && paintFronts()) return;
  setUp();
  if (curved) addCurved(tile);
  const bool centers = camera_->sampling() == CameraModel::Sampling::kCenter;
  for (std::uint32_t k = 0; k < candidates_.size(); ++k) centers ? collectCenters(k) : collect(k);
  for (std::uint32_t k = 0; k < curved_.size(); ++k) {
    const auto index = static_cast<std::uint32_t>(candidates_.size()) + k;
    centers ? collectCurvedCenters(index) : collectCurved(index);
  }
  for (int v = box_.v0; v < box_.v1; ++v) {
    for (int u = box_.u0; u < box_.u1; ++u) paintPixel((v - box_.v0) * kTile + u - box_.u0);
  }
}

/** The short way for a tile whose pixels see what their middles see. @return false if it is none */
bool TilePainter::paintFronts() {
  if (!fronts_.find(*camera_, *list_, candidates_, box_, cone_)) return false;
  const std::vector<const Facet*>& facets = fronts_.facets();
  const auto planar = [](const Facet* facet) { return facet->planar; };
  if (keep_ && std::all_of(facets.begin(), facets.end(), planar)) return true;
  if (keep_ && std::any_of(facets.begin(), facets.end(), planar)) return false;
  return std::visit([&](const auto& canvas) { return paintFronts(canvas); }, canvas_);
}

template <typename Value>
bool TilePainter::paintFronts(const Canvas<Value>& canvas) {
  const std::vector<const Facet*>& facets = fronts_.facets();
  const auto all = [&facets](const auto& holds) { return std::all_of(facets.begin(), facets.end(), holds); };
  const int picture = facets[0]->picture;
  if (!all([picture](const Facet* facet) { return facet->picture == picture; })) return false;
  if (picture >= 0) {
    copyPicture((*canvas.pictures)[picture], *canvas.image);
    return true;
  }
  const Eigen::Vector3f& first = facets[0]->rgb[0];
  if (all([&first](const Facet* facet) { return facet->one_color && !facet->texture && facet->rgb[0] == first; })) {
    paintTileWith(first, box_, *canvas.image);
    return true;
  }
  if (!shade(*facets[0], colors_)) return false;
  for (std::size_t k = 1; k < facets.size(); ++k) {
    if (!shade(*facets[k], facet_colors_)) return false;
    colors_.take(facet_colors_, fronts_.facetOf(), static_cast<std::int32_t>(k));
  }
  colors_.write(box_, *canvas.image);
  return true;
}

/** @return false if the facet's texture has to be looked at pixel by pixel */
bool TilePainter::shade(const Facet& facet, TileColors& colors) {
  if (facet.texture && !texture_.look(*camera_, facet, box_)) return false;
  colors.shade(*camera_, facet, box_);
  if (facet.texture) colors.multiply(texture_.colors());
  return true;
}

template <typename Value>
void TilePainter::copyPicture(const ImageOf<Value>& picture, ImageOf<Value>& image) const {
  const std::size_t count = std::size_t(box_.u1 - box_.u0) * image.channels();
  for (int v = box_.v0; v < box_.v1; ++v) std::copy_n(picture.pixel(box_.u0, v), count, image.pixel(box_.u0, v));
}

void TilePainter::setUp() {
  fragments_.clear();
  first_.fill(-1);
  front_.fill(-1);
  floor_.fill(0.0f);
  front_nearest_.fill(0.0f);
  list_->isFlat() ? setUpFlat() : setUpBent();
}

void TilePainter::setUpFlat() {
  ahead_.fill(std::numeric_limits<float>::max());
  PixelRays rays = PixelRays::of(*camera_, box_.u0, box_.v0);
  Pixel pixel{{}, {float(rays.across[0]), 0.0f, 0.0f}, {0.0f, float(rays.down[1]), 0.0f}};
  pixel.middle[2] = 1.0f;
  double x[kTile];
  for (int u = box_.u0; u < box_.u1; ++u) x[u - box_.u0] = (u - camera_->cx()) / camera_->fx();
  for (int v = box_.v0; v < box_.v1; ++v) {
    rays.middle.y() = (v - camera_->cy()) / camera_->fy();
    pixel.middle[1] = static_cast<float>(rays.middle.y());
    int p = (v - box_.v0) * kTile;
    for (int u = box_.u0; u < box_.u1; ++u, ++p) {
      rays.middle.x() = x[u - box_.u0];
      pixel.middle[0] = static_cast<float>(rays.middle.x());
      rays_[p] = rays;
      pixels_[p] = pixel;
    }
  }
}

void TilePainter::setUpBent() {
  const bool fisheye = camera_->lens() == CameraModel::Lens::kEquidistant;
  for (int v = box_.v0; v < box_.v1; ++v) {
    for (int u = box_.u0; u < box_.u1; ++u) {
      const int p = (v - box_.v0) * kTile + u - box_.u0;
      Pixel& pixel = pixels_[p];
      rays_[p] = PixelRays::of(*camera_, u, v);
      for (int k = 0; k < 3; ++k) {
        pixel.middle[k] = static_cast<float>(rays_[p].middle[k]);
        pixel.across[k] = static_cast<float>(rays_[p].across[k]);
        pixel.down[k] = static_cast<float>(rays_[p].down[k]);
        across_tile_[k][p] = pixel.middle[k];
        across_tile_[3 + k][p] = pixel.across[k];
        across_tile_[6 + k][p] = pixel.down[k];
      }
      ahead_[p] = fisheye ? static_cast<float>(rays_[p].middle.cwiseAbs().maxCoeff()) : 1.0f;
    }
  }
}

/** Notes the pixels that a triangle may be seen in. */
void TilePainter::collect(std::uint32_t index) {
  const TileTriangle& t = candidates_[index];
  const PixelBox touched = touchedBy(t);
  measureEdges(t, touched);
  for (int v = touched.v0; v < touched.v1; ++v) {
    for (int u = touched.u0; u < touched.u1; ++u) {
      const int p = v * kTile + u;
      if (most_[p] < 0.0f) continue;
      const Pixel& pixel = pixels_[p];
      const float z = dot(t.plane, pixel.middle) + t.bias;
      const float reach = 0.5f * (std::abs(dot(t.plane, pixel.across)) + std::abs(dot(t.plane, pixel.down)));
      if (z + reach < floor_[p] || z - reach > ahead_[p]) continue;
      const bool cut = z + reach > ahead_[p];  // by the near plane
      if (least_[p] > 0.0f && z - reach > floor_[p] && !cut) {
        putInFront(p, index, z - reach, z + reach);
        continue;
      }
      fragments_.push_back({index, first_[p], z + reach, rim_[p] > 0.0f && !cut});
      first_[p] = static_cast<int>(fragments_.size()) - 1;
    }
  }
}

/** The pixels of the tile, counted from its corner, that a triangle may touch. */
PixelBox TilePainter::touchedBy(const TileTriangle& t) const {
  const int width = box_.u1 - box_.u0, height = box_.v1 - box_.v0;
  if (list_->isFlat()) return {0, 0, width, height};
  const TriangleList::Extent& extent = list_->extent(t.triangle);
  return {std::clamp(extent.left - box_.u0, 0, width), std::clamp(extent.top - box_.v0, 0, height),
          std::clamp(extent.right - box_.u0, 0, width), std::clamp(extent.bottom - box_.v0, 0, height)};
}

/** Sets least_, most_ and rim_ of these pixels at least: over each one's square, of the distances to the edges, in any
 *  unit. */
void TilePainter::measureEdges(const TileTriangle& t, const PixelBox& pixels) {
  list_->isFlat()
      ? measureFlat(t, least_.data(), most_.data(), rim_.data())
      : measureBent(t, across_tile_, pixels.v0 * kTile, pixels.v1 * kTile, least_.data(), most_.data(), rim_.data());
}

/** Whether the middle of a pixel lies inside a triangle. */
bool TilePainter::isInside(const TileTriangle& t, int p) const {
  const float x = p % kTile + 0.5f, y = p / kTile + 0.5f;  // NOLINT
  for (int k = 0; k < 3; ++k) {
    const float e = list_->isFlat() ? t.a[k] * x + t.b[k] * y + t.c[k] : dot(t.edge[k], pixels_[p].middle);
    if (!(e >= t.least[k])) return false;
  }
  return true;
}

/** A triangle about the middle of a pixel. */
PixelSamples::Triangle TilePainter::about(const TileTriangle& t, int p) const {
  const Pixel& pixel = pixels_[p];
  PixelSamples::Triangle triangle{t.a,
                                  t.b,
                                  {},
                                  t.least,
                                  dot(t.plane, pixel.middle) + t.bias,
                                  dot(t.plane, pixel.across),
                                  dot(t.plane, pixel.down),
                                  ahead_[p]};
  const float x = p % kTile + 0.5f, y = p / kTile + 0.5f;  // NOLINT
  for (int i = 0; i < 3; ++i) {
    if (list_->isFlat()) {
      triangle.c[i] = t.a[i] * x + t.b[i] * y + t.c[i];
      continue;
    }
    triangle.a[i] = dot(t.edge[i], pixel.across);
    triangle.b[i] = dot(t.edge[i], pixel.down);
    triangle.c[i] = dot(t.edge[i], pixel.middle);
  }
  return triangle;
}

/** Makes a candidate that covers a pixel the one in front there. */
void TilePainter::putInFront(int p, std::uint32_t index, float farthest, float nearest) {
  if (front_[p] >= 0 && front_nearest_[p] >= farthest) {
    const bool smooth = !isCurved(static_cast<std::uint32_t>(front_[p]));
    fragments_.push_back({std::uint32_t(front_[p]), first_[p], front_nearest_[p], smooth});
    first_[p] = static_cast<int>(fragments_.size()) - 1;
  }
  front_[p] = static_cast<int>(index);
  floor_[p] = farthest;
  front_nearest_[p] = nearest;
}

void TilePainter::addCurved(int tile) {
  for (const std::uint32_t* entry = curved_list_->begin(tile); entry != curved_list_->end(tile); ++entry) {
    TileCurved candidate;
    if (candidate.set(*camera_, curved_list_->entries()[*entry].patch, *entry, box_, rays_.data())) {
      curved_.push_back(candidate);
    }
  }
}

void TilePainter::collectCurved(std::uint32_t index) {
  const TileCurved& curved = curvedOf(index);
  for (int p = 0; p < kPixels; ++p) {
    if (curved.cover[p] == TileCurved::Cover::kNone || curved.nearest[p] < floor_[p]) continue;
    if (curved.cover[p] == TileCurved::Cover::kWhole && curved.farthest[p] > floor_[p]) {
      putInFront(p, index, curved.farthest[p], curved.nearest[p]);
      continue;
    }
    fragments_.push_back({index, first_[p], curved.nearest[p], false});
    first_[p] = static_cast<int>(fragments_.size()) - 1;
  }
}

void TilePainter::collectCurvedCenters(std::uint32_t index) {
  const CurvedPatch& patch = patchOf(curvedOf(index));
  for (int v = 0; v < box_.v1 - box_.v0; ++v) {
    for (int u = 0; u < box_.u1 - box_.u0; ++u) {
      const int p = v * kTile + u;
      const double z = camera_->nearM() * nearnessAt(*camera_, patch, rays_[p].middle);
      if (!(z > floor_[p])) continue;
      floor_[p] = static_cast<float>(z);
      front_[p] = static_cast<int>(index);
    }
  }
}

/** All or nothing, by the middle of the pixel. */
void TilePainter::collectCenters(std::uint32_t index) {
  const TileTriangle& t = candidates_[index];
  for (int v = 0; v < box_.v1 - box_.v0; ++v) {
    for (int u = 0; u < box_.u1 - box_.u0; ++u) {
      const int p = v * kTile + u;
      if (!isInside(t, p)) continue;
      const float z = dot(t.plane, pixels_[p].middle) + t.bias;
      if (z <= floor_[p] || z > ahead_[p]) continue;
      floor_[p] = z;
      front_[p] = static_cast<int>(index);
    }
  }
}

void TilePainter::paintPixel(int p) {
  seen_.clear();
  const auto isBody = [this](std::uint32_t k) { return isCurved(k) || !list_->facet(candidates_[k].triangle).planar; };
  int front = front_[p];
  bool any_body = front >= 0 && isBody(front), smooth = true;
  for (int k = first_[p]; k >= 0; k = fragments_[k].next) {
    if (fragments_[k].nearest < floor_[p]) continue;
    seen_.push_back(fragments_[k].candidate);
    any_body = any_body || isBody(fragments_[k].candidate);
    smooth = smooth && fragments_[k].smooth;
  }
  if (keep_ && !any_body) return;
  double rgb[3] = {double(background_.r), double(background_.g), double(background_.b)};
  if (!seen_.empty()) front = smooth ? smoothFront(p) : -1;
  if (front >= 0) {
    Eigen::Map<Eigen::Vector3d>{rgb} = colorOf(static_cast<std::uint32_t>(front), p, {PixelSamples::kCount, 0.0, 0.0});
  } else if (!seen_.empty()) {
    ++statistics_.sampled_pixels;
    samplePixel(p, rgb);
  }
  std::visit([&](const auto& canvas) { put(rgb, p, *canvas.image); }, canvas_);
}

template <typename Value>
void TilePainter::put(const double* rgb, int p, ImageOf<Value>& image) const {
  const auto values = pixelOf<Value>(rgb[0], rgb[1], rgb[2], image.encoding);
  std::copy_n(values.begin(), image.channels(), image.pixel(box_.u0 + p % kTile, box_.v0 + p / kTile));
}

/** Which of the candidates seen_, none of which ends in the pixel, its middle sees; -1 unless they are one surface of
 *  about one colour, front_ is of it too or behind it. */
int TilePainter::smoothFront(int p) const {
  const TileTriangle& first = candidates_[seen_.front()];
  const Eigen::Vector3f& color = list_->facet(first.triangle).rgb[0];
  int front = -1;
  float nearest = 0.0f;
  const auto behind = static_cast<std::uint32_t>(front_[p]);
  const bool alone = front_[p] < 0 || (!isCurved(behind) && candidates_[behind].surface == first.surface);
  const auto look = [&](std::uint32_t index) {
    const TileTriangle& t = candidates_[index];
    const float z = dot(t.plane, pixels_[p].middle) + t.bias;
    const float reach = 0.5f * (std::abs(dot(t.plane, pixels_[p].across)) + std::abs(dot(t.plane, pixels_[p].down)));
    if (!alone && z - reach <= front_nearest_[p]) return false;
    const Eigen::Vector3f& other = list_->facet(t.triangle).rgb[0];
    if (t.surface != first.surface || (other - color).cwiseAbs().maxCoeff() > kCrease) return false;
    if (isInside(t, p) && z > nearest) {
      front = static_cast<int>(index);
      nearest = z;
    }
    return true;
  };
  for (const std::uint32_t index : seen_) {
    if (!look(index)) return -1;
  }
  return front_[p] < 0 || !alone || look(behind) ? front : -1;
}

/** The mean of the colours of the candidates seen_ and front_, and of the background in rgb, each where it is seen. */
void TilePainter::samplePixel(int p, double* rgb) {
  if (front_[p] >= 0) seen_.push_back(static_cast<std::uint32_t>(front_[p]));
  const auto nothing = static_cast<std::int32_t>(seen_.size());
  samples_.clear(nothing);
  for (std::int32_t k = nothing - 1; k >= 0; --k) {
    if (isCurved(seen_[k])) {
      samples_.see(samplesOf(*camera_, patchOf(curvedOf(seen_[k])), rays_[p]), k);
      continue;
    }
    samples_.see(about(candidates_[seen_[k]], p), k);
  }
  Eigen::Map<Eigen::Vector3d> color(rgb);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int left = PixelSamples::kCount;
  for (std::int32_t k = nothing - 1; k >= 0 && left > 0; --k) {
    const PixelSamples::Share share = samples_.shareOf(k);
    if (share.count == 0) continue;
    left -= share.count;
    sum += share.count * colorOf(seen_[k], p, share);
  }
  color = (sum + left * color) / PixelSamples::kCount;
}

/** Of the part of a pixel that sees a candidate. */
Eigen::Vector3d TilePainter::colorOf(std::uint32_t index, int p, const PixelSamples::Share& share) {
  if (isCurved(index)) return colorOf(patchOf(curvedOf(index)), p, share);
  const TileTriangle& candidate = candidates_[index];
  const Facet& facet = list_->facet(candidate.triangle);
  if (facet.picture < 0) {
    const Eigen::Vector3d color = facet.color(rays_[p].at(share.x, share.y));
    return facet.texture ? Eigen::Vector3d(color.cwiseProduct(textureOf(candidate, p, share)) / 255.0) : color;
  }
  return std::visit([&](const auto& canvas) { return seenOf((*canvas.pictures)[facet.picture], p); }, canvas_);
}

template <typename Value>
Eigen::Vector3d TilePainter::seenOf(const ImageOf<Value>& picture, int p) const {
  const Value* seen = picture.pixel(box_.u0 + p % kTile, box_.v0 + p / kTile);
  const bool grey = picture.channels() == 1, bgr = picture.encoding == Encoding::kBgr8;
  return Eigen::Vector3d(seen[grey || !bgr ? 0 : 2], seen[grey ? 0 : 1], seen[grey || bgr ? 0 : 2]) / kUnitsOf<Value>;
}

/** Mean of the texels over the part of the pixel's square that lies in the triangle, hidden or not. */
Eigen::Vector3d TilePainter::textureOf(const TileTriangle& t, int p, const PixelSamples::Share& share) {
  const Facet& facet = list_->facet(t.triangle);
  const PixelRays& rays = rays_[p];
  Eigen::Vector2d middle;
  if (!facet.texel(rays.at(share.x, share.y), middle)) middle = facet.texels[0];
  if (camera_->sampling() == CameraModel::Sampling::kCenter) return TextureArea::at(*facet.texture, middle);
  outline_ = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  if (share.count < PixelSamples::kCount) {
    const PixelSamples::Triangle here = about(t, p);
    for (int k = 0; k < 3 && !outline_.empty(); ++k) {
      texture_area_.clip(outline_, {here.a[k], here.b[k]}, -here.c[k]);
    }
  }
  for (Eigen::Vector2d& point : outline_) {
    if (!facet.texel(rays.at(point.x(), point.y()), point)) return TextureArea::at(*facet.texture, middle);
  }
  return outline_.size() < 3 ? TextureArea::at(*facet.texture, middle) : texture_area_.mean(*facet.texture, outline_);
}

Eigen::Vector3d TilePainter::colorOf(const CurvedPatch& patch, int p, const PixelSamples::Share& share) {
  const Eigen::Vector3d color = patch.color(rays_[p].at(share.x, share.y));
  return patch.texture ? Eigen::Vector3d(color.cwiseProduct(textureOf(patch, p, share)) / 255.0) : color;
}

/** Mean of the texels over a pixel that lies on the patch; at its outline and at the poles of a sphere, of the texels
 *  that the pixel's samples see. */
Eigen::Vector3d TilePainter::textureOf(const CurvedPatch& patch, int p, const PixelSamples::Share& share) {
  const PixelRays& rays = rays_[p];
  const Eigen::Vector2d middle = patch.texel(rays.at(share.x, share.y));
  if (camera_->sampling() == CameraModel::Sampling::kCenter) return TextureArea::at(*patch.texture, middle);
  const double width = patch.texture->texture->width();
  bool whole = share.count == PixelSamples::kCount;
  outline_ = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  for (Eigen::Vector2d& point : outline_) {
    const Eigen::Vector3d ray = rays.at(point.x(), point.y());
    point = patch.texel(ray);
    if (patch.part != CurvedPatch::Part::kDisc) {  // once round, counted on from the middle
      point.x() -= width * std::round((point.x() - middle.x()) / width);
    }
    whole = whole && patch.hit(ray).within >= 0.0 && std::abs(point.x() - middle.x()) < 0.2 * width;
  }
  if (whole) return texture_area_.mean(*patch.texture, outline_);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (int k = 0; k < PixelSamples::kCount; ++k) {
    const Eigen::Vector2d at = PixelSamples::place(k);
    const Eigen::Vector3d ray = rays.at(at.x(), at.y());
    const CurvedPatch::Hit hit = patch.hit(ray);
    if (hit.within < 0.0 || !patch.isWithinBounds(ray, hit.nearness)) continue;
    sum += TextureArea::at(*patch.texture, patch.texel(ray));
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : TextureArea::at(*patch.texture, middle);
}

}  // namespace aras_visual_servo_sim
