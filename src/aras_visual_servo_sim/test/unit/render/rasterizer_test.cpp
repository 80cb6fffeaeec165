// The rasteriser alone, in images of a few pixels: each value against the outline clipped to the pixel's square.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "render/coverage/coverage_rasterizer.hpp"

namespace aras_visual_servo_sim::testing::rasterizer_test {
namespace {

using Outline = std::vector<Eigen::Vector2d>;
using Rule = CoverageRasterizer::Rule;

constexpr int kWidth = 13, kHeight = 9;
constexpr double kSingle = 2e-5;  // [px] of sums of areas in single precision

/** The side of an outline on which sign * (corner[axis] - at) >= 0. */
Outline clipped(const Outline& outline, int axis, double sign, double at) {
  Outline kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double inside_a = sign * (a[axis] - at), inside_b = sign * (b[axis] - at);
    if (inside_a >= 0.0) kept.push_back(a);
    if ((inside_a >= 0.0) != (inside_b >= 0.0)) kept.push_back(a + inside_a / (inside_a - inside_b) * (b - a));
  }
  return kept;
}

/** Area of the part of a convex outline in the square of pixel (u, v). */
double areaIn(const Outline& outline, int u, int v) {
  Outline part = clipped(clipped(outline, 0, 1.0, u - 0.5), 0, -1.0, u + 0.5);
  part = clipped(clipped(part, 1, 1.0, v - 0.5), 1, -1.0, v + 0.5);
  double twice = 0.0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Eigen::Vector2d a = part[i] - Eigen::Vector2d(u, v), b = part[(i + 1) % part.size()] - Eigen::Vector2d(u, v);
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

void begin(CoverageRasterizer& rasterizer, const Outline& outline, Rule rule = Rule::kCoverage, int width = kWidth,
           int height = kHeight) {
  rasterizer.begin(width, height, rule);
  for (std::size_t i = 0; i < outline.size(); ++i) rasterizer.addEdge(outline[i], outline[(i + 1) % outline.size()]);
}

template <typename Value>
ImageOf<Value> noise(Encoding encoding, unsigned seed) {
  std::mt19937 random(seed);
  ImageOf<Value> image;
  image.resize(kWidth, kHeight, encoding);
  for (Value& value : image.data) value = static_cast<Value>(random());
  return image;
}

/** Triangles of both orientations, of which most cross one border of the image or several. */
std::vector<Outline> triangles() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> across(-0.6 * kWidth, 1.6 * kWidth), along(-0.6 * kHeight, 1.6 * kHeight);
  std::vector<Outline> all;
  for (int k = 0; k < 400; ++k) {
    Outline outline(3);
    for (Eigen::Vector2d& corner : outline) corner = {across(random), along(random)};
    all.push_back(outline);
  }
  return all;
}

/** The outlines on which a rule has to decide: edges through centres, along borders of pixels, and half a pixel. */
Outline rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

template <typename Value>
void expectAreas(const std::vector<Outline>& outlines, bool picture) {
  CoverageRasterizer rasterizer;  // one for all: what a fill leaves behind is seen by the next
  unsigned seed = 0;
  for (const Outline& outline : outlines) {
    for (const Encoding encoding : {Encoding::kRgb8, Encoding::kMono8}) {
      const ImageOf<Value> below = noise<Value>(encoding, 3 * ++seed), colors = noise<Value>(encoding, 3 * seed + 1);
      // Any two of the three channels may be alike, and all of them.
      const auto channel = [&](unsigned bit) { return Value((seed / 2 & bit ? 200 : 40) * kUnitsOf<Value>); };
      const std::array<Value, 3> color{channel(1), channel(2), channel(4)};
      ImageOf<Value> image = below;
      begin(rasterizer, outline);
      picture ? rasterizer.blend(colors, image) : rasterizer.blend(color, image);
      for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
          const double area = areaIn(outline, u, v);
          for (int c = 0; c < image.channels(); ++c) {
            const double from = below.pixel(u, v)[c], to = picture ? colors.pixel(u, v)[c] : color[c];
            // Rounded to the nearest value.
            ASSERT_NEAR(image.pixel(u, v)[c], from + area * (to - from), 0.5 + 256 * kUnitsOf<Value> * kSingle)
                << "outline " << seed << " pixel " << u << " " << v << " channel " << c << " area " << area;
          }
        }
      }
    }
  }
}

TEST(Rasterizer, APixelGetsThePartOfAColourThatIsTheAreaOfItThatIsCovered) {
  expectAreas<std::uint8_t>(triangles(), false);
  expectAreas<std::uint16_t>(triangles(), false);
}

TEST(Rasterizer, APixelGetsThePartOfAPictureThatIsTheAreaOfItThatIsCovered) {
  expectAreas<std::uint8_t>(triangles(), true);
  expectAreas<std::uint16_t>(triangles(), true);
}

TEST(Rasterizer, EdgesAlongPixelsAndBordersAreNoSpecialCase) {
  std::vector<Outline> outlines{rectangle(-0.5, -0.5, kWidth - 0.5, kHeight - 0.5)};
  for (const double inner : {0.0, 0.25, 0.5, 1.0, 1.5}) {
    outlines.push_back(rectangle(kWidth - 0.5 - inner, 1.0, kWidth + 5.0, 6.25));
    outlines.push_back(rectangle(-5.0, 1.0, -0.5 + inner, 6.25));
    outlines.push_back(rectangle(2.0, kHeight - 0.5 - inner, 7.25, kHeight + 5.0));
    outlines.push_back(rectangle(2.0, -5.0, 7.25, -0.5 + inner));
  }
  // Single pixels on which a run of four begins or ends.
  for (int u = 0; u < kWidth; ++u) outlines.push_back(rectangle(u - 0.5, 3.5, u + 0.25, 4.25));
  expectAreas<std::uint8_t>(outlines, false);
  expectAreas<std::uint16_t>(outlines, true);
}

TEST(Rasterizer, FarCornersKeepTheDirectionOfTheirEdges) {
  // From the image's left border, row 2, to 200 px below it 4000 px away: almost level within the image.
  const Outline far{{-4000.0, -198.0}, {4000.0, 202.0}, {4000.0, 4000.0}, {-4000.0, 4000.0}};
  expectAreas<std::uint8_t>({far}, false);
}

TEST(Rasterizer, BoundsAreThePixelsThatAreTouched) {
  CoverageRasterizer rasterizer;
  const auto bounds = [&](const Outline& outline) {
    begin(rasterizer, outline);
    const PixelBox box = rasterizer.bounds();
    return std::array<int, 4>{box.u0, box.v0, box.u1, box.v1};
  };
  using Box = std::array<int, 4>;
  EXPECT_EQ(bounds({}), (Box{0, 0, 0, 0}));
  EXPECT_EQ(bounds(rectangle(2.0, 3.0, 4.0, 5.0)), (Box{2, 3, 5, 6}));
  EXPECT_EQ(bounds(rectangle(1.5, 2.5, 3.5, 4.5)), (Box{2, 3, 4, 5}));
  EXPECT_EQ(bounds(rectangle(-9.0, -9.0, 99.0, 99.0)), (Box{0, 0, kWidth, kHeight}));
  // Whichever edge has the outermost corner.
  for (int first = 0; first < 3; ++first) {
    for (const bool backwards : {false, true}) {
      Outline outline{{2.2, 5.1}, {6.3, 1.2}, {9.9, 7.7}};
      std::rotate(outline.begin(), outline.begin() + first, outline.end());
      if (backwards) std::reverse(outline.begin(), outline.end());
      EXPECT_EQ(bounds(outline), (Box{2, 1, 11, 9}));
    }
  }
  // Of one edge too, in both directions.
  for (const Outline& ends : {Outline{{1.0, 2.0}, {8.0, 6.0}}, Outline{{8.0, 6.0}, {1.0, 2.0}}}) {
    rasterizer.begin(kWidth, kHeight, Rule::kCoverage);
    rasterizer.addEdge(ends[0], ends[1]);
    const PixelBox box = rasterizer.bounds();
    EXPECT_EQ((Box{box.u0, box.v0, box.u1, box.v1}), (Box{1, 2, 9, 7}));
  }
}

using Pixels = std::vector<int>;  // 1 where a pixel is in a run

Pixels runsOf(CoverageRasterizer& rasterizer) {
  Pixels inside(kWidth * kHeight, 0);
  rasterizer.forEachRun([&](int u0, int u1, int v) {
    ASSERT_TRUE(0 <= u0 && u0 < u1 && u1 <= kWidth && 0 <= v && v < kHeight);
    for (int u = u0; u < u1; ++u) inside[v * kWidth + u] += 1;
  });
  return inside;
}

TEST(Rasterizer, RunsAreThePixelsThatAreCoveredByHalfOrMore) {
  CoverageRasterizer rasterizer;
  std::vector<Outline> outlines = triangles();
  for (const double share : {0.25, 0.5, 0.75}) {  // exactly representable
    outlines.push_back(rectangle(3.5 - share, 2.5, 8.5, 5.5));
    outlines.push_back(rectangle(kWidth - 0.5 - share, 2.5, kWidth + 3.0, 5.5));
  }
  for (const Outline& outline : outlines) {
    begin(rasterizer, outline);
    const Pixels inside = runsOf(rasterizer);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const double area = areaIn(outline, u, v);
        if (std::abs(area - 0.5) < kSingle && area != 0.5) continue;
        ASSERT_EQ(inside[v * kWidth + u], area >= 0.5 ? 1 : 0) << u << " " << v << " " << area;
      }
    }
  }
}

TEST(Rasterizer, WithTheRuleOfCentresPixelsAreInWhoseCentreIs) {
  CoverageRasterizer rasterizer;
  for (const Outline& outline : triangles()) {
    Image image = noise<std::uint8_t>(Encoding::kMono8, 1);
    std::fill(image.data.begin(), image.data.end(), std::uint8_t{200});
    begin(rasterizer, outline, Rule::kCenter);
    rasterizer.blend(std::array<std::uint8_t, 3>{20, 20, 20}, image);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        int sides = 0;
        for (int i = 0; i < 3; ++i) {
          const Eigen::Vector2d edge = outline[(i + 1) % 3] - outline[i], to = Eigen::Vector2d(u, v) - outline[i];
          sides += edge.x() * to.y() - edge.y() * to.x() > 0.0 ? 1 : -1;
        }
        ASSERT_EQ(*image.pixel(u, v), std::abs(sides) == 3 ? 20 : 200) << u << " " << v;
      }
    }
  }
}

TEST(Rasterizer, ACentreOnTheEdgeBetweenTwoOutlinesIsInOneOfThem) {
  CoverageRasterizer rasterizer;
  const double left = 2.0, top = 1.0, right = 7.0, bottom = 5.0;  // all on centres
  for (const bool backwards : {false, true}) {
    Pixels sum(kWidth * kHeight, 0);
    for (const double u : {left, right}) {
      for (const double v : {top, bottom}) {
        Outline outline = rectangle(u, v, u == left ? right : 11.0, v == top ? bottom : 8.0);
        if (backwards) std::reverse(outline.begin(), outline.end());
        begin(rasterizer, outline, Rule::kCenter);
        const Pixels inside = runsOf(rasterizer);
        EXPECT_EQ(inside[static_cast<int>(v) * kWidth + static_cast<int>(u)], 1) << "its own upper left corner";
        std::transform(sum.begin(), sum.end(), inside.begin(), sum.begin(), std::plus<int>());
      }
    }
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        EXPECT_EQ(sum[v * kWidth + u], u >= 2 && u < 11 && v >= 1 && v < 8 ? 1 : 0) << u << " " << v;
      }
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::rasterizer_test
