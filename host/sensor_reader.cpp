#include "sensor_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "error.h"
#include "number.h"
#include "property.h"
#include "transform.h"

namespace oclair {

namespace {

constexpr std::uint64_t MAX_PIXELS = std::uint64_t{1} << 31;  // of a whole film: random streams of more would coincide (rng_key)
constexpr double MAX_FILTER_RADIUS = 64.0;                    // pixels
constexpr double FULL_FRAME_DIAGONAL = 43.266615305567875;    // mm, of 36 mm x 24 mm: what focal_length refers to

void refuse_child(const Element& element, const Element& nested, const std::string& where, const std::string& supported) {
  refuse(where, describe(nested) + " is not supported in " + describe(element) + " (supported: " + supported + ")");
}

void read_filter(Element& element, WorldFilm& film) {
  if (!element.children.empty()) refuse(element.children[0].where, "nothing may be nested in " + describe(element));
  if (element.type == "box") {
    film.filter = FilterKind::box;
    film.filter_radius = 0.5;
    return;
  }
  const std::string name = element.type == "tent" ? "radius" : "stddev";
  if (element.type == "tent") {
    film.filter = FilterKind::tent;
    film.filter_radius = number_property(element, name, 1.0);
  } else if (element.type == "gaussian") {
    film.filter = FilterKind::gaussian;
    film.filter_stddev = number_property(element, name, 0.5);
    film.filter_radius = 4.0 * film.filter_stddev;
  } else {
    refuse(element.where, describe(element) + " is not supported (supported: box, gaussian, tent)");
  }
  if (!(film.filter_radius > 0.0 && film.filter_radius <= MAX_FILTER_RADIUS))
    refuse(where_is(element, name),
           "\"" + name + "\" of " + describe(element) + " does not give the filter a radius in (0, 64] pixels");
}

bool has_too_many_pixels(std::uint64_t width, std::uint64_t height) { return width * height > MAX_PIXELS; }

PixelFormat pixel_format(Element& element) {
  const std::vector<std::string> names = {"luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"};
  const auto name = choice_property(element, "pixel_format", "rgb", names);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return static_cast<PixelFormat>(i);
  return PixelFormat::rgb;
}

void read_film(Document& document, std::uint32_t index, WorldFilm& film) {
  auto& element = document.elements[index];
  if (element.type != "hdrfilm") refuse(element.where, describe(element) + " is not supported (supported: hdrfilm)");
  const auto size = [&](const char* name, uint missing, std::int64_t least) {
    return static_cast<uint>(integer_property(element, name, missing, least, std::int64_t{MAX_FILM_SIDE}));
  };
  film.width = size("width", film.width, 1);
  film.height = size("height", film.height, 1);
  film.crop_x = size("crop_offset_x", 0, 0);
  film.crop_y = size("crop_offset_y", 0, 0);
  film.crop_width = size("crop_width", film.width, 1);
  film.crop_height = size("crop_height", film.height, 1);
  if (has_too_many_pixels(film.width, film.height))
    refuse(where_is(element, "height"), describe(element) + " has more than 2^31 pixels (width times height)");
  if (film.crop_x + film.crop_width > film.width)
    refuse(where_is(element, "crop_width"), "the crop window is wider than the film (crop_offset_x + crop_width > width)");
  if (film.crop_y + film.crop_height > film.height)
    refuse(where_is(element, "crop_height"),
           "the crop window is higher than the film (crop_offset_y + crop_height > height)");
  film.sample_border = boolean_property(element, "sample_border", false);
  film.pixel_format = pixel_format(element);
  choice_property(element, "file_format", "openexr", {"openexr", "exr"});
  choice_property(element, "component_format", "float16", {"float16", "float32", "uint32"});  // the image is always float32
  bool has_filter = false;
  for (const auto& child : element.children) {
    auto& nested = document.elements[child.element];
    if (nested.tag != "rfilter") refuse_child(element, nested, child.where, "rfilter");
    if (std::exchange(has_filter, true)) refuse(child.where, describe(element) + " has more than one <rfilter>");
    read_filter(nested, film);
  }
}

void resize_film(glm::uvec2 size, WorldFilm& film) {
  if (film.crop_width != film.width || film.crop_height != film.height)
    throw Error(Exit::usage, "film size " + std::to_string(size.x) + "x" + std::to_string(size.y) +
                                 ": the film of the scene has a crop window; expected a scene without one");
  if (has_too_many_pixels(size.x, size.y))
    throw Error(Exit::usage, "film size " + std::to_string(size.x) + "x" + std::to_string(size.y) +
                                 " has more pixels than expected: at most 2^31");
  film.width = film.crop_width = size.x;
  film.height = film.crop_height = size.y;
}

void read_sampler(Element& element, World& world) {
  static const std::vector<std::string> TYPES = {"independent", "stratified", "multijitter", "orthogonal", "ldsampler"};
  if (std::find(TYPES.begin(), TYPES.end(), element.type) == TYPES.end())
    refuse(element.where,
           describe(element) + " is not supported (supported: independent, ldsampler, multijitter, orthogonal, stratified)");
  if (!element.children.empty()) refuse(element.children[0].where, "nothing may be nested in " + describe(element));
  constexpr std::int64_t MAX_UINT = std::numeric_limits<uint>::max();
  world.samples_per_pixel = static_cast<std::uint64_t>(integer_property(element, "sample_count", 4, 1, MAX_UINT));
  world.seed = static_cast<std::uint64_t>(integer_property(element, "seed", 0, 0, MAX_UINT));
}

// "50mm" or "50"
double focal_length_mm(Element& element) {
  auto text = string_property(element, "focal_length").value_or("50mm");
  if (text.size() >= 2 && text.substr(text.size() - 2) == "mm") text.resize(text.size() - 2);
  const auto value = parse_number(text);
  if (!value || !(*value > 0.0))
    refuse(where_is(element, "focal_length"),
           "\"focal_length\" of " + describe(element) + " is not a positive number of millimetres like 50mm");
  return *value;
}

// Tangent of half the angle that the whole width of the film takes in. aspect: width over height of the film.
double tan_half_fov_x(Element& element, double aspect) {
  if (!has_property(element, "fov")) {
    const double diagonal = FULL_FRAME_DIAGONAL / (2.0 * focal_length_mm(element));
    return diagonal / std::sqrt(1.0 + 1.0 / (aspect * aspect));
  }
  if (has_property(element, "focal_length"))
    refuse(where_is(element, "focal_length"),
           "\"fov\" and \"focal_length\" of " + describe(element) + " exclude each other");
  const double fov = number_property(element, "fov", 0.0);
  if (!(fov >= 0.01 && fov <= 179.0))
    refuse(where_is(element, "fov"), "\"fov\" of " + describe(element) + " lies outside [0.01, 179] degrees");
  const double tangent = std::tan(glm::radians(fov) / 2.0);
  const auto axis = choice_property(element, "fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"});
  if (axis == "x" || (axis == "larger" && aspect > 1.0) || (axis == "smaller" && aspect <= 1.0)) return tangent;
  if (axis == "diagonal") return tangent / std::sqrt(1.0 + 1.0 / (aspect * aspect));
  return tangent * aspect;
}

void read_clip_planes(Element& element, WorldCamera& camera) {
  camera.near_clip = number_property(element, "near_clip", 1e-2);
  camera.far_clip = number_property(element, "far_clip", 1e4);
  if (!(camera.near_clip > 0.0))
    refuse(where_is(element, "near_clip"), "\"near_clip\" of " + describe(element) + " is not positive");
  if (!(camera.far_clip > camera.near_clip))
    refuse(where_is(element, "far_clip"), "\"far_clip\" of " + describe(element) + " is not greater than \"near_clip\"");
}

// The film is as wide as [-1, 1] under to_world, which may scale and shear it.
void read_orthographic(Element& element, WorldCamera& camera) {
  if (!is_invertible(camera.to_world))
    refuse(where_is(element, "to_world"), "\"to_world\" of " + describe(element) + " flattens it");
  camera.orthographic = true;
  camera.tan_half_fov_x = 1.0;
  // As in Mitsuba: the near plane is scaled with the camera, the distance between the planes is not.
  const double between = camera.far_clip - camera.near_clip;
  camera.near_clip *= glm::length(glm::dvec3(camera.to_world[2]));
  camera.far_clip = camera.near_clip + between;
}

void read_perspective(Element& element, const WorldFilm& film, WorldCamera& camera) {
  const glm::dmat3 m(camera.to_world), product = m * glm::transpose(m);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (!(std::abs(product[i][j] - (i == j)) < 1e-3))
        refuse(where_is(element, "to_world"),
               "\"to_world\" of " + describe(element) + " scales or shears, which a camera cannot");
  camera.tan_half_fov_x = tan_half_fov_x(element, static_cast<double>(film.width) / film.height);
}

void read_lens(Element& element, WorldCamera& camera) {
  if (!has_property(element, "aperture_radius"))
    refuse(element.where, describe(element) + " lacks <float name=\"aperture_radius\">");
  camera.aperture_radius = number_property(element, "aperture_radius", 0.0);
  camera.focus_distance = number_property(element, "focus_distance", camera.far_clip);
  if (camera.aperture_radius < 0.0)
    refuse(where_is(element, "aperture_radius"), "\"aperture_radius\" of " + describe(element) + " is negative");
  if (!(camera.focus_distance > 0.0))
    refuse(where_is(element, "focus_distance"), "\"focus_distance\" of " + describe(element) + " is not positive");
}

void read_camera(Element& element, const WorldFilm& film, WorldCamera& camera) {
  camera.to_world = transform_property(element, "to_world").value_or(glm::dmat4(1.0));
  read_clip_planes(element, camera);
  if (element.type == "orthographic") return read_orthographic(element, camera);
  read_perspective(element, film, camera);
  if (element.type == "thinlens") return read_lens(element, camera);
  camera.principal_point_offset = {number_property(element, "principal_point_offset_x", 0.0),
                                   number_property(element, "principal_point_offset_y", 0.0)};
}

}  // namespace

void read_sensor(Document& document, std::uint32_t index, const std::optional<glm::uvec2>& film_size, World& world) {
  auto& element = document.elements[index];
  if (element.type != "perspective" && element.type != "thinlens" && element.type != "orthographic")
    refuse(element.where, describe(element) + " is not supported (supported: orthographic, perspective, thinlens)");
  bool has_film = false, has_sampler = false;
  for (const auto& child : element.children) {
    auto& nested = document.elements[child.element];
    if (nested.tag == "film") {
      if (std::exchange(has_film, true)) refuse(child.where, describe(element) + " has more than one <film>");
      read_film(document, child.element, world.film);
    } else if (nested.tag == "sampler") {
      if (std::exchange(has_sampler, true)) refuse(child.where, describe(element) + " has more than one <sampler>");
      read_sampler(nested, world);
    } else {
      refuse_child(element, nested, child.where, "film, sampler");
    }
  }
  if (film_size) resize_film(*film_size, world.film);
  read_camera(element, world.film, world.camera);
}

}  // namespace oclair
