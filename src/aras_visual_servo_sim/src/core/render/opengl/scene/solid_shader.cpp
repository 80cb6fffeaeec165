#include "solid_shader.hpp"

#include <cctype>

namespace aras_visual_servo_sim {
namespace {

const char kVersion[] = "#version 330 core\n";

/** Whether light k's part is worked out for a triangle as a whole, but for the shadow on it. */
bool isWholeLight(const ShaderTraits& traits, std::size_t k) {
  return traits.faceted && std::tolower(traits.lights[k]) == 'd';
}

/** Whether one triangle has one colour, which its vertices know: no light of its own at a pixel, no picture, no fog. */
bool isOneColor(const ShaderTraits& traits) {
  if (!traits.faceted || traits.textured || traits.bumpy || traits.specular || traits.fog || traits.two_sided)
    return false;
  for (std::size_t k = 0; k < traits.lights.size(); ++k) {
    if (traits.lights[k] != 'd') return false;
  }
  return true;
}

/** Of the fragment shader: what the shadow leaves of light k's part of the sum, and its highlight. */
std::string wholeLightText(char letter, const std::string& k) {
  std::string text = "  {\n    float left = 1.0;\n";
  if (letter == 'D') {
    text += "    left = shadow(map" + k + ", on_map" + k + ", texel_of_map[" + k + "]);\n    light += left * whole" +
            k + ";\n";
  }
  return text + "#ifdef SPECULAR\n    float glint = halfway(slope" + k + ", n_v, dot(place[" + k +
         "], v));\n    shine += (left * SHARP(glint)) * facing" + k + ";\n#endif\n  }\n";
}

/** Of the fragment shader: the direction to light k, what is left of it at the point, and its part of the sum. */
std::string lightText(char letter, std::size_t k) {
  const std::string i = "[" + std::to_string(k) + "]";
  const char kind = static_cast<char>(std::tolower(letter));
  if (kind == 'h') return "  light += headlight * diffuse" + i + ";\n";
  std::string text = "  {\n";
  if (kind == 'd') {
    text += "    vec3 toward = place" + i + ";\n    float left = 1.0;\n";
  } else {
    text += "    vec3 ray = place" + i + " - p_C;\n    float d = length(ray);\n    vec3 toward = ray / d;\n" +
            "    float left = d < fade" + i + ".x ? 1.0 / (fade" + i + ".y + d * (fade" + i + ".z + d * fade" + i +
            ".w)) : 0.0;\n";
  }
  if (kind == 's') {
    text += "    left *= pow(clamp((dot(toward, axis" + i + ") - cone" + i + ".x) * cone" + i + ".y, 0.0, 1.0), cone" +
            i + ".z);\n";
  }
  text += "    float slope = dot(n, toward);\n    if (slope > 0.0) {\n";
  if (letter != kind) {
    const std::string map = "map" + std::to_string(k), texel = ", texel_of_map" + i;
    text += "      vec3 lifted = p_C + n * (lift" + i + (kind == 'd' ? "" : " * d") +
            " * sqrt(max(0.0, 1.0 - slope * slope)) + slack);\n      vec4 at = shadow_of" + i +
            " * vec4(lifted, 1.0);\n";
    text += kind == 'p'   ? "      left *= shadow_around(" + map + ", at.xyz, reach" + i + texel + ");\n"
            : kind == 'd' ? "      left *= shadow(" + map + ", at.xyz" + texel + ");\n"
                          : "      left *= shadow(" + map + ", at.xyz / at.w" + texel + ");\n";
  }
  text += "      light += (left * slope) * diffuse" + i + ";\n";
  text += "#ifdef SPECULAR\n      float glint = halfway(slope, n_v, dot(toward, v));\n" +
          std::string("      shine += (left * SHARP(glint)) * bright") + i + ";\n#endif\n    }\n  }\n";
  return text;
}

/** What both shaders take of the lights. */
std::string lightUniforms(std::size_t count) {
  std::string text = "uniform vec3 ambient;\nuniform vec4 shape_color;\n";
  if (count == 0) return text;
  const std::string n = "[" + std::to_string(count) + "];\n";
  return text + "uniform vec3 place" + n + "uniform vec3 diffuse" + n + "uniform vec3 bright" + n +
         "uniform mat4 shadow_of" + n + "uniform float lift" + n + "uniform float slack;\n";
}

/** What the vertex shader hands to the fragment shader. @param way  "in" or "out" */
std::string handedOver(const ShaderTraits& traits, const std::string& way) {
  const std::string of_triangle = traits.faceted ? "flat " + way : way;
  std::string text = way + " vec3 p_C;\n" + of_triangle + " vec3 n_C;\n" + way + " vec2 texel;\n";
  if (traits.painted) text += of_triangle + " vec3 surface;\n";
  if (traits.lights.find('h') != std::string::npos) text += way + " float headlight;\n";
  if (!traits.faceted) return text;
  text += "flat " + way + " vec3 whole;\n";
  for (std::size_t k = 0; k < traits.lights.size(); ++k) {
    const std::string i = std::to_string(k);
    if (traits.specular && isWholeLight(traits, k)) {
      text += "flat " + way + " float slope" + i + ";\nflat " + way + " vec3 facing" + i + ";\n";
    }
    if (traits.lights[k] != 'D') continue;
    text += "flat " + way + " vec3 whole" + i + ";\n" + way + " vec3 on_map" + i + ";\n";
  }
  return text;
}

// Four taps of 2 x 2 comparisons each: an edge is as soft as three texels. Maps of point lights are cubes with faces of
// half the width; reach has the distances of their near and far planes.
const char kShadow[] = R"(
float shadow(sampler2DShadow map, vec3 at, vec2 texel_of_map) {
  vec2 texel_size = 0.75 * texel_of_map;
  at.z = min(at.z, 1.0);
  float sum = texture(map, vec3(at.xy + texel_size * vec2(-0.5, -1.0), at.z));
  sum += texture(map, vec3(at.xy + texel_size * vec2(1.0, -0.5), at.z));
  sum += texture(map, vec3(at.xy + texel_size * vec2(0.5, 1.0), at.z));
  sum += texture(map, vec3(at.xy + texel_size * vec2(-1.0, 0.5), at.z));
  return 0.25 * sum;
}
)";
// The mean of a picture over the strip that a pixel sees of it: taps side by side along it, each as wide as the strip,
// or wider where there are too few. The strip is the ellipse that a round pixel covers: P. Heckbert, Fundamentals of
// Texture Mapping and Image Warping, 1989, appendix.
const char kStrip[] = R"(
vec3 strip(sampler2D map, vec2 at) {
  vec2 size = vec2(textureSize(map, 0)), right = dFdx(at) * size, down = dFdy(at) * size;
  float a = right.x * right.x + down.x * down.x, c = right.y * right.y + down.y * down.y;
  float b = right.x * right.y + down.x * down.y, excess = 0.5 * (a - c);
  float longest = max(1e-20, 0.5 * (a + c) + sqrt(excess * excess + b * b)), length = sqrt(longest);
  float width = max(1.0, abs(right.x * down.y - right.y * down.x) / length);
  vec2 axis = excess > 0.0 ? vec2(longest - c, b) : vec2(b, longest - a);
  vec2 way = axis * (length * inversesqrt(max(dot(axis, axis), 1e-30))) / size;
  float level = log2(max(width, length / (TAPS * TAP_LENGTH)));
)";

/** Of the fragment shader: strip(), without a loop. */
std::string stripText(int taps) {
  std::string text = "#define TAPS " + std::to_string(double(taps)) + "\n#define TAP_LENGTH " +
                     std::to_string(ShaderTraits::kTapLength) + kStrip + "  return (";
  for (int k = 0; k < taps; ++k) {
    text += std::string(k > 0 ? " +\n    " : "") + "textureLod(map, at + " + std::to_string((k + 0.5) / taps - 0.5) +
            " * way, level).rgb";
  }
  return text + ") / TAPS;\n}\n";
}

// The normal that a picture gives, in the frame of the directions in which s grows and t falls. p_C and texel change by
// the same steps from pixel to pixel, so that these directions follow from the differences without any approximation on
// a flat triangle (C. Schueler, Normal Mapping without Precomputed Tangents, ShaderX 5, 2006).
const char kBumps[] = R"(
uniform sampler2D bumps;
vec3 bent(vec3 n) {
  vec3 right = dFdx(p_C), down = dFdy(p_C);
  vec2 right_texel = dFdx(texel), down_texel = dFdy(texel);
  float facing = dot(n, cross(right, down)) < 0.0 ? -1.0 : 1.0;
  vec3 a = facing * cross(down, n), b = facing * cross(n, right);
  vec3 along_s = a * right_texel.x + b * down_texel.x;
  vec3 along_t = a * right_texel.y + b * down_texel.y;
  float longest = max(dot(along_s, along_s), dot(along_t, along_t));
  vec3 m = 2.0 * TEXEL(bumps) - 1.0;
  return longest > 0.0 ? normalize((m.x * along_s - m.y * along_t) * inversesqrt(longest) + m.z * n) : n;
}
)";
// Cosine between the normal and the direction half-way between light and viewer, from the cosines between all three.
const char kHalfway[] = R"(
float halfway(float n_l, float n_v, float l_v) { return max(0.0, (n_l + n_v) * inversesqrt(max(1e-6, 2.0 + 2.0 * l_v))); }
)";
const char kShadowAround[] = R"(
float shadow_around(samplerCubeShadow map, vec3 ray, vec2 reach, vec2 texel_of_map) {
  vec3 size = abs(ray);
  float depth = max(size.x, max(size.y, size.z));
  float nearness = min(1.0, reach.y / (reach.y - reach.x) * (1.0 - reach.x / depth));
  vec3 side = normalize(cross(ray, size.z < depth ? vec3(0.0, 0.0, 1.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = normalize(cross(side, ray));
  float texel_size = 0.75 * 2.0 * depth * texel_of_map.x;
  side *= texel_size;
  up *= texel_size;
  float sum = texture(map, vec4(ray - 0.5 * side - up, nearness));
  sum += texture(map, vec4(ray + side - 0.5 * up, nearness));
  sum += texture(map, vec4(ray + 0.5 * side + up, nearness));
  sum += texture(map, vec4(ray - side + 0.5 * up, nearness));
  return 0.25 * sum;
}
)";

std::string solidVertexShader(const ShaderTraits& traits) {
  const bool headlight = traits.lights.find('h') != std::string::npos;
  std::string text = kVersion;
  text += "in vec3 position;\nin vec3 normal;\nin vec2 coordinates;\nin vec4 color;\n";
  text += "uniform mat4 projection;\nuniform mat4 placed;  // pose of the shape in the camera's frame\n";
  text += "uniform vec4 far_plane;\ninvariant gl_Position;\n";
  if (isOneColor(traits)) text += "uniform vec3 emissive;\n";
  text += lightUniforms(traits.lights.size()) + handedOver(traits, "out") + R"(void main() {
  p_C = (placed * vec4(position, 1.0)).xyz;
  n_C = mat3(placed) * normal;
  texel = coordinates;
  gl_Position = projection * vec4(p_C, 1.0);
  gl_ClipDistance[0] = dot(far_plane, vec4(p_C, 1.0));
)";
  if (traits.painted) text += "  surface = color.rgb;\n";
  // As the coverage renderer has it: of the corners, and between them.
  if (headlight) text += "  headlight = max(0.0, -dot(normalize(n_C), normalize(p_C)));\n";
  if (!traits.faceted) return text + "}\n";
  text += "  n_C = normalize(n_C);\n  whole = ambient;\n";
  for (std::size_t k = 0; k < traits.lights.size(); ++k) {
    if (!isWholeLight(traits, k)) continue;
    const std::string i = std::to_string(k);
    if (traits.specular) {
      text += "  slope" + i + " = dot(n_C, place[" + i + "]);\n  facing" + i + " = slope" + i + " > 0.0 ? bright[" + i +
              "] : vec3(0.0);\n";
    }
    const std::string slope = "dot(n_C, place[" + i + "])", light = "max(0.0, " + slope + ") * diffuse[" + i + "];\n";
    if (traits.lights[k] == 'd') {
      text += "  whole += " + light;
      continue;
    }
    text += "  whole" + i + " = " + light + "  on_map" + i + " = (shadow_of[" + i + "] * vec4(p_C + n_C * (lift[" + i +
            "] * sqrt(max(0.0, 1.0 - " + slope + " * " + slope + ")) + slack), 1.0)).xyz;\n";
  }
  if (!isOneColor(traits)) return text + "}\n";
  if (traits.clamps_light) text += "  whole = min(whole, vec3(1.0));\n";
  return text + "  whole = emissive + " + (traits.painted ? "surface" : "shape_color.rgb") + " * whole;\n}\n";
}

std::string solidFragmentShader(const ShaderTraits& traits) {
  const std::size_t count = traits.lights.size();
  std::string text = kVersion;
  if (isOneColor(traits)) {
    return text + handedOver(traits, "in") +
           "out vec4 pixel;\nuniform float opacity;\nvoid main() { pixel = vec4(whole, opacity); }\n";
  }
  if (traits.specular) {
    text += "#define SPECULAR\n#define SHARP(x) ";
    text += traits.by_root ? "((x) * sqrt(x))\n" : traits.sharp ? "pow(x, shininess)\n" : "(x)\n";
  }
  text += handedOver(traits, "in") + "out vec4 pixel;\n" + lightUniforms(count);
  text += "uniform vec3 emissive;\nuniform float opacity;\nuniform vec3 highlight;\n";
  text += "uniform float shininess;\nuniform sampler2D picture;\nuniform vec4 fog;\n";
  bool shaded = false, shaded_around = false;
  if (count > 0) {
    const std::string n = "[" + std::to_string(count) + "];\n";
    text += "uniform vec3 axis" + n + "uniform vec3 cone" + n + "uniform vec4 fade" + n + "uniform vec2 reach" + n +
            "uniform vec2 texel_of_map" + n;
    for (std::size_t k = 0; k < count; ++k) {
      if (!std::isupper(traits.lights[k])) continue;
      const bool around = traits.lights[k] == 'P';
      text += std::string("uniform ") + (around ? "samplerCubeShadow" : "sampler2DShadow") + " map" +
              std::to_string(k) + ";\n";
      (around ? shaded_around : shaded) = true;
    }
  }
  if (shaded) text += kShadow;
  if (shaded_around) text += kShadowAround;
  if (traits.taps > 1) text += stripText(traits.taps);
  if (traits.textured) {
    text +=
        std::string("#define TEXEL(map) ") + (traits.taps > 1 ? "strip(map, texel)\n" : "texture(map, texel).rgb\n");
  }
  if (traits.bumpy) text += kBumps;
  if (traits.specular) text += kHalfway;
  text += traits.faceted ? "void main() {\n  vec3 n = n_C;\n" : "void main() {\n  vec3 n = normalize(n_C);\n";
  if (traits.two_sided) text += "  if (!gl_FrontFacing) n = -n;\n";
  if (traits.bumpy) text += "  n = bent(n);\n";
  text += traits.faceted ? "  vec3 light = whole;\n" : "  vec3 light = ambient;\n";
  if (traits.specular) {
    text += "  vec3 shine = vec3(0.0);\n  vec3 v = -normalize(p_C);\n  float n_v = dot(n, v);\n";
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (!isWholeLight(traits, k)) {
      text += lightText(traits.lights[k], k);
    } else if (traits.lights[k] == 'D' || traits.specular) {
      text += wholeLightText(traits.lights[k], std::to_string(k));
    }
  }
  if (traits.clamps_light) text += "  light = min(light, vec3(1.0));\n";
  text += traits.painted ? "  vec3 color = surface;\n" : "  vec3 color = shape_color.rgb;\n";
  if (traits.textured) text += "  color *= TEXEL(picture);\n";
  text += "  vec3 sum = emissive + color * light;\n";
  if (traits.specular) text += "  sum += highlight * shine;\n";
  if (traits.fog) {
    text += "  float thick = fog.w * length(p_C);\n  sum = mix(fog.rgb, min(sum, vec3(1.0)), exp(-thick * thick));\n";
  }
  return text + "  pixel = vec4(sum, opacity);\n}\n";
}

}  // namespace

std::string ShaderTraits::name() const {
  return "solid " + lights + (clamps_light ? " clamped" : "") + (textured ? " textured" : "") +
         (taps > 1 ? " taps " + std::to_string(taps) : "") + (bumpy ? " bumpy" : "") + (specular ? " specular" : "") +
         (by_root ? " by root"
          : sharp ? " sharp"
                  : "") +
         (fog ? " fog" : "") + (faceted ? " faceted" : "") + (two_sided ? " two-sided" : "") +
         (painted ? " painted" : "");
}

ShaderText solidShader(const ShaderTraits& traits) { return {solidVertexShader(traits), solidFragmentShader(traits)}; }

ShaderText flatShader(bool textured) {
  return {std::string(kVersion) + R"(
in vec3 position;
in vec2 coordinates;
uniform mat4 projection;
uniform float bias;  // lifts faces over what lies in the same plane
out vec2 texel;
void main() {
  texel = coordinates;
  gl_Position = projection * vec4(position, 1.0);
  gl_Position.z += bias * gl_Position.w;
}
)",
          std::string(kVersion) +
              "in vec2 texel;\nout vec4 pixel;\nuniform vec4 flat_color;\nuniform sampler2D picture;\n" +
              (textured ? "void main() { pixel = vec4(texture(picture, texel).rgb, 1.0); }\n"
                        : "void main() { pixel = flat_color; }\n")};
}

ShaderText depthShader() {
  return {std::string(kVersion) +
              "in vec3 position;\nuniform mat4 projection;\n"
              "void main() { gl_Position = projection * vec4(position, 1.0); }\n",
          std::string(kVersion) + "void main() {}\n"};
}

ShaderText skyShader() {
  return {std::string(kVersion) + R"(
in vec3 position;
uniform mat4 ray_of;  // from the picture's corners to rays in the world
out vec3 ray_W;
void main() {
  ray_W = (ray_of * vec4(position.xy, 1.0, 0.0)).xyz;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
)",
          std::string(kVersion) + R"(
in vec3 ray_W;
uniform vec3 horizon;
uniform vec3 zenith;
out vec4 pixel;
void main() { pixel = vec4(mix(horizon, zenith, sqrt(max(0.0, normalize(ray_W).z))), 0.0); }
)"};
}

}  // namespace aras_visual_servo_sim
