// Means of pictures over polygons, held against polygons that are cut here along every texel's sides.
#include "render/picture/texture_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tools/texel_means.hpp"

namespace aras_visual_servo_sim::testing::texture_area_test {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

// [grey levels] Slivers of up to 1e-9 texels^2 are left out of areas of a twentieth of a texel at least, and are at
// most 255 levels off: two of them.
constexpr double kRounding = 1e-5;

Eigen::Vector3d found(const MeshPicture& picture, Polygon polygon) {
  TextureArea tool;
  return tool.mean(picture, polygon);
}

/** A triangle or more on a circle, either way round. */
Polygon randomPolygon(std::mt19937& random, const Eigen::Vector2d& middle, double radius) {
  const auto unit = [&] { return std::uniform_real_distribution<double>()(random); };
  const int corners = 3 + static_cast<int>(random() % 3);
  const double turn = unit(), direction = random() % 2 == 0 ? 1.0 : -1.0;
  Polygon polygon;
  for (int k = 0; k < corners; ++k) {
    const double angle = direction * 2.0 * M_PI * (turn + (k + 0.5 * unit()) / corners);
    polygon.push_back(middle + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return polygon;
}

/** Up to three texels wide every edge is exact, whatever repetitions of the picture it crosses. */
TEST(TextureArea, OfAFewTexelsIsExactInEveryRepetition) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-30.0, 30.0);
  for (const auto& [wrap_s, wrap_t] :
       {std::pair{Wrap::kRepeat, Wrap::kMirror}, {Wrap::kMirror, Wrap::kRepeat}, {Wrap::kMirror, Wrap::kMirror}}) {
    for (const auto& [width, height] : {std::pair{7, 5}, {2, 1}, {1, 3}}) {
      const MeshPicture picture{noise(width, height), wrap_s, wrap_t};
      for (int k = 0; k < 300; ++k) {
        const Polygon polygon = randomPolygon(random, {place(random), place(random)}, 0.3 + 1.15 * (k % 10) / 9.0);
        if (areaOf(polygon) < 0.05) continue;
        EXPECT_LT((found(picture, polygon) - meanOfTexels(picture, polygon)).cwiseAbs().maxCoeff(), kRounding) << k;
      }
    }
  }
}

TEST(TextureArea, BeyondAPictureThatIsHeldItsEdgesGoOn) {
  std::mt19937 random(4);
  std::vector<std::uint8_t> columns, rows;  // alike along t, and along s
  for (int k = 0; k < 25; ++k) {
    for (int c = 0; c < 3; ++c) columns.push_back(static_cast<std::uint8_t>(50 * (k % 5) + c));
    for (int c = 0; c < 3; ++c) rows.push_back(static_cast<std::uint8_t>(50 * (k / 5) + c));
  }
  for (const auto& rgb : {columns, rows}) {
    const MeshPicture picture{std::make_shared<Texture>("held", 5, 5, rgb), Wrap::kClamp, Wrap::kClamp};
    for (const double along : {0.0, 5.0}) {
      for (int k = 0; k < 50; ++k) {
        const Eigen::Vector2d middle = rgb == columns ? Eigen::Vector2d(along, 2.5) : Eigen::Vector2d(2.5, along);
        const Polygon polygon = randomPolygon(random, middle, 1.4);
        EXPECT_LT((found(picture, polygon) - meanOfTexels(picture, polygon)).cwiseAbs().maxCoeff(), kRounding);
      }
    }
  }
}

TEST(TextureArea, FarBeyondAPictureThatIsHeldItsEdgeIsSeen) {
  const MeshPicture picture{noise(5, 5), Wrap::kClamp, Wrap::kClamp};
  const Eigen::Vector3d edge = TextureArea::at(picture, {4.5, 2.5});
  const Eigen::Vector3d seen = found(picture, {{60.0, 2.1}, {2000.0, 2.1}, {2000.0, 2.9}, {60.0, 2.9}});
  EXPECT_LT((seen - edge).cwiseAbs().maxCoeff(), kRounding);
}

/** Flat edges are sampled in four places: on a picture that grows brighter evenly that is exact to texels' steps. */
TEST(TextureArea, FlatEdgesSeeTheWholeOfTheirRow) {
  std::vector<std::uint8_t> ramp;
  for (int k = 0; k < 60; ++k) ramp.insert(ramp.end(), 3, static_cast<std::uint8_t>(4 * k));
  const MeshPicture picture{std::make_shared<Texture>("ramp", 60, 1, ramp)};
  for (const Polygon& polygon :
       {Polygon{{5.0, 0.1}, {45.0, 0.5}, {45.0, 0.9}, {5.0, 0.5}}, Polygon{{5.0, 0.9}, {45.0, 0.5}, {45.0, 0.9}},
        Polygon{{5.0, 0.1}, {45.0, 0.1}, {5.0, 0.9}}}) {
    EXPECT_LT((found(picture, polygon) - meanOfTexels(picture, polygon)).cwiseAbs().maxCoeff(), 2.0);
  }
}

/** Of 40 rows eight become one: exact where a polygon covers these as a whole. */
TEST(TextureArea, OfManyRowsIsThatOfTheMergedOnes) {
  const MeshPicture picture{noise(64, 64)};
  const Polygon polygon = {{3.3, 8.0}, {40.7, 8.0}, {40.7, 48.0}, {3.3, 48.0}};
  EXPECT_LT((found(picture, polygon) - meanOfTexels(picture, polygon)).cwiseAbs().maxCoeff(), kRounding);
}

TEST(TextureArea, OfWhiteIsNeverBrighterThanWhite) {
  std::mt19937 random(6);
  const MeshPicture white{std::make_shared<Texture>("white", 7, 5, std::vector<std::uint8_t>(105, 255))};
  for (int k = 0; k < 300; ++k) {
    EXPECT_LE(found(white, randomPolygon(random, {3.0, 2.0}, 1.4)).maxCoeff(), 255.0 * (1.0 + 3e-16));
  }
}

TEST(TextureArea, OfMoreRepetitionsThanCanBeCountedIsThePicturesMean) {
  const MeshPicture picture{noise(3, 2)};
  const Rgb mean = picture.texture->meanColor();
  EXPECT_EQ(found(picture, {{0.5, 0.5}, {60.0, 0.5}, {60.0, 40.0}}), Eigen::Vector3d(mean.r, mean.g, mean.b));
}

TEST(TextureArea, AtAPointIsTheTexelOfItsRepetition) {
  const TexturePtr texture = noise(3, 2);
  for (const Wrap wrap_s : {Wrap::kClamp, Wrap::kRepeat, Wrap::kMirror}) {
    for (const Wrap wrap_t : {Wrap::kClamp, Wrap::kRepeat, Wrap::kMirror}) {
      for (int k = 0; k < 20 * 20; ++k) {
        const int i = k % 20 - 10, j = k / 20 - 10;
        const std::uint8_t* rgb = texture->texel(texelAt(wrap_s, i, 3), texelAt(wrap_t, j, 2));
        EXPECT_EQ(TextureArea::at({texture, wrap_s, wrap_t}, {i + 0.5, j + 0.5}),
                  Eigen::Vector3d(rgb[0], rgb[1], rgb[2]));
      }
    }
  }
}

TEST(TextureArea, OfALineIsTheTexelInItsMiddle) {
  const MeshPicture picture{noise(3, 2)};
  EXPECT_EQ(found(picture, {{0.5, 0.5}, {600.5, 0.5}, {300.5, 0.5}}), TextureArea::at(picture, {300.5, 0.5}));
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::texture_area_test
