#include "tile_painter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/image/pixel_color.hpp"

namespace aras_visual_servo_sim {

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
  fragments_.clear();
  first_.fill(-1);
  front_.fill(-1);
  floor_.fill(0.0f);
  front_nearest_.fill(0.0f);
  list_->isFlat() ? setUpFlat() : setUpBent();
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
    const ImageOf<Value>& seen = (*canvas.pictures)[picture];
    const std::size_t count = std::size_t(box_.u1 - box_.u0) * seen.channels();
    for (int v = box_.v0; v < box_.v1; ++v) std::copy_n(seen.pixel(box_.u0, v), count, canvas.image->pixel(box_.u0, v));
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

void TilePainter::setUpFlat() {
  ahead_.fill(std::numeric_limits<float>::max());
  PixelRays rays = PixelRays::of(*camera_, box_.u0, box_.v0);
  double x[kTile];
  for (int u = box_.u0; u < box_.u1; ++u) x[u - box_.u0] = (u - camera_->cx()) / camera_->fx();
  for (int v = box_.v0; v < box_.v1; ++v) {
    rays.middle.y() = (v - camera_->cy()) / camera_->fy();
    int p = (v - box_.v0) * kTile;
    for (int u = box_.u0; u < box_.u1; ++u, ++p) {
      rays.middle.x() = x[u - box_.u0];
      rays_[p] = rays;
      rounded_.set(p, rays);
    }
  }
}

void TilePainter::setUpBent() {
  for (int v = box_.v0; v < box_.v1; ++v) {
    for (int u = box_.u0; u < box_.u1; ++u) {
      const int p = (v - box_.v0) * kTile + u - box_.u0;
      rays_[p] = PixelRays::of(*camera_, u, v);
      rounded_.set(p, rays_[p]);
      ahead_[p] = static_cast<float>(aheadOf(*camera_, rays_[p].middle));
    }
  }
}

/** Notes the pixels that a triangle may be seen in. */
void TilePainter::collect(std::uint32_t index) {
  const TileTriangle& t = candidates_[index];
  const PixelBox touched = touchedBy(t);
  sight_.look(t, list_->isFlat(), rounded_, floor_.data(), ahead_.data(), touched.v0, touched.v1);
  std::int32_t ends = TileSight::kCut;
  for (int k = 0; k < 3; ++k) ends |= t.seam[k] ? 0 : 1 << k;
  for (int v = touched.v0; v < touched.v1; ++v) {
    for (int u = touched.u0; u < touched.u1; ++u) {
      const int p = v * kTile + u;
      const std::int32_t sight = sight_.of(p);
      if ((sight & TileSight::kNothing) != 0) continue;
      if (sight == 0 && sight_.farthest(p) > floor_[p]) {
        putInFront(p, index, sight_.farthest(p), sight_.nearest(p));
        continue;
      }
      addFragment(p, index, sight_.nearest(p), (sight & ends) == 0, sight);
    }
  }
}

/** The pixels of the tile, counted from its corner, that a triangle may touch. */
PixelBox TilePainter::touchedBy(const TileTriangle& t) const {
  const int width = box_.u1 - box_.u0, height = box_.v1 - box_.v0;
  if (list_->isFlat()) return {0, 0, width, height};
  const PixelBox& extent = list_->extent(t.triangle);
  return PixelBox{extent.u0 - box_.u0, extent.v0 - box_.v0, extent.u1 - box_.u0, extent.v1 - box_.v0}.within(
      {0, 0, width, height});
}

/** Whether the middle of a pixel lies inside a triangle. */
bool TilePainter::isInside(const TileTriangle& t, int p) const {
  const float x = p % kTile + 0.5f, y = p / kTile + 0.5f;  // NOLINT
  for (int k = 0; k < 3; ++k) {
    const float e = list_->isFlat() ? t.a[k] * x + t.b[k] * y + t.c[k] : rounded_.middle(t.edge[k], p);
    if (!(e >= t.least[k])) return false;
  }
  return true;
}

/** A triangle about the middle of a pixel, with the edges that cross it. @param sight  bits of TileSight */
PixelSamples::Triangle TilePainter::about(const TileTriangle& t, int p, std::int32_t sight) const {
  PixelSamples::Triangle triangle;
  triangle.edges = 0;
  triangle.z = rounded_.middle(t.plane, p) + t.bias;
  triangle.z_x = rounded_.across(t.plane, p);
  triangle.z_y = rounded_.down(t.plane, p);
  if ((sight & TileSight::kCut) != 0) {
    triangle.most = ahead_[p];
    sight = TileSight::kEdges;
  }
  for (int k = 0; k < 3; ++k) {
    if ((sight >> k & 1) == 0) continue;
    const int n = triangle.edges++;
    triangle.least[n] = t.least[k];
    if (list_->isFlat()) {
      const float x = p % kTile + 0.5f, y = p / kTile + 0.5f;  // NOLINT
      triangle.a[n] = t.a[k];
      triangle.b[n] = t.b[k];
      triangle.c[n] = t.a[k] * x + t.b[k] * y + t.c[k];
    } else {
      triangle.a[n] = rounded_.across(t.edge[k], p);
      triangle.b[n] = rounded_.down(t.edge[k], p);
      triangle.c[n] = rounded_.middle(t.edge[k], p);
    }
  }
  return triangle;
}

void TilePainter::addFragment(int p, std::uint32_t candidate, float nearest, bool smooth, std::int32_t sight) {
  // Filled in place: push_back would copy it, which waits until all its parts were written.
  fragments_.emplace_back() = {candidate, first_[p], nearest, smooth, sight};
  first_[p] = static_cast<int>(fragments_.size()) - 1;
}

/** Makes a candidate that covers a pixel the one in front there. */
void TilePainter::putInFront(int p, std::uint32_t index, float farthest, float nearest) {
  if (front_[p] >= 0 && front_nearest_[p] >= farthest) {
    const bool smooth = !isCurved(static_cast<std::uint32_t>(front_[p]));
    addFragment(p, static_cast<std::uint32_t>(front_[p]), front_nearest_[p], smooth, 0);
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
    addFragment(p, index, curved.nearest[p], false, 0);
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
      const float z = rounded_.middle(t.plane, p) + t.bias;
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
    seen_.emplace_back() = {fragments_[k].candidate, fragments_[k].sight};
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
  const auto put = [&](auto& image) {
    using Value = std::decay_t<decltype(*image.data.data())>;
    const auto values = pixelOf<Value>(rgb[0], rgb[1], rgb[2], image.encoding);
    std::copy_n(values.begin(), image.channels(), image.pixel(box_.u0 + p % kTile, box_.v0 + p / kTile));
  };
  std::visit([&](const auto& canvas) { put(*canvas.image); }, canvas_);
}

/** Which of the candidates seen_, none of which ends in the pixel, its middle sees; -1 unless they are one surface of
 *  about one colour, front_ is of it too or behind it. */
int TilePainter::smoothFront(int p) const {
  const TileTriangle& first = candidates_[seen_.front().candidate];
  const Eigen::Vector3f& color = list_->facet(first.triangle).rgb[0];
  int front = -1;
  float nearest = 0.0f;
  const auto behind = static_cast<std::uint32_t>(front_[p]);
  const bool alone = front_[p] < 0 || (!isCurved(behind) && candidates_[behind].surface == first.surface);
  const auto look = [&](std::uint32_t index) {
    const TileTriangle& t = candidates_[index];
    const float z = rounded_.middle(t.plane, p) + t.bias;
    const float reach = 0.5f * (std::abs(rounded_.across(t.plane, p)) + std::abs(rounded_.down(t.plane, p)));
    if (!alone && z - reach <= front_nearest_[p]) return false;
    const Eigen::Vector3f& other = list_->facet(t.triangle).rgb[0];
    if (t.surface != first.surface || (other - color).cwiseAbs().maxCoeff() > kCrease) return false;
    if (isInside(t, p) && z > nearest) {
      front = static_cast<int>(index);
      nearest = z;
    }
    return true;
  };
  for (const Seen& seen : seen_) {
    if (!look(seen.candidate)) return -1;
  }
  return front_[p] < 0 || !alone || look(behind) ? front : -1;
}

/** The mean of the colours of the candidates seen_ and front_, and of the background in rgb, each where it is seen. */
void TilePainter::samplePixel(int p, double* rgb) {
  if (front_[p] >= 0) seen_.emplace_back() = {static_cast<std::uint32_t>(front_[p]), 0};
  const auto nothing = static_cast<std::int32_t>(seen_.size());
  samples_.clear(nothing);
  for (std::int32_t k = nothing - 1; k >= 0; --k) {
    const auto [candidate, sight] = seen_[k];
    if (isCurved(candidate)) {
      samples_.see(samplesOf(*camera_, patchOf(curvedOf(candidate)), rays_[p]), k);
    } else {
      samples_.see(about(candidates_[candidate], p, sight), k);
    }
  }
  Eigen::Map<Eigen::Vector3d> color(rgb);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int left = PixelSamples::kCount;
  for (std::int32_t k = nothing - 1; k >= 0 && left > 0; --k) {
    const PixelSamples::Share share = samples_.shareOf(k);
    if (share.count == 0) continue;
    left -= share.count;
    sum += share.count * colorOf(seen_[k].candidate, p, share);
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
    const PixelSamples::Triangle here = about(t, p, TileSight::kEdges);
    for (int k = 0; k < here.edges && !outline_.empty(); ++k) {
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

/** Mean of the texels over a pixel; at the patch's outline and a sphere's poles, of those that its samples see. */
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
