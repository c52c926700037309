#include <cerrno>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "../comparison.h"
#include "../difference_image.h"
#include "../equality.h"
#include "../file_aside.h"
#include "options.h"
#include "output.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct CompareOptions {
  fs::path a, b;
  std::optional<fs::path> reference, png, json_file;
  bool json_only = false;  // JSON on standard output, and the lines for people on standard error
  double alpha = 1e-3;
};

// What was found, for machines and for people.
struct Findings {
  std::int64_t x = 0, y = 0;  // of the first pixel, from the corner of the film
  std::uint64_t width = 0;    // pixels
  std::vector<std::string> channels;
  Metrics difference;
  std::optional<Metrics> a_error, b_error;  // against the reference
  std::optional<Quantiles> z;
  Equality equality;
  std::optional<double> scale;  // of the picture
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
    throw Error(Exit::scene,
                path.string() + ": has " + has + ", expected " + expected + " as " + first_path.string() + " has");
  };
  if (size_text(image) != size_text(first)) refuse(size_text(image), size_text(first));
  if (image.channels != first.channels) refuse("the channels " + channel_text(image), channel_text(first));
}

// Of each pixel, a - b: the luminance, or Y.
std::vector<float> signed_differences(const ImagePlanes& a, const ImagePlanes& b) {
  if (a.channels.front() == "R") return luminance_differences(a.values, b.values);
  const std::size_t channels = a.channels.size(), luminance = channels / 2;  // X Y Z, or Y
  std::vector<float> differences(a.pixels());
  for (std::size_t i = 0; i < differences.size(); ++i)
    differences[i] = a.values[i * channels + luminance] - b.values[i * channels + luminance];
  return differences;
}

double write_picture(const fs::path& path, const ImagePlanes& a, const ImagePlanes& b) {
  const std::vector<float> differences = signed_differences(a, b);
  const double scale = difference_scale(differences);
  write_difference(path, static_cast<unsigned>(a.width), static_cast<unsigned>(a.height), differences, scale);
  return scale;
}

struct Place {
  std::int64_t x, y;
  std::string channel;
};

Place place_of(std::uint64_t value, const Findings& found) {
  const std::uint64_t pixel = value / found.channels.size();
  return {found.x + static_cast<std::int64_t>(pixel % found.width), found.y + static_cast<std::int64_t>(pixel / found.width),
          found.channels[value % found.channels.size()]};
}

Json json_of(const Metrics& m, const Findings& found) {
  Json json = {{"values", m.values}, {"notFinite", m.left_out},  {"mean", m.mean},   {"signedMean", m.signed_mean},
               {"mse", m.mse},       {"relMSE", m.relative_mse}, {"smape", m.smape}, {"maximum", m.maximum}};
  if (m.maximum > 0.0) {
    const Place place = place_of(m.maximum_at, found);
    json["maximumAt"] = {{"x", place.x}, {"y", place.y}, {"channel", place.channel}};
  }
  return json;
}

Json json_of(const Equality& equality, double alpha) {
  Json json = {{"alpha", alpha}, {"differs", equality.differs(alpha)}};
  if (!equality.impossible.empty()) {
    json["impossible"] = equality.impossible;
    return json;
  }
  json["p"] = equality.p;
  if (!equality.approximate.empty()) json["approximate"] = equality.approximate;
  for (const EqualityTest& test : equality.tests)
    json["tests"].push_back({{"name", test.name}, {"p", test.p}, {"statistic", test.statistic}});
  if (!equality.left_out.empty()) json["leftOut"] = equality.left_out;
  return json;
}

std::string json_text(const Findings& found, const CompareOptions& options) {
  Json json = {{"a", options.a.string()}, {"b", options.b.string()}, {"difference", json_of(found.difference, found)}};
  if (found.a_error) {
    json["reference"] = options.reference->string();
    json["errorOfA"] = json_of(*found.a_error, found);
    json["errorOfB"] = json_of(*found.b_error, found);
  }
  if (found.z) json["z"] = {{"p50", found.z->median}, {"p99", found.z->p99}, {"maximum", found.z->maximum}};
  json["equality"] = json_of(found.equality, options.alpha);
  if (found.scale) json["scale"] = *found.scale;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print(const std::string& name, const Metrics& m, const Findings& found, std::ostream& out) {
  out << name << ": signed mean " << m.signed_mean << " (of " << m.mean << "), MSE " << m.mse << ", relMSE "
      << m.relative_mse << ", SMAPE " << m.smape << ", maximum " << m.maximum;
  if (m.maximum > 0.0) {
    const Place place = place_of(m.maximum_at, found);
    out << " in " << place.channel << " at " << place.x << "," << place.y;
  }
  out << "\n";
  if (m.left_out > 0)
    out << name << ": " << m.left_out << " of " << m.values + m.left_out << " values are not finite, and left out\n";
}

void print(const Equality& equality, double alpha, std::ostream& out) {
  if (!equality.impossible.empty()) {
    out << "no test is possible: " << equality.impossible << "\n";
    return;
  }
  for (const EqualityTest& test : equality.tests)
    out << "test " << test.name << ": p " << test.p << ", statistic " << test.statistic << "\n";
  for (const std::string& test : equality.left_out) out << "left out, test " << test << "\n";
  out << (equality.differs(alpha) ? "they differ significantly" : "no significant difference") << ": p " << equality.p
      << ", false-alarm rate " << (equality.approximate.empty() ? "at most " : "about ") << alpha;
  if (!equality.approximate.empty()) out << " if the means are normally distributed, since " << equality.approximate;
  out << "\n";
}

void print(const Findings& found, const CompareOptions& options, std::ostream& out) {
  print("A - B", found.difference, found, out);
  if (found.a_error) {
    print("A - reference", *found.a_error, found, out);
    print("B - reference", *found.b_error, found, out);
    const auto ratio = [&](const char* name, double a, double b) {
      if (b > 0.0) out << name << " of A over that of B: " << a / b << "\n";
    };
    ratio("MSE", found.a_error->mse, found.b_error->mse);
    ratio("relMSE", found.a_error->relative_mse, found.b_error->relative_mse);
  }
  if (found.z) out << "|z|: p50 " << found.z->median << ", p99 " << found.z->p99 << ", maximum " << found.z->maximum << "\n";
  if (found.scale) out << options.png->string() << ": red is A - B = " << *found.scale << ", blue " << -*found.scale << "\n";
  print(found.equality, options.alpha, out);
}

// Outputs that cannot be written are found before anything is read.
void require_outputs(const CompareOptions& options) {
  std::vector<fs::path> outputs, inputs = {options.a, options.b};
  for (const auto& output : {options.png, options.json_file})
    if (output) outputs.push_back(*output);
  if (options.reference) inputs.push_back(*options.reference);
  require_distinct(outputs, inputs);
  for (const fs::path& output : outputs) require_writable(output);
}

Exit run(const CompareOptions& options) {
  require_outputs(options);
  const ImagePlanes a = read_image_planes(options.a), b = read_image_planes(options.b);
  require_alike(options.b, b, options.a, a);
  Findings found{a.x, a.y, a.width, a.channels, compare(a.values, b.values), {}, {}, {}, {}, {}};
  if (options.reference) {
    const ImagePlanes reference = read_image_planes(*options.reference, StandardErrors::skip);
    require_alike(*options.reference, reference, options.a, a);
    found.a_error = compare(a.values, reference.values);
    found.b_error = compare(b.values, reference.values);
  }
  if (!a.errors.empty() && !b.errors.empty()) found.z = deviations(a.values, b.values, a.errors, b.errors);
  found.equality = test_equality(a, b);
  if (options.png) found.scale = write_picture(*options.png, a, b);
  if (options.json_file) write_text(*options.json_file, json_text(found, options));
  if (options.json_only) std::cout << json_text(found, options);
  print(found, options, options.json_only ? std::cerr : std::cout);
  return found.equality.differs(options.alpha) ? Exit::check_failed : Exit::success;
}

}  // namespace

Command compare_command(CLI::App& program) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App& line =
      *program.add_subcommand("compare", "Says how far two OpenEXR images are apart, and whether more than their noise is");
  line.add_option("A", options->a, "an image")->required()->type_name("A.exr");
  line.add_option("B", options->b, "another one of the same size")->required()->type_name("B.exr");
  line.add_option("--reference", options->reference, "judge both by a third image, too")->type_name("R.exr");
  line.add_option_function<std::string>(
          "--alpha", [options](const std::string& given) { options->alpha = real_number("--alpha", given, 0.0, 1.0); },
          "how often equal images may be called different, in (0, 1); default: 0.001")
      ->type_name("RATE");
  line.add_option("--png", options->png, "write the signed difference as a picture")->type_name("FILE");
  line.add_option_function<std::string>(
          "--json",
          [options](const std::string& given) {
            options->json_only = given == "-";
            if (!options->json_only) options->json_file = given;
          },
          "write the results to a file, too, or with - to standard output alone")
      ->type_name("FILE");
  return {&line, [options] {
            if (options->png && options->png->extension() != ".png")
              throw Error(Exit::usage, "--png '" + options->png->string() + "': expected a name in .png");
            return run(*options);
          }};
}

}  // namespace oclair
