// Same bytes from everywhere, and what is said when something is wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "opengl_tools.hpp"
#include "render/opengl/gl/gl_context.hpp"
#include "render/opengl/gl/shader_program.hpp"
#include "tools/messages.hpp"

namespace aras_visual_servo_sim::testing::opengl_run_test {
namespace {

const Pose kView = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);

const Pose kAboveTheBox = lookingDown({0.0, 0.0, 0.5});

Scene shadedScene() {
  Scene scene = colourfulScene();
  scene.lighting.shadows = true;
  scene.models.emplace_back("target", std::vector<Polygon>{lShape()}, Rgb{20, 20, 20});
  return scene;
}

CameraModel rgbCamera() {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  return CameraModel(config);
}

TEST(OpenGlRun, AThreadHasOneRendererWhileSomebodyUsesIt) {
  const auto osmesa = OpenGlRenderer::Platform::kOsmesa;
  std::shared_ptr<OpenGlRenderer> first = OpenGlRenderer::shared(osmesa);
  EXPECT_EQ(OpenGlRenderer::shared(osmesa), first);
  EXPECT_NE(OpenGlRenderer::shared(OpenGlRenderer::Platform::kEgl), first);
  std::thread([&] { EXPECT_NE(OpenGlRenderer::shared(osmesa), first); }).join();
  const std::weak_ptr<OpenGlRenderer> known = first;
  first.reset();
  EXPECT_TRUE(known.expired());
}

TEST(OpenGlRun, OneRendererDrawsForThreadsAtTheSameTime) {
  const Scene scene = shadedScene();
  const Image expected = renderOpenGl(rgbCamera(), kView, scene);
  OpenGlRenderer renderer;
  std::vector<Image> images(4);
  std::vector<std::thread> threads;
  for (Image& image : images) threads.emplace_back([&] { renderer.render(rgbCamera(), kView, scene, image); });
  for (std::thread& thread : threads) thread.join();
  for (const Image& image : images) EXPECT_EQ(image.data, expected.data);
}

TEST(OpenGlRun, WhereNothingIsTheImageIsAsItWouldBeDrawn) {
  Scene scene;
  scene.background = {201, 133, 7};
  scene.bodies.push_back(solid("box", makeBox({0.05, 0.05, 0.05}), {40, 90, 160}, {0.1, 0.05, 0.0}, {0.4, 0.3, 0.2}));
  scene.bodies.push_back(solid("housing", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, kAboveTheBox.p));  // about the camera
  const Image in_part = renderOpenGl(rgbCamera(), kAboveTheBox, scene);
  // A sky has all of it drawn; here it is of the background's colour.
  scene.lighting.zenith = scene.background;
  EXPECT_EQ(renderOpenGl(rgbCamera(), kAboveTheBox, scene).data, in_part.data);
  EXPECT_EQ(in_part.pixel(0, 0)[0], 201);
  scene.bodies.pop_back();
  EXPECT_EQ(renderOpenGl(rgbCamera(), kAboveTheBox, scene).data, in_part.data);
  scene.bodies.pop_back();
  const Image nothing = renderOpenGl(rgbCamera(), kAboveTheBox, scene);
  EXPECT_NE(nothing.data, in_part.data);
  scene.lighting.zenith.reset();
  EXPECT_EQ(renderOpenGl(rgbCamera(), kAboveTheBox, scene).data, nothing.data);
}

TEST(OpenGlRun, ImageDependsOnNothingThatWasDrawnBefore) {
  const Image expected = renderOpenGl(rgbCamera(), kView, shadedScene());
  OpenGlRenderer renderer;
  Image image;
  renderer.render(CameraModel(distortedConfig()), lookingDown({0.1, 0.0, 0.4}), colourfulScene(), image);
  renderer.render(rgbCamera(), lookingDown({0.1, 0.0, 0.4}), shadedScene(), image);
  renderer.render(rgbCamera(), kView, shadedScene(), image);
  EXPECT_EQ(image.data, expected.data);
}

TEST(OpenGlRun, ImageIsTheSameInEveryThread) {
  OpenGlRenderer renderer;
  Image here, there, alone;
  renderer.render(rgbCamera(), kView, shadedScene(), here);
  std::thread([&] { renderer.render(rgbCamera(), kView, shadedScene(), there); }).join();
  std::thread([&] { OpenGlRenderer().render(rgbCamera(), kView, shadedScene(), alone); }).join();
  EXPECT_EQ(there.data, here.data);
  EXPECT_EQ(alone.data, here.data);
}

TEST(OpenGlRun, TwoThreadsDrawAtTheSameTime) {
  const Image expected = renderOpenGl(rgbCamera(), kView, shadedScene());
  std::vector<Image> images(2);
  std::vector<std::thread> threads;
  for (Image& image : images) {
    threads.emplace_back([&image] {
      OpenGlRenderer renderer;
      for (int k = 0; k < 3; ++k) renderer.render(rgbCamera(), kView, shadedScene(), image);
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(images[0].data, expected.data);
  EXPECT_EQ(images[1].data, expected.data);
}

TEST(OpenGlRun, EglDrawsWhatOsmesaDraws) {
  OpenGlRenderer egl(OpenGlRenderer::Platform::kEgl);
  Image image;
  std::string description;
  try {
    description = egl.description();
  } catch (const RenderError& error) {
    GTEST_SKIP() << error.what();
  }
  const std::string software = OpenGlRenderer().description();
  if (description.rfind(software, 0) != 0) GTEST_SKIP() << "EGL draws with " << description;
  egl.render(rgbCamera(), kView, shadedScene(), image);
  EXPECT_EQ(image.data, renderOpenGl(rgbCamera(), kView, shadedScene()).data);
}

TEST(OpenGlRun, DescriptionNamesRendererAndVersion) {
  const std::string description = OpenGlRenderer().description();
  EXPECT_NE(description.find("llvmpipe"), std::string::npos) << description;
  EXPECT_NE(description.find("Mesa "), std::string::npos) << description;
}

TEST(OpenGlRun, ShaderThatDoesNotCompileIsNamed) {
  const std::unique_ptr<GlContext> context = makeOsmesaContext();
  const GlContext::Binding binding(*context);
  const std::string message = messageOf<RenderError>([&] {
    ShaderProgram(context->gl(), "broken",
                  {"#version 330 core\nvoid main() { gl_Position = vec4(0.0); }",
                   "#version 330 core\nvoid main() { nonsense(); }"});
  });
  EXPECT_NE(message.find("shader 'broken' does not compile"), std::string::npos) << message;
  EXPECT_NE(message.find("nonsense"), std::string::npos) << message;
}

/** One of OSMesa that can be lost. */
class FrailContext : public GlContext {
 public:
  explicit FrailContext(const bool& lost) : lost_(lost), whole_(makeOsmesaContext()) { gl_ = whole_->gl(); }

 private:
  void bind() override {
    if (lost_) throw RenderError("renderer 'opengl': the context was lost");
    binding_ = std::make_unique<Binding>(*whole_);
  }
  void release() override { binding_.reset(); }

  const bool& lost_;
  std::unique_ptr<GlContext> whole_;
  std::unique_ptr<Binding> binding_;
};

TEST(OpenGlRun, LostContextIsNamedAndTheNextImageIsDrawnInANewOne) {
  bool lost = false;
  int made = 0;
  OpenGlRenderer renderer([&]() -> std::unique_ptr<GlContext> {
    ++made;
    return std::make_unique<FrailContext>(lost);
  });
  Image image;
  renderer.render(rgbCamera(), kView, shadedScene(), image);
  const Image expected = image;
  lost = true;
  const std::string message =
      messageOf<RenderError>([&] { renderer.render(rgbCamera(), kView, shadedScene(), image); });
  EXPECT_NE(message.find("context was lost"), std::string::npos) << message;
  lost = false;
  renderer.render(rgbCamera(), kView, shadedScene(), image);
  EXPECT_EQ(image.data, expected.data);
  EXPECT_EQ(made, 2);
}

TEST(OpenGlRun, PictureTooLargeIsNamedAndTheNextImageIsDrawn) {
  const int wide = 20000;
  const auto texture =
      std::make_shared<Texture>("wide", wide, 4, std::vector<std::uint8_t>(std::size_t(wide) * 4 * 3, 100));
  Scene scene = colourfulScene();
  scene.models.emplace_back("banner", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{texture, {0.2, 0.1}});
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  config.exact_targets = false;
  OpenGlRenderer renderer;
  Image image;
  const std::string message =
      messageOf<RenderError>([&] { renderer.render(CameraModel(config), kView, scene, image); });
  EXPECT_NE(message.find("picture 'wide' has 20000 x 4 px, allowed up to"), std::string::npos) << message;
  renderer.render(rgbCamera(), kView, shadedScene(), image);
  EXPECT_EQ(image.data, renderOpenGl(rgbCamera(), kView, shadedScene()).data);
}

TEST(OpenGlRun, TooManyLightsAndLightsWithoutDirectionAreNamed) {
  const auto faultOf = [](const std::string& lights) {
    return messageOf<ParameterError>(
        [&] { SceneConfig::fromYaml(YAML::Load("{lighting: {lights: [" + lights + "]}}")); });
  };
  std::string many;
  for (int k = 0; k < 64; ++k) many += "{name: a" + std::to_string(k) + ", type: point}, ";
  EXPECT_NE(faultOf(many).find("lights"), std::string::npos) << faultOf(many);
  EXPECT_NE(faultOf(many).find("8"), std::string::npos) << faultOf(many);
  const std::string none = faultOf("{name: sun, type: directional}");
  EXPECT_NE(none.find("direction"), std::string::npos) << none;
  EXPECT_NE(none.find("light 'sun'"), std::string::npos) << none;
  EXPECT_NE(faultOf("{name: sun, type: spot, direction: [0, 0, 0]}").find("zero"), std::string::npos);
  EXPECT_NE(faultOf("{name: s, type: spot, direction: [0, 0, -1], inner_angle_rad: 2, outer_angle_rad: 1}")
                .find("outer_angle_rad"),
            std::string::npos);
  Scene scene = colourfulScene();
  scene.lighting.lights.resize(64);
  const std::string message = messageOf<RenderError>([&] { renderOpenGl(rgbCamera(), kView, scene); });
  EXPECT_NE(message.find("found 64 lights, allowed up to 8"), std::string::npos) << message;
}

TEST(OpenGlRun, NormalsThatAreNotNumbersAreMadeAnew) {
  auto mesh = std::make_shared<TriangleMesh>(*makeBox({0.1, 0.1, 0.1}));
  for (auto& normal : mesh->normals) normal.setConstant(std::numeric_limits<float>::quiet_NaN());
  mesh->finish();
  Scene broken, whole;
  broken.bodies.push_back(solid("box", mesh, {200, 100, 50}, {0.0, 0.0, 0.0}));
  whole.bodies.push_back(solid("box", makeBox({0.1, 0.1, 0.1}), {200, 100, 50}, {0.0, 0.0, 0.0}));
  const CameraModel camera = rgbCamera();
  EXPECT_EQ(renderOpenGl(camera, kView, broken).data, renderOpenGl(camera, kView, whole).data);
}

TEST(OpenGlRun, NormalsThatAreMissingAreMade) {
  auto mesh = std::make_shared<TriangleMesh>(*makeBox({0.1, 0.1, 0.1}));
  mesh->normals.clear();
  mesh->finish();
  Scene without, whole;
  without.bodies.push_back(solid("box", mesh, {200, 100, 50}, {0.0, 0.0, 0.0}));
  whole.bodies.push_back(solid("box", makeBox({0.1, 0.1, 0.1}), {200, 100, 50}, {0.0, 0.0, 0.0}));
  EXPECT_EQ(renderOpenGl(rgbCamera(), kView, without).data, renderOpenGl(rgbCamera(), kView, whole).data);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_run_test
