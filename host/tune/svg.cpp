#include "svg.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "../error.h"

namespace oclair::tune {
namespace {

constexpr double width = 760.0, height = 420.0, left = 70.0, right = 20.0, top = 20.0, bottom = 50.0;  // of the drawing and its margins

// From values to places along a logarithmic axis.
struct Axis {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;  // values
  double begin = 0.0, end = 0.0;                                     // places

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void widen(double factor) {
    low /= factor;
    high *= factor;
  }
  double place(double value) const { return begin + (end - begin) * std::log(value / low) / std::log(high / low); }

  // 1, 2 and 5 times powers of ten; of many decades only these.
  std::vector<double> ticks() const {
    std::vector<double> all;
    const bool few = high / low < 300.0;
    for (int power = static_cast<int>(std::floor(std::log10(low))); power <= static_cast<int>(std::ceil(std::log10(high))); ++power)
      for (const double factor : {1.0, 2.0, 5.0})
        if (const double tick = factor * std::pow(10.0, power); tick >= low && tick <= high && (few || factor == 1.0)) all.push_back(tick);
    return all;
  }
};

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string at(double x, double y) { return "x=\"" + shown(x) + "\" y=\"" + shown(y) + "\""; }

std::string segment(double x1, double y1, double x2, double y2, const char* look) {
  return "<line x1=\"" + shown(x1) + "\" y1=\"" + shown(y1) + "\" x2=\"" + shown(x2) + "\" y2=\"" + shown(y2) + "\" " + look + "/>\n";
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string safe;
  using Json = nlohmann::json;
  for (const char c : Json::parse(Json(one_line(text)).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>()) {
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '"') safe += "&quot;";
    else safe += c;
  }
  return safe;
}

std::string base64(const std::string& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

std::string Plot::svg() const {
  Axis x{.begin = left, .end = width - right}, y{.begin = height - bottom, .end = top};
  for (const PlotPoint& point : points_) x.include(point.x), y.include(point.y);
  for (const PlotLine& line : lines_)
    for (const auto& [px, py] : line.points) x.include(px), y.include(py);
  for (const auto& [level, name] : levels_) y.include(level);
  if (!(x.high > 0.0)) return "";
  x.widen(1.3);
  y.widen(1.5);

  const double legend = 18.0 * static_cast<double>(lines_.size());
  std::ostringstream out;
  out << "<svg viewBox=\"0 0 " << width << " " << height + legend << "\" role=\"img\" aria-label=\"" << escaped(y_title_ + " over " + x_title_)
      << "\">\n";
  for (const double tick : x.ticks()) {
    out << segment(x.place(tick), top, x.place(tick), height - bottom, "stroke=\"#e5e5e5\"") << "<text " << at(x.place(tick), height - bottom + 16)
        << " text-anchor=\"middle\">" << shown(tick) << "</text>\n";
  }
  for (const double tick : y.ticks()) {
    const auto note = std::find_if(notes_.begin(), notes_.end(), [&](const auto& n) { return std::abs(n.first / tick - 1.0) < 1e-9; });
    out << segment(left, y.place(tick), width - right, y.place(tick), "stroke=\"#e5e5e5\"") << "<text " << at(left - 8, y.place(tick) + 4)
        << " text-anchor=\"end\">" << (note != notes_.end() ? escaped(note->second) : shown(tick)) << "</text>\n";
  }
  out << "<text " << at(0.5 * (left + width - right), height - 12) << " text-anchor=\"middle\">" << escaped(x_title_) << "</text>\n<text "
      << "transform=\"translate(14 " << 0.5 * (top + height - bottom) << ") rotate(-90)\" text-anchor=\"middle\">" << escaped(y_title_)
      << "</text>\n";
  for (const auto& [level, name] : levels_)
    out << segment(left, y.place(level), width - right, y.place(level), "stroke=\"#888\" stroke-dasharray=\"6 4\"") << "<text "
        << at(width - right - 4, y.place(level) - 5) << " text-anchor=\"end\">" << escaped(name) << "</text>\n";
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const PlotLine& line = lines_[i];
    out << "<polyline fill=\"none\" stroke=\"" << line.color << "\" stroke-width=\"2\" points=\"";
    for (const auto& [px, py] : line.points) out << shown(x.place(px)) << "," << shown(y.place(py)) << " ";
    out << "\"/>\n";
    for (const auto& [px, py] : line.points)
      out << "<circle cx=\"" << shown(x.place(px)) << "\" cy=\"" << shown(y.place(py)) << "\" r=\"3\" fill=\"" << line.color << "\"/>\n";
    const double row = height + 12.0 + 18.0 * static_cast<double>(i);
    out << "<rect " << at(left, row - 9) << " width=\"18\" height=\"4\" fill=\"" << line.color << "\"/><text " << at(left + 26, row - 3) << ">"
        << escaped(line.name) << "</text>\n";
  }
  // Names of points that lie close together are set below each other.
  std::vector<std::pair<double, double>> taken;
  std::vector<const PlotPoint*> order;
  for (const PlotPoint& point : points_) order.push_back(&point);
  std::stable_sort(order.begin(), order.end(), [](const PlotPoint* a, const PlotPoint* b) { return a->y > b->y; });
  for (const PlotPoint* point : order) {
    const double px = x.place(point->x), py = y.place(point->y);
    const bool to_the_left = px > 0.7 * width;
    double text_y = py - 6.0;
    const auto meets = [&] {
      return std::any_of(taken.begin(), taken.end(), [&](const auto& t) { return std::abs(t.first - px) < 170.0 && std::abs(t.second - text_y) < 12.0; });
    };
    while (meets() && text_y > top) text_y -= 12.0;
    taken.emplace_back(px, text_y);
    out << "<circle cx=\"" << shown(px) << "\" cy=\"" << shown(py) << "\" r=\"5\" stroke=\"" << point->color << "\" stroke-width=\"2\" fill=\""
        << (point->filled ? point->color : "#fff") << "\"/>\n";
    if (py - text_y > 10.0) out << segment(px, py - 5.0, px, text_y + 2.0, "stroke=\"#bbb\"");
    out << "<text " << at(to_the_left ? px - 8.0 : px + 8.0, text_y) << (to_the_left ? " text-anchor=\"end\"" : "") << ">" << escaped(point->name)
        << "</text>\n";
  }
  out << "</svg>\n";
  return out.str();
}

}  // namespace oclair::tune
