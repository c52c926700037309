#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "../comparison.h"
#include "../equality.h"
#include "../image.h"
#include "options.h"
#include "report.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  fs::path a, b;
  std::optional<fs::path> reference, png;
  std::optional<std::string> json;  // a file, or - for standard output
  double alpha = 1e-3;
};

std::string size_text(const ImagePlanes& image) {
  std::string text = std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels";
  if (image.x != 0 || image.y != 0) text += " at " + std::to_string(image.x) + "," + std::to_string(image.y);
  return text;
}

std::string channel_text(const ImagePlanes& image) {
  std::string text;
  for (const std::string& channel : image.channels) text += (text.empty() ? "" : ", ") + channel;
  return text;
}

void require_alike(const fs::path& path, const ImagePlanes& image, const fs::path& first_path, const ImagePlanes& first) {
  const auto refuse = [&](const std::string& has, const std::string& expected) {
    throw Error(Exit::scene, path.string() + ": has " + has + ", expected " + expected + " as " + first_path.string() + " has");
  };
  if (size_text(image) != size_text(first)) refuse(size_text(image), size_text(first));
  if (image.channels != first.channels) refuse("the channels " + channel_text(image), channel_text(first));
}

// Of the difference a - b of a pixel: its luminance (Rec. ITU-R BT.709), or Y.
float signed_difference(const ImagePlanes& a, const ImagePlanes& b, std::size_t pixel) {
  constexpr double weights[] = {0.2126, 0.7152, 0.0722};
  const std::size_t channels = a.channels.size();
  double sum = 0.0;
  for (std::size_t c = 0; c < channels; ++c) {
    const double weight = channels == 1 || a.channels[c] == "Y" ? 1.0 : a.channels[0] == "R" ? weights[c] : 0.0;
    if (weight > 0.0) sum += weight * (double{a.values[pixel * channels + c]} - b.values[pixel * channels + c]);
  }
  return static_cast<float>(sum);
}

// Of the picture: the 99th percentile of what is not 0, or 0.
double picture_scale(const ImagePlanes& a, const ImagePlanes& b) {
  std::vector<float> sizes;
  for (std::size_t pixel = 0; pixel < a.pixels(); ++pixel) {
    const float size = std::abs(signed_difference(a, b, pixel));
    if (std::isfinite(size) && size > 0.0f) sizes.push_back(size);
  }
  return quantiles(std::move(sizes)).p99;
}

// Light grey at 0, linear to red at the scale and to blue at its negative; black: not finite. All below the knee of tone_mapped.
void write_difference(const fs::path& path, const ImagePlanes& a, const ImagePlanes& b, double scale) {
  constexpr float zero[] = {0.75f, 0.75f, 0.75f}, positive[] = {0.4f, 0.0f, 0.01f}, negative[] = {0.0f, 0.06f, 0.5f};
  write_png(path, static_cast<unsigned>(a.width), static_cast<unsigned>(a.height), [&](std::size_t first, std::span<float> rgb) {
    for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
      const float d = signed_difference(a, b, first + i);
      const float share = scale > 0.0 ? static_cast<float>(std::min(1.0, std::abs(d) / scale)) : 0.0f;
      for (std::size_t c = 0; c < 3; ++c)
        rgb[3 * i + c] = std::isfinite(d) ? zero[c] + share * ((d > 0.0f ? positive : negative)[c] - zero[c]) : 0.0f;
    }
  });
}

nlohmann::ordered_json json_of(const Metrics& m) {
  return {{"values", m.values},        {"notFinite", m.left_out},   {"mean", m.mean},   {"signedMean", m.signed_mean}, {"mse", m.mse},
          {"relMSE", m.relative_mse}, {"smape", m.smape}, {"maximum", m.maximum}};
}

// What was found, for machines and for people: print() goes through the same figures.
struct Findings {
  Metrics difference;
  std::optional<Metrics> a_error, b_error;  // against the reference
  std::optional<Quantiles> z;
  Equality equality;
  std::optional<double> scale;  // of the picture
};

nlohmann::ordered_json json_of(const Findings& found, const CompareOptions& options) {
  nlohmann::ordered_json json = {{"a", options.a.string()}, {"b", options.b.string()}, {"difference", json_of(found.difference)}};
  if (found.a_error) {
    json["reference"] = options.reference->string();
    json["errorOfA"] = json_of(*found.a_error);
    json["errorOfB"] = json_of(*found.b_error);
  }
  if (found.z) json["z"] = {{"p50", found.z->median}, {"p99", found.z->p99}, {"maximum", found.z->maximum}};
  nlohmann::ordered_json& equality = json["equality"];
  equality["alpha"] = options.alpha;
  if (!found.equality.impossible.empty()) equality["impossible"] = found.equality.impossible;
  for (const EqualityTest& test : found.equality.tests)
    equality["tests"].push_back({{"name", test.name}, {"p", test.p}, {"statistic", test.statistic}});
  if (!found.equality.left_out.empty()) equality["leftOut"] = found.equality.left_out;
  if (found.equality.impossible.empty()) equality["p"] = found.equality.p;
  equality["differs"] = found.equality.differs(options.alpha);
  if (found.scale) json["scale"] = *found.scale;
  return json;
}

void print(const std::string& name, const Metrics& m, std::ostream& out) {
  out << name << ": signed mean " << m.signed_mean << " (of " << m.mean << "), MSE " << m.mse << ", relMSE " << m.relative_mse
      << ", SMAPE " << m.smape << ", maximum " << m.maximum << "\n";
  if (m.left_out > 0) out << name << ": " << m.left_out << " values left out, which are not finite\n";
}

void print(const Findings& found, const CompareOptions& options, std::ostream& out) {
  print("A - B", found.difference, out);
  if (found.a_error) {
    print("A - reference", *found.a_error, out);
    print("B - reference", *found.b_error, out);
    const auto ratio = [&](const char* name, double a, double b) {
      out << "  " << name << " of A over that of B: " << (b > 0.0 ? a / b : std::numeric_limits<double>::quiet_NaN()) << "\n";
    };
    ratio("MSE", found.a_error->mse, found.b_error->mse);
    ratio("relMSE", found.a_error->relative_mse, found.b_error->relative_mse);
  }
  if (found.z) out << "|z|: p50 " << found.z->median << ", p99 " << found.z->p99 << ", maximum " << found.z->maximum << "\n";
  for (const EqualityTest& test : found.equality.tests)
    out << "test " << test.name << ": p " << test.p << ", statistic " << test.statistic << "\n";
  for (const std::string& test : found.equality.left_out) out << "test left out, " << test << "\n";
  if (found.scale) out << options.png->string() << ": red is A - B = " << *found.scale << ", blue " << -*found.scale << "\n";
  if (!found.equality.impossible.empty())
    out << "no test was possible: " << found.equality.impossible << "\n";
  else
    out << (found.equality.differs(options.alpha) ? "they differ significantly" : "no significant difference") << ": p "
        << found.equality.p << ", false-alarm rate at most " << options.alpha << "\n";
}

void write_json(const std::string& file, const std::string& json) {
  std::ofstream stream(file);
  stream << json;
  if (!stream.flush())
    throw Error(Exit::render_failed, file + ": cannot be written, expected a file in a writable directory");
}

Exit run(const CompareOptions& options) {
  if (options.png) require_writable(*options.png);
  const ImagePlanes a = read_image_planes(options.a), b = read_image_planes(options.b);
  require_alike(options.b, b, options.a, a);
  Findings found;
  found.difference = compare(a.values, b.values);
  if (options.reference) {
    const ImagePlanes reference = read_image_planes(*options.reference);
    require_alike(*options.reference, reference, options.a, a);
    found.a_error = compare(a.values, reference.values);
    found.b_error = compare(b.values, reference.values);
  }
  if (!a.errors.empty() && !b.errors.empty()) found.z = deviations(a.values, b.values, a.errors, b.errors);
  found.equality = test_equality(a, b);
  if (options.png) {
    found.scale = picture_scale(a, b);
    write_difference(*options.png, a, b, *found.scale);
  }
  const bool json_only = options.json == "-";
  if (json_only) std::cout << json_of(found, options).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  if (options.json && !json_only)
    write_json(*options.json, json_of(found, options).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  print(found, options, json_only ? std::cerr : std::cout);
  return found.equality.differs(options.alpha) ? Exit::check_failed : Exit::success;
}

}  // namespace

Command compare_command(CLI::App& program) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& line = *program.add_subcommand("compare", "Says how far two OpenEXR images are apart, and whether more than their noise is");
  line.add_option("A", options->a, "an image")->required()->type_name("A.exr");
  line.add_option("B", options->b, "another one of the same size")->required()->type_name("B.exr");
  line.add_option("--reference", options->reference, "judge both by a third image, too")->type_name("R.exr");
  line.add_option_function<std::string>(
          "--alpha", [options](const std::string& given) { options->alpha = real_number("--alpha", given, 0.0, 1.0); },
          "how often equal images may be called different; default: 0.001")
      ->type_name("RATE");
  line.add_option("--png", options->png, "write the signed difference as a picture")->type_name("FILE");
  line.add_option("--json", options->json, "write the results to a file, too, or with - to standard output alone")
      ->type_name("FILE");
  return {&line, [options] { return run(*options); }};
}

}  // namespace oclair
