#include "report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

#include "../difference_image.h"
#include "../image.h"
#include "svg.h"
#include "table.h"

namespace oclair::tune {
namespace {

// Distinct for most eyes, on paper as well: Okabe and Ito 2008, Color Universal Design, without its yellow.
constexpr std::array colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"};

constexpr const char* style = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, sans-serif; color: #222; background: #fff; max-width: 60rem; margin: 0 auto; padding: 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.2rem; margin-top: 2rem; }
.advice { padding: .75rem 1rem; background: #eef4fa; border-left: 4px solid #0072b2; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .85rem; } th, td { padding: .3rem .6rem; text-align: left; border-bottom: 1px solid #ddd; vertical-align: top; }
td.n { white-space: nowrap; font-variant-numeric: tabular-nums; } tr.best td { background: #eef4fa; font-weight: 600; }
td:last-child { min-width: 12rem; }
small { color: #555; } svg { width: 100%; min-width: 40rem; height: auto; } svg text { font: 12px system-ui, sans-serif; fill: #222; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; } figure { margin: 0; width: 14rem; flex: 1 1 9rem; max-width: 14rem; } figcaption { font-size: .8rem; }
figure img { width: 100%; image-rendering: pixelated; border: 1px solid #ccc; }
@media print { body { max-width: none; font-size: 11px; } .wide { overflow: visible; } svg { min-width: 0; } figure, svg, tr { break-inside: avoid; } }
)";

double root(double square) { return std::sqrt(std::max(0.0, square)); }

std::string interval(const Interval& i) {
  return number(i.estimate) + " <small>" + number(i.low) + " to " + number(i.high) + "</small>";
}

void write_table(const Result& result, std::ostream& out) {
  out << "<div class=\"wide\"><table><thead><tr><th>setting</th><th>gain</th><th>speed</th><th>variance</th><th>bias of pixels</th>"
         "<th>bias of the mean</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const Row& row = result.rows[i];
    const Estimates& e = row.estimates;
    out << "<tr" << (result.recommended == i ? " class=\"best\"" : "") << "><td>" << escaped(row.name) << (row.on_front ? " *" : "")
        << "</td><td class=\"n\">" << interval(row.gain) << "</td><td class=\"n\">" << interval(e.speed) << "</td><td class=\"n\">"
        << (e.same ? "1" : interval(e.variance)) << "</td><td class=\"n\">"
        << (has_bias(row) ? percent(root(e.squared_bias.estimate)).substr(1) : "0") << "</td><td>" << escaped(bias_text(row))
        << "</td></tr>\n";
  }
  out << "<tr><td>accurate</td><td class=\"n\">1</td><td class=\"n\">1</td><td class=\"n\">1</td><td class=\"n\">0</td><td>0</td></tr>\n"
         "</tbody></table></div>\n";
}

// Of settings whose bias is below the error, if only just; the others never get there.
std::string pareto_plot(const Result& result) {
  constexpr double floor = 1e-4;  // relative bias that is drawn as none
  Plot plot("time to the error, over that of the accurate setting", "root mean square of the relative bias");
  plot.note_y(floor, "none");
  plot.add_point({1.0, floor, "accurate", colors[0], true});
  for (const Row& row : result.rows) {
    const double time = 1.0 / row.gain.estimate;
    const double bias = has_bias(row) ? std::max(floor, root(row.estimates.squared_bias.estimate)) : floor;
    if (std::isfinite(time) && time > 0.0) plot.add_point({time, bias, row.name, colors[has_bias(row) ? 1 : 2], row.on_front});
  }
  plot.add_level(result.request.error, "the error that the renders are for");
  return plot.svg();
}

std::string never_there(const Result& result) {
  std::string names;
  for (const Row& row : result.rows)
    if (!row.seconds) names += (names.empty() ? "" : ", ") + escaped(row.name);
  return names.empty() ? "" : "<p><small>Never there, since their bias alone is as large as the error: " + names + ".</small></p>\n";
}

std::string convergence_plot(const Result& result) {
  Plot plot("seconds of rendering", "relative error");
  const auto curve = [&](const std::string& name, const std::vector<CurvePoint>& points, const char* color) {
    std::vector<std::pair<double, double>> line;
    for (const CurvePoint& point : points) line.emplace_back(point.seconds, point.error);
    const std::optional<double> falls = slope(points);
    plot.add_line({line, name + (falls ? ", slope " + number(*falls, 2) : ""), color});
  };
  curve("accurate", result.curve, "#222");
  std::size_t drawn = 0;
  for (const bool biased : {true, false})  // those first whose error does not go on falling
    for (const Row& row : result.rows)
      if (!row.estimates.same && has_bias(row) == biased && drawn < colors.size()) curve(row.name, row.curve, colors[drawn++]);
  plot.add_level(result.request.error, "the error that the renders are for");
  return plot.svg();
}

std::string figure(const std::string& png, const std::string& caption) {
  return "<figure><img alt=\"" + escaped(caption) + "\" src=\"data:image/png;base64," + base64(png) + "\"><figcaption>" +
         escaped(caption) + "</figcaption></figure>\n";
}

std::string picture(const Result& result) {
  return encoded_png(result.width, result.height, [&](std::size_t first, std::span<float> rgb) {
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<float>(tone_mapped(result.picture[3 * first + i]));
  });
}

std::string difference(const Result& result, const Row& row) {
  const Picture nothing(row.difference.size());
  const std::vector<float> signed_values = luminance_differences(row.difference, nothing);
  const double scale = difference_scale(signed_values);
  return figure(difference_png(result.width, result.height, signed_values, scale),
                row.name + ": red is " + number(scale) + " more, blue as much less");
}

}  // namespace

std::string report_of(const Result& result) {
  std::ostringstream out;
  out << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>oclair tune: "
      << escaped(result.scene) << "</title>\n<style>" << style << "</style>\n</head>\n<body>\n<h1>What accuracy costs in "
      << escaped(result.scene) << "</h1>\n<p class=\"advice\">" << escaped(advice(result)) << "</p>\n<p>" << result.width << "x"
      << result.height << " pixels, " << result.request.replicas << " replicas of " << REPLICA_SAMPLES << " samples of each setting, on "
      << escaped(result.device) << " (" << escaped(result.driver) << "). All intervals together hold with "
      << number(100.0 * result.request.confidence) << " %.</p>\n";
  if (result.interrupted) out << "<p>The measurement was interrupted.</p>\n";
  out << "<h2>Settings</h2>\n";
  write_table(result, out);
  out << "<p><small>Gain: time to a relative error of " << number(result.request.error)
      << ", the accurate setting's over this one's; 0: the bias alone is larger. Speed: time of a sample. Variance: of a sample. "
         "* nothing is both sooner and less biased.</small></p>\n";
  if (!result.not_measured.empty()) {
    out << "<p>Not measured: ";
    for (std::size_t i = 0; i < result.not_measured.size(); ++i) out << (i ? "; " : "") << escaped(result.not_measured[i]);
    out << ".</p>\n";
  }
  if (result.rows.empty()) {
    out << "</body>\n</html>\n";
    return out.str();
  }
  out << "<h2>Time and bias</h2>\n<div class=\"wide\">\n" << pareto_plot(result) << "</div>\n"
      << never_there(result) << "<h2>Error against time</h2>\n<div class=\"wide\">\n"
      << convergence_plot(result) << "</div>\n";
  out << "<h2>Pictures</h2>\n<p><small>Of the settings that change the mean: what they add to the accurate picture and take from it. What "
         "is no bias in them is noise that both did not share.</small></p>\n<div class=\"pictures\">\n"
      << figure(picture(result), "accurate");
  for (const Row& row : result.rows)
    if (has_bias(row)) out << difference(result, row);
  out << "</div>\n<p><small>" << escaped("oclair " OCLAIR_VERSION) << ", scene " << escaped(result.scene_hash) << "</small></p>\n</body>\n</html>\n";
  return out.str();
}

}  // namespace oclair::tune
